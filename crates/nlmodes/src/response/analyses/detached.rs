use nlmodes_contact::solver_by_name;
use nlmodes_hbm::HbmError;

use super::forced::curve_over_frequency;
use crate::response::{EndReason, ResponseCurve, ResponseError, ResponseModel, ResponsePoint, ResponseSettings};

/// The response over the frequency through a point of another curve at its level, such as a phase resonance that no
/// curve from the ends of the window reaches: a detached curve, which is closed where it lies within the window.
///
/// Upwards in frequency first; where that way does not come back, the way down precedes it in reverse order.
///
/// # Errors
/// As [`frequency_response`](crate::response::frequency_response).
pub fn detached_response(
    model: &ResponseModel,
    point: &ResponsePoint,
    settings: &ResponseSettings,
) -> Result<ResponseCurve, ResponseError> {
    let up = one_way(model, point, settings, 1.0)?;
    if up.end.has(EndReason::Closed) || up.end.has(EndReason::Stopped) {
        return Ok(up);
    }
    let mut down = one_way(model, point, settings, -1.0)?;
    down.points.reverse();
    down.points.extend(up.points.into_iter().skip(1));
    if down.end.complete {
        down.end = up.end;
    }
    Ok(down)
}

fn one_way(
    model: &ResponseModel,
    point: &ResponsePoint,
    settings: &ResponseSettings,
    way: f64,
) -> Result<ResponseCurve, ResponseError> {
    let solver = solver_by_name(&settings.contact_solver).map_err(HbmError::Compliance)?;
    let base = point.omega / settings.subharmonic as f64;
    let (mut curve, omega) = curve_over_frequency(model, point.level, base, settings, solver.as_ref())?;
    curve.direction.iter_mut().for_each(|d| *d *= way);
    curve.x = point.coefficients_for(&curve.system);
    curve.follow(omega)
}

/// Share of the amplitude by which a point may miss a curve that is drawn straight between its points.
const ON_CURVE: f64 = 0.02;

/// Whether a point at the same level lies on a curve over the frequency, as far as its points tell.
pub fn lies_on(point: &ResponsePoint, curve: &ResponseCurve) -> bool {
    curve.points.windows(2).any(|pair| {
        let (a, b) = (&pair[0], &pair[1]);
        let span = b.omega - a.omega;
        // Near a fold neither end may reach the frequency exactly.
        let slack = 1e-6 * point.omega;
        let (low, high) = (a.omega.min(b.omega) - slack, a.omega.max(b.omega) + slack);
        if !(low..=high).contains(&point.omega) {
            return false;
        }
        let share = if span == 0.0 { 0.5 } else { ((point.omega - a.omega) / span).clamp(0.0, 1.0) };
        let between = a.drive + (b.drive - a.drive) * share;
        let step = (b.drive - a.drive).norm();
        (between - point.drive).norm() <= ON_CURVE * point.drive.norm() + 0.25 * step
    })
}

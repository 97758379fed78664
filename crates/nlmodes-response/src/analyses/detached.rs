use nlmodes_contact::solver_by_name;
use nlmodes_continuation::{Bound, ParametricSystem};
use nlmodes_hbm::{HbmError, PeriodicSystem};

use super::forced::{WINDOW, scales};
use crate::follow::Curve;
use crate::{CurveEnd, ResponseCurve, ResponseError, ResponseModel, ResponsePoint, ResponseSettings};

/// The response over the frequency through a point of another curve at its level, such as a phase resonance that no curve from the ends of the
/// window reaches: a detached curve, which is closed where it lies within the window.
///
/// Upwards in frequency first; where that way does not come back, the way down stands before it in reverse order.
///
/// # Errors
/// As [`frequency_response`](crate::frequency_response).
pub fn detached_response(
    model: &ResponseModel,
    point: &ResponsePoint,
    settings: &ResponseSettings,
) -> Result<ResponseCurve, ResponseError> {
    let up = one_way(model, point, settings, 1.0)?;
    if matches!(up.end, CurveEnd::Closed | CurveEnd::Stopped) {
        return Ok(up);
    }
    let mut down = one_way(model, point, settings, -1.0)?;
    down.points.reverse();
    down.points.extend(up.points.into_iter().skip(1));
    if down.end.is_complete() {
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
    settings.check()?;
    let solver = solver_by_name(&settings.contact_solver).map_err(HbmError::Compliance)?;
    let window = settings.base_window();
    let unit = (window[1] - window[0]) / WINDOW;
    let base = point.omega / settings.subharmonic as f64;
    let (structure, load) = (model.structure(), model.load(settings)?);
    let system = PeriodicSystem::frequency_response(
        structure,
        load,
        point.level,
        unit,
        settings.periodic(),
        scales(structure, base),
        solver.as_ref(),
    )?;
    let n = system.dim();
    let bounds = vec![Bound { coordinate: n, min: window[0] / unit, max: window[1] / unit }];
    let mut direction = vec![0.0; n + 1];
    direction[n] = way;
    let (drive, p, x) = (model.drive(settings)?, base / unit, point.coefficients_for(&system));
    let mut curve = Curve { system, x, p, direction, bounds, drive, settings, solver: solver.as_ref() };
    curve.follow((n, unit * settings.subharmonic as f64))
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

use nlmodes_contact::{LcpSolver, solver_by_name};
use nlmodes_continuation::{Bound, ParametricSystem};
use nlmodes_hbm::{Grazing, HbmError, PeriodicSystem, Symmetry};

use super::touching::as_gaps_close;
use crate::response::error::holds;
use crate::response::follow::{Curve, newton};
use crate::response::linear::unknowns_at_rest;
use crate::response::{Gradients, ResponseCurve, ResponseError, ResponseModel, ResponseSettings};
use crate::touching::growing;

/// The damped nonlinear mode `settings.mode` from grazing to `energy_ratio` times the energy there, or to an end of the
/// window. Before contacts that touch at rest without force nothing is linear: it then begins with half the amplitude
/// of the linear mode at which another contact changes its state, or with 1 J.
///
/// `M q̈ + (C − ξ M) q̇ + K q = W λ`: the periodic motion of the damped structure if a force balances the damping in
/// all harmonics. Damping ratio `D = ξ/(2ω)` ([`nlmodes_hbm::PeriodicMotion::damping_ratio`]); multipliers are those of
/// the motion with its negative damping, of which one is +1 by the free phase: stability is not computed.
///
/// # Errors
/// [`ResponseError`] where there is no start; a curve that ends early is none.
pub fn damped_mode(
    model: &ResponseModel,
    energy_ratio: f64,
    settings: &ResponseSettings,
) -> Result<ResponseCurve, ResponseError> {
    free_motion(model, energy_ratio, settings, true)
}

/// The conservative nonlinear mode of the structure without its damping, in the same way.
///
/// # Errors
/// As [`damped_mode`].
pub fn conservative_mode(
    model: &ResponseModel,
    energy_ratio: f64,
    settings: &ResponseSettings,
) -> Result<ResponseCurve, ResponseError> {
    free_motion(model, energy_ratio, settings, false)
}

fn free_motion(
    model: &ResponseModel,
    energy_ratio: f64,
    settings: &ResponseSettings,
    is_damped: bool,
) -> Result<ResponseCurve, ResponseError> {
    settings.check()?;
    holds("the largest energy over that at grazing", energy_ratio, "a number above 1", |ratio| ratio > 1.0)?;
    let mut own = ResponseSettings { stability: false, subharmonic: 1, ..settings.clone() };
    if !is_damped {
        let Gradients { watched, changes } = &*settings.gradients;
        own = own.with_gradients(Gradients { watched: watched.clone(), changes: changes.conservative() });
    }
    let solver = solver_by_name(&settings.contact_solver).map_err(HbmError::Compliance)?;
    let structure = model.structure();
    let start = model.linear_start(settings.mode)?;
    let (periodic, scales) = (own.periodic(), start.scales());
    let system = if is_damped {
        PeriodicSystem::damped_mode(structure, periodic, scales, solver.as_ref())?
    } else {
        PeriodicSystem::conservative_mode(structure, Symmetry::Even, periodic, scales, solver.as_ref())?
    };
    let (omega, energy) = (system.n_coefficients(), system.dim());
    let unit = start.omega;
    let bounds = vec![Bound { coordinate: energy, min: -1.0, max: energy_ratio.ln() }, own.bound_from(omega, unit)?];
    let (mut x, mut direction) = (start.unknowns(&system), start.direction(&system));
    if start.touches_at_rest() {
        let rest = unknowns_at_rest(&system, model.pressed_rest()?.as_ref());
        let by = (&own, solver.as_ref());
        x = match as_gaps_close(&system, &x, &start.opening, by) {
            Err(error @ ResponseError::NoModeTouching { .. }) if is_damped => {
                from_undamped(&system, &start, by)?.ok_or(error)?
            }
            found => found?,
        };
        // The distance from rest grows like the root of the energy.
        direction = growing(&system, &x, &rest, 0.5);
    }
    let drive = model.drive(&own)?;
    let mut curve = Curve {
        system,
        x,
        p: 0.0,
        direction,
        bounds,
        drive,
        settings: &own,
        solver: solver.as_ref(),
        budget: own.budget(),
    };
    curve.follow((omega, unit))
}

/// Before contacts that touch at rest, the damped motion next to the conservative one of the same energy; none where
/// there is none.
fn from_undamped(
    system: &PeriodicSystem,
    start: &Grazing,
    by: (&ResponseSettings, &dyn LcpSolver),
) -> Result<Option<Vec<f64>>, ResponseError> {
    let (periodic, scales) = (by.0.periodic(), start.scales());
    let undamped = PeriodicSystem::conservative_mode(system.structure(), Symmetry::Even, periodic, scales, by.1)?;
    let found = match as_gaps_close(&undamped, &start.unknowns(&undamped), &start.opening, by) {
        Err(ResponseError::NoModeTouching { .. }) => return Ok(None),
        found => found?,
    };
    let mut guess = system.resized(&found, undamped.series());
    guess.push(2.0 * start.damping_ratio);
    let mut damped = system.with_harmonics(system.series().n_harmonics, by.1)?;
    damped.hold_phase(&guess);
    Ok(newton(&mut damped, &guess, 0.0))
}

use nlmodes_contact::solver_by_name;
use nlmodes_continuation::{Bound, ParametricSystem};
use nlmodes_hbm::{HbmError, PeriodicSystem, Symmetry};

use crate::follow::Curve;
use crate::{ResponseCurve, ResponseError, ResponseModel, ResponseSettings};

/// The damped nonlinear mode `settings.mode` from grazing to `energy_ratio` times the energy there, or to an end of the
/// window.
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
    if !(energy_ratio.is_finite() && energy_ratio > 1.0) {
        let (what, expected) = ("the largest energy over that at grazing", "a number above 1");
        return Err(ResponseError::Setting { what, value: energy_ratio, expected });
    }
    let own = ResponseSettings { stability: false, subharmonic: 1, ..settings.clone() };
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
    let (x, direction) = (start.unknowns(&system), start.direction(&system));
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

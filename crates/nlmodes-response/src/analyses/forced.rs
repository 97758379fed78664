use nlmodes_contact::{LcpSolver, solver_by_name};
use nlmodes_continuation::{Bound, ParametricSystem, StopReason};
use nlmodes_hbm::{HbmError, ModalStructure, PeriodicSystem, Scales};

use crate::follow::Curve;
use crate::{ResponseCurve, ResponseError, ResponseModel, ResponseSettings};

/// Length of the window in units of the parameter: with steps of at most 0.1, some sixty points where nothing else happens.
const WINDOW: f64 = 6.0;

/// The response at `level` over the window of frequencies, from its lower end or its upper one: where the curve from one end is lost on the way,
/// that from the other has points that it has not.
///
/// # Errors
/// [`ResponseError`] where there is no start; a curve that ends early is none.
pub fn frequency_response(
    model: &ResponseModel,
    level: f64,
    settings: &ResponseSettings,
) -> Result<ResponseCurve, ResponseError> {
    settings.check()?;
    positive("the level", level)?;
    let solver = solver_by_name(&settings.contact_solver).map_err(HbmError::Compliance)?;
    let window = settings.base_window();
    let from = window[usize::from(settings.from_upper_end)];
    let x = at_level(model, from, level, settings, solver.as_ref())?;
    let unit = (window[1] - window[0]) / WINDOW;
    let (structure, load) = (model.structure(), model.load(settings)?);
    let scales = scales(structure, from);
    let system =
        PeriodicSystem::frequency_response(structure, load, level, unit, settings.periodic(), scales, solver.as_ref())?;
    let n = system.dim();
    let bounds = vec![Bound { coordinate: n, min: window[0] / unit, max: window[1] / unit }];
    let mut direction = vec![0.0; n + 1];
    direction[n] = if settings.from_upper_end { -1.0 } else { 1.0 };
    let drive = model.drive(settings)?;
    let p = from / unit;
    let mut curve = Curve { system, x, p, direction, bounds, drive, settings, solver: solver.as_ref() };
    curve.follow((n, unit * settings.subharmonic as f64))
}

/// The response at the frequency `omega` of the load (rad/s) from rest to the largest level `to`.
///
/// # Errors
/// As [`frequency_response`].
pub fn force_response(
    model: &ResponseModel,
    omega: f64,
    to: f64,
    settings: &ResponseSettings,
) -> Result<ResponseCurve, ResponseError> {
    positive("the frequency (rad/s)", omega)?;
    positive("the largest level", to)?;
    let solver = solver_by_name(&settings.contact_solver).map_err(HbmError::Compliance)?;
    let base = omega / settings.subharmonic.max(1) as f64;
    let mut curve = over_level(model, base, to, settings, solver.as_ref())?;
    curve.follow((usize::MAX, 1.0))
}

fn over_level<'a>(
    model: &ResponseModel,
    base: f64,
    to: f64,
    settings: &'a ResponseSettings,
    solver: &'a dyn LcpSolver,
) -> Result<Curve<'a>, ResponseError> {
    let (structure, load) = (model.structure(), model.load(settings)?);
    if let Some(contact) = structure.gaps().iter().position(|g| *g < 0.0) {
        return Err(HbmError::PressedAtRest { contact, gap: structure.gaps()[contact] }.into());
    }
    let unit = to / WINDOW;
    let scales = scales(structure, base);
    let system = PeriodicSystem::force_response(structure, load, base, unit, settings.periodic(), scales, solver)?;
    let n = system.dim();
    let mut direction = vec![0.0; n + 1];
    direction[n] = 1.0;
    let bounds = vec![Bound { coordinate: n, min: 0.0, max: WINDOW }];
    let drive = model.drive(settings)?;
    Ok(Curve { system, x: vec![0.0; n], p: 0.0, direction, bounds, drive, settings, solver })
}

/// Unknowns of the response at a base frequency and a level, followed from rest over the level.
pub(crate) fn at_level(
    model: &ResponseModel,
    base: f64,
    level: f64,
    settings: &ResponseSettings,
    solver: &dyn LcpSolver,
) -> Result<Vec<f64>, ResponseError> {
    let mut curve = over_level(model, base, level, settings, solver)?;
    let parameter = curve.parameter();
    let branch = curve.run()?;
    let last = branch.points.last().map_or((0.0, Vec::new()), |q| (q.p, q.x.clone()));
    match &branch.stop {
        StopReason::Bound { coordinate, value } if *coordinate == parameter && *value > 0.0 => Ok(last.1),
        stop => Err(ResponseError::NoStart {
            omega: base * settings.subharmonic as f64,
            level,
            reached: last.0 * level / WINDOW,
            why: format!("{:?}", crate::CurveEnd::of(stop, usize::MAX, 1.0)),
        }),
    }
}

/// Lengths near the smallest gap, or the largest where all touch at rest; frequencies near `omega`.
pub(crate) fn scales(structure: &ModalStructure, omega: f64) -> Scales {
    let gaps = structure.gaps().iter().map(|g| g.abs()).filter(|g| *g > 0.0);
    let smallest = gaps.fold(f64::INFINITY, f64::min);
    let length = if smallest.is_finite() { smallest } else { 1.0 };
    Scales::new(length, omega, 1.0)
}

fn positive(what: &'static str, value: f64) -> Result<(), ResponseError> {
    let fine = value.is_finite() && value > 0.0;
    if fine { Ok(()) } else { Err(ResponseError::Setting { what, value, expected: "a positive number" }) }
}

use nlmodes_contact::{LcpSolver, solver_by_name};
use nlmodes_continuation::StepSettings;
use nlmodes_hbm::{HbmError, ModalStructure, PeriodicSystem, Scales, law_length};

use super::doubled::doubled_responses;
use crate::response::error::positive;
use crate::response::follow::Curve;
use crate::response::linear::{SmallMotion, unknowns_at_rest};
use crate::response::{ResponseCurve, ResponseError, ResponseModel, ResponsePoint, ResponseSettings};
use crate::touching::{Closing, NotClosed};

/// Length of the window in units of the parameter: with steps of at most 0.1, some sixty points where nothing else
/// happens.
pub(crate) const WINDOW: f64 = 6.0;

/// The response at `level` over the window of frequencies, from its lower end or its upper one: where the curve from
/// one end is lost on the way, that from the other has points that it has not.
///
/// # Errors
/// [`ResponseError`] where there is no start; a curve that ends early is none.
pub fn frequency_response(
    model: &ResponseModel,
    level: f64,
    settings: &ResponseSettings,
) -> Result<ResponseCurve, ResponseError> {
    let solver = solver_by_name(&settings.contact_solver).map_err(HbmError::Compliance)?;
    let (mut curve, omega) = over_frequency(model, level, settings, solver.as_ref())?;
    curve.follow(omega)
}

/// The response from the other end of the window, where it begins there with a motion that none of the `known` curves
/// has: several are possible at an end, and each end may bring another of them. `None` also where none is found there
/// from rest.
///
/// # Errors
/// As [`frequency_response`].
pub fn response_from_other_end(
    model: &ResponseModel,
    level: f64,
    settings: &ResponseSettings,
    known: &[ResponseCurve],
) -> Result<Option<ResponseCurve>, ResponseError> {
    let solver = solver_by_name(&settings.contact_solver).map_err(HbmError::Compliance)?;
    let other = ResponseSettings { from_upper_end: !settings.from_upper_end, ..settings.clone() };
    let (mut curve, omega) = match over_frequency(model, level, &other, solver.as_ref()) {
        Ok(start) => start,
        Err(ResponseError::NoStart { .. } | ResponseError::NoStartTouching { .. } | ResponseError::Stopped) => {
            return Ok(None);
        }
        Err(error) => return Err(error),
    };
    let end = curve.p * omega.1;
    let is_start = |point: &ResponsePoint| {
        let own = point.coefficients_for(&curve.system);
        (point.omega - end).abs() <= SAME * end
            && distance(&own, &curve.x) <= (SAME * distance(&own, &[])).max(RESOLVED)
    };
    if known.iter().flat_map(|curve| &curve.points).any(is_start) {
        return Ok(None);
    }
    curve.follow(omega).map(Some)
}

/// Share of a motion within which two at the same frequency are one.
const SAME: f64 = 1e-6;

/// Difference of two motions, over the length at which a stop is touched, within which they are one: Newton's method
/// ends there, also where a motion is far smaller.
const RESOLVED: f64 = 1e-9;

/// Length of `a − b`, as far as both go; of `a` where `b` is empty.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let b = b.iter().chain(std::iter::repeat(&0.0));
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// As [`frequency_response`], and behind it the curves that branch off from it. With `settings.subharmonic = 2` motions
/// of twice the period of the load are followed from where a multiplier passes −1, along its disturbance. With another
/// number the curves are those that are found where curves cross. Of two curves that are one motion of several periods,
/// a period of the load apart, one is there.
///
/// # Errors
/// As [`frequency_response`].
pub fn branching_responses(
    model: &ResponseModel,
    level: f64,
    settings: &ResponseSettings,
) -> Result<Vec<ResponseCurve>, ResponseError> {
    let solver = solver_by_name(&settings.contact_solver).map_err(HbmError::Compliance)?;
    if settings.subharmonic == 2 {
        return doubled_responses(model, level, settings, solver.as_ref());
    }
    let (mut curve, omega) = over_frequency(model, level, settings, solver.as_ref())?;
    let mut different: Vec<ResponseCurve> = Vec::new();
    for curve in curve.follow_all(omega, settings.max_branches)? {
        if settings.subharmonic == 1 || !different.iter().skip(1).any(|known| is_shifted(known, &curve)) {
            different.push(curve);
        }
    }
    Ok(different)
}

/// Whether two curves have the same frequencies and amplitudes.
fn is_shifted(a: &ResponseCurve, b: &ResponseCurve) -> bool {
    let (middle, n) = (a.points.len() / 2, a.points.len().abs_diff(b.points.len()));
    let Some(point) = a.points.get(middle).filter(|_| n <= 2 + middle / 10) else { return false };
    let close = |x: f64, y: f64, unit: f64| (x - y).abs() <= 1e-3 * unit;
    b.points.iter().any(|other| {
        close(point.omega, other.omega, 0.1 * point.omega)
            && close(point.drive.norm(), other.drive.norm(), point.drive.norm())
            && close(point.motion.kinetic_energy, other.motion.kinetic_energy, point.motion.kinetic_energy)
    })
}

/// The curve over the frequency at a level from an end of the window, with the coordinate of the frequency and its unit
/// (of the load, rad/s).
pub(super) fn over_frequency<'a>(
    model: &ResponseModel,
    level: f64,
    settings: &'a ResponseSettings,
    solver: &'a dyn LcpSolver,
) -> Result<(Curve<'a>, (usize, f64)), ResponseError> {
    settings.check()?;
    positive("the level", level)?;
    let from = settings.base_window()[usize::from(settings.from_upper_end)];
    let x = at_level(model, from, level, settings, solver)?;
    let (mut curve, omega) = curve_over_frequency(model, level, from, settings, solver)?;
    curve.x = x;
    if settings.from_upper_end {
        curve.direction.iter_mut().for_each(|d| *d = -*d);
    }
    Ok((curve, omega))
}

/// As [`over_frequency`], from the base frequency `from` upwards; its unknowns are still to be given.
pub(super) fn curve_over_frequency<'a>(
    model: &ResponseModel,
    level: f64,
    from: f64,
    settings: &'a ResponseSettings,
    solver: &'a dyn LcpSolver,
) -> Result<(Curve<'a>, (usize, f64)), ResponseError> {
    settings.check()?;
    let window = settings.base_window();
    let unit = (window[1] - window[0]) / WINDOW;
    let (structure, load) = (model.structure(), model.load(settings)?);
    let scales = match touch(model, (from, level), settings, solver)? {
        Some(touch) => touch.scales(from),
        None => scales(structure, from),
    };
    let system = PeriodicSystem::frequency_response(structure, load, level, unit, settings.periodic(), scales, solver)?;
    let mut curve = Curve::rising(system, window.map(|omega| omega / unit), model, settings, solver)?;
    curve.p = from / unit;
    let omega = (curve.parameter(), unit * settings.subharmonic as f64);
    Ok((curve, omega))
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
    let mut curve = match touch(model, (base, to), settings, solver.as_ref())? {
        Some(touch) => from_touch(model, &touch, (base, to), settings, solver.as_ref())?,
        None => over_level(model, base, (to, scales(model.structure(), base)), settings, solver.as_ref())?,
    };
    curve.follow((usize::MAX, 1.0))
}

/// Share of the largest level at which a curve over the level begins where contacts touch at rest: from there down,
/// motions are those of any level made smaller.
const LEAST: f64 = 1e-3;

/// The curve over the level of a structure with contacts that touch at rest without force.
fn from_touch<'a>(
    model: &ResponseModel,
    touch: &Touch,
    (base, to): (f64, f64),
    settings: &'a ResponseSettings,
    solver: &'a dyn LcpSolver,
) -> Result<Curve<'a>, ResponseError> {
    let least = LEAST * to;
    let x = at_level(model, base, least, settings, solver)?;
    let mut curve = over_level(model, base, (to, touch.scales(base)), settings, solver)?;
    // Lengths at the least level count in those at the largest one.
    curve.x = x.iter().map(|x| LEAST * x).collect();
    curve.p = LEAST * WINDOW;
    curve.within([curve.p, WINDOW]);
    Ok(curve)
}

fn over_level<'a>(
    model: &ResponseModel,
    base: f64,
    (to, scales): (f64, Scales),
    settings: &'a ResponseSettings,
    solver: &'a dyn LcpSolver,
) -> Result<Curve<'a>, ResponseError> {
    let (structure, load) = (model.structure(), model.load(settings)?);
    let unit = to / WINDOW;
    let system = PeriodicSystem::force_response(structure, load, base, unit, settings.periodic(), scales, solver)?;
    let mut curve = Curve::rising(system, [0.0, WINDOW], model, settings, solver)?;
    curve.x = unknowns_at_rest(&curve.system, model.pressed_rest()?.as_ref());
    Ok(curve)
}

/// Most points on the way from rest to the level of a curve.
const STARTING: usize = 5000;

/// Unknowns of the response at a base frequency and a level, followed from rest over the level.
pub(crate) fn at_level(
    model: &ResponseModel,
    base: f64,
    level: f64,
    settings: &ResponseSettings,
    solver: &dyn LcpSolver,
) -> Result<Vec<f64>, ResponseError> {
    // However few points of the curve itself are asked for.
    let own = ResponseSettings { max_points: settings.max_points.max(STARTING), ..settings.clone() };
    if let Some(touch) = touch(model, (base, level), &own, solver)? {
        return closing(model, &touch, (base, level), &own, solver);
    }
    match from_rest(model, (base, level), 0.0, &own, solver) {
        Err(error @ ResponseError::NoStart { .. }) => {
            let found = MORE_DAMPING.into_iter().map(|c| through_damping(model, (base, level), c * base, &own, solver));
            let stopped = |found: &Result<_, _>| !matches!(found, Err(ResponseError::NoStart { .. }));
            found.into_iter().find(stopped).unwrap_or(Err(error))
        }
        outcome => outcome,
    }
}

/// The response at a level as it grows from rest, beside its own damping with `c` (1/s) times the mass.
fn from_rest(
    model: &ResponseModel,
    (base, level): (f64, f64),
    c: f64,
    settings: &ResponseSettings,
    solver: &dyn LcpSolver,
) -> Result<Vec<f64>, ResponseError> {
    let mut curve = over_level(model, base, (level, scales(model.structure(), base)), settings, solver)?;
    curve.system = curve.system.damped_more(c);
    curve.arrive(WINDOW)?.map_err(|(p, why)| {
        let omega = base * settings.subharmonic as f64;
        ResponseError::NoStart { omega, level, reached: p * level / WINDOW, why }
    })
}

/// Damping beside its own with which a structure is brought to a level that it does not reach from rest, times the mass
/// and the base frequency, in the order in which they are tried.
const MORE_DAMPING: [f64; 2] = [1.0, 5.0];

/// The response at a level as it grows from rest with more damping, and as that is then taken away.
fn through_damping(
    model: &ResponseModel,
    (base, level): (f64, f64),
    c: f64,
    settings: &ResponseSettings,
    solver: &dyn LcpSolver,
) -> Result<Vec<f64>, ResponseError> {
    let x = from_rest(model, (base, level), c, settings, solver)?;
    let mut curve = over_level(model, base, (level, scales(model.structure(), base)), settings, solver)?;
    curve.system = curve.system.over_damping(level, c / WINDOW);
    let parameter = curve.parameter();
    (curve.x, curve.p, curve.direction[parameter]) = (x, WINDOW, -1.0);
    curve.within([0.0, 2.0 * WINDOW]);
    curve.arrive(0.0)?.map_err(|(_, why)| {
        let omega = base * settings.subharmonic as f64;
        ResponseError::NoStart { omega, level, reached: level, why }
    })
}

/// Contacts that touch at rest without force: a response is nowhere linear there, however small.
pub(super) struct Touch {
    pub contacts: Vec<usize>,
    /// How far the load would move them toward their stops if these were not there, m; the most of all.
    pub length: f64,
}

impl Touch {
    pub fn scales(&self, base: f64) -> Scales {
        Scales::new(self.length, base, 1.0)
    }
}

/// By how much contacts that touch are set back, m, while it is found how far a load moves them.
pub(super) const APART: f64 = 1.0;

/// The contacts that touch at rest, and what the load at this base frequency and level does to them.
pub(super) fn touch(
    model: &ResponseModel,
    (base, level): (f64, f64),
    settings: &ResponseSettings,
    solver: &dyn LcpSolver,
) -> Result<Option<Touch>, ResponseError> {
    let contacts = model.touching_at_rest()?;
    if contacts.is_empty() {
        return Ok(None);
    }
    let apart = model.opened(&contacts, APART)?;
    let mut small = SmallMotion::new(&apart, base, settings, solver)?;
    let motion = small.motion()?;
    let toward = |&i: &usize| APART - (apart.structure().gaps()[i] - motion.contacts[i].peak);
    let toward = contacts.iter().map(toward).fold(0.0, f64::max);
    let length = if toward > 0.0 { level * toward / small.level } else { APART };
    Ok(Some(Touch { contacts, length }))
}

/// Share of how far the load would move contacts that touch by which they are set back at first.
const SET_BACK: f64 = 0.5;

/// The response with contacts that touch at rest: that with the same load before contacts that are set back, to which
/// these are then closed.
fn closing(
    model: &ResponseModel,
    touch: &Touch,
    (base, level): (f64, f64),
    settings: &ResponseSettings,
    solver: &dyn LcpSolver,
) -> Result<Vec<f64>, ResponseError> {
    let by = SET_BACK * touch.length;
    let opened = model.opened(&touch.contacts, by)?;
    let x = at_level(&opened, base, level, settings, solver)?;
    let mut opening = vec![0.0; model.structure().n_contacts()];
    touch.contacts.iter().for_each(|&contact| opening[contact] = by);
    let (structure, periodic, own) = (model.structure(), settings.periodic(), touch.scales(base));
    let load = model.load(settings)?;
    let system = PeriodicSystem::force_response(structure, load, base, 1.0, periodic, own, solver)?.at_level(level);
    let unit = scales(opened.structure(), base).length / own.length;
    let x: Vec<f64> = x.iter().map(|x| unit * x).collect();
    let closing = Closing { step: &StepSettings::default(), solver, watch: &settings.watch };
    closing.closed(system, &x, &opening, &mut settings.log.clone()).map_err(|failure| match failure {
        NotClosed::Lost { left, why } => {
            ResponseError::NoStartTouching { omega: base * settings.subharmonic as f64, level, left: left * by, why }
        }
        failure => failure.into(),
    })
}

/// Lengths near the smallest gap, or that at which laws of force matter, and of a structure that a steady force presses
/// onto its contacts near what that bends; frequencies near `omega`.
pub(crate) fn scales(structure: &ModalStructure, omega: f64) -> Scales {
    if let Some(length) = pressed_length(structure) {
        return Scales::new(length, omega, 1.0);
    }
    let gaps = structure.gaps().iter().map(|g| g.abs()).filter(|g| *g > 0.0);
    let of_laws = if structure.laws().is_empty() { None } else { law_length(structure, 1).ok() };
    let smallest = gaps.chain(of_laws.filter(|l| *l > 0.0)).fold(f64::INFINITY, f64::min);
    let length = if smallest.is_finite() { smallest } else { 1.0 };
    Scales::new(length, omega, 1.0)
}

/// What a steady force would bend on one contact alone, m; the least of all.
fn pressed_length(structure: &ModalStructure) -> Option<f64> {
    let (force, squares, rows) = (structure.steady_force(), structure.omega_squared(), structure.rows());
    let size = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>().sqrt();
    let pull = size(&mut force.iter().copied());
    let rigid = (0..force.len()).filter(|&k| squares[k] == 0.0);
    let of = |i: usize| {
        let elastic = (0..squares.len()).filter(|&k| squares[k] > 0.0);
        let own = structure.compliance().a()[(i, i)];
        let compliance = own + elastic.map(|k| rows[(i, k)].powi(2) / squares[k]).sum::<f64>();
        pull / size(&mut rigid.clone().map(|k| rows[(i, k)])) * compliance
    };
    (0..rows.nrows()).map(of).filter(|length| length.is_finite() && *length > 0.0).reduce(f64::min)
}

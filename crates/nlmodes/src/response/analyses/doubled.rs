//! Responses of twice the period of their load, from the period doublings of a response.

use std::ops::ControlFlow;

use nlmodes_contact::LcpSolver;
use nlmodes_continuation::{BranchPoint, ParametricSystem};
use nlmodes_hbm::{ContactMotion, OperatingPoint, PeriodicMotion, PeriodicSystem};
use num_complex::Complex64;

use super::forced::{curve_over_frequency, over_frequency};
use crate::response::curve::joined;
use crate::response::{
    EndReason, Event, FinerPoint, ResponseCurve, ResponseError, ResponseModel, ResponsePoint, ResponseSettings,
};

/// Amplitudes of the disturbance, over the size of the motion, with which the way onto a doubled branch is tried.
const OFF: [f64; 4] = [1e-2, 3e-2, 3e-3, 1e-1];

/// Relative differences of frequency and energy below which a doubled branch has come to a period doubling.
const ARRIVED: (f64, f64) = (2e-3, 0.05);

/// The response with the period of the load, and behind it those of twice that period that leave it where a multiplier
/// passes −1.
///
/// The disturbance with that multiplier is the direction in which a doubled branch leaves: at a given share of it,
/// response and frequency are solved for. A branch ends where it comes back to motions of one period; beyond lie the
/// same motions, a period of the load later.
pub(super) fn doubled_responses(
    model: &ResponseModel,
    level: f64,
    settings: &ResponseSettings,
    solver: &dyn LcpSolver,
) -> Result<Vec<ResponseCurve>, ResponseError> {
    let harmonics = (settings.harmonics / 2).max(1);
    let single = ResponseSettings { subharmonic: 1, harmonics, stability: true, ..settings.clone() };
    let (mut curve, omega) = over_frequency(model, level, &single, solver)?;
    let first = curve.follow(omega)?;
    let mut all = vec![over_two_periods(&first, settings.harmonics)];
    for point in first.points.iter().filter(|point| is_located(point)) {
        if settings.watch.asks_to_end() || all.iter().skip(1).any(|known| has_arrived(known, point)) {
            continue;
        }
        let p = point.omega / omega.1;
        let disturbance = curve.system.doubling_disturbance(point.solved.coefficients().0, p, settings.harmonics)?;
        all.extend(leave(model, point, &disturbance, settings, solver)?);
    }
    Ok(all)
}

/// Whether a multiplier is −1 here.
fn is_located(point: &ResponsePoint) -> bool {
    let at_minus_one =
        |s: &crate::response::Stability| (s.largest_multiplier[0] + 1.0).hypot(s.largest_multiplier[1]) < 1e-3;
    point.events.contains(&Event::PeriodDoubling) && point.stability.as_ref().is_some_and(at_minus_one)
}

fn has_arrived(branch: &ResponseCurve, point: &ResponsePoint) -> bool {
    let close = |a: f64, b: f64, by: f64| (a / b - 1.0).abs() < by;
    branch.end.has(EndReason::Joined)
        && branch.points.last().is_some_and(|last| {
            close(last.omega, point.omega, ARRIVED.0)
                && close(last.motion.kinetic_energy, point.motion.kinetic_energy, ARRIVED.1)
        })
}

/// The doubled branch that leaves a point along a disturbance; none where no motion is found beside it.
fn leave(
    model: &ResponseModel,
    point: &ResponsePoint,
    disturbance: &[Vec<Complex64>],
    settings: &ResponseSettings,
    solver: &dyn LcpSolver,
) -> Result<Option<ResponseCurve>, ResponseError> {
    let (mut curve, omega) = curve_over_frequency(model, point.level, 0.5 * point.omega, settings, solver)?;
    let n = curve.system.dim();
    let center = doubled_coefficients(point, &curve.system);
    let direction = curve.system.coefficients_of(disturbance);
    let length = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
    let (size, stretch) = (length(&center), length(&direction));
    if !(size > 0.0 && stretch > 0.0) {
        return Ok(None);
    }
    let subharmonic = Subharmonic::of(&curve.system);
    curve.direction = direction.iter().map(|d| d / stretch).chain([0.0]).collect();
    for off in OFF {
        curve.x = center.iter().zip(&direction).map(|(x, d)| x + off * size / stretch * d).collect();
        let mut before: Option<Vec<f64>> = None;
        let mut has_crossed = false;
        let watch = settings.watch.clone();
        let mut watch = |point: &BranchPoint| {
            let now = subharmonic.part(&point.x);
            // On the other side lie the same motions, shifted by a period of the load.
            has_crossed = before.as_ref().is_some_and(|before| dot(before, &now) <= 0.0);
            before = Some(now);
            if has_crossed || watch.asks_to_end() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        // Where Newton's method finds no motion at this amplitude, another one is tried.
        let Ok(mut branch) = curve.run_watched(&mut watch) else { continue };
        let share = |z: &[f64]| length(&subharmonic.part(&z[..n])) / size;
        let moved = branch.points.first().map_or(0.0, |first| share(&first.x));
        if !(0.3 * off..3.0 * off.max(1e-2)).contains(&moved) || branch.points.len() < 3 {
            continue;
        }
        if has_crossed {
            branch.points.pop();
        }
        let mut found = curve.curve(&branch, omega)?;
        if has_crossed {
            found.end = joined();
        }
        return Ok(Some(found));
    }
    Ok(None)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The unknowns of odd harmonics of half the frequency of the load.
struct Subharmonic(Vec<usize>);

impl Subharmonic {
    fn of(system: &PeriodicSystem) -> Self {
        let (series, all) = (system.series(), system.n_coefficients());
        Self((0..all).filter(|i| series.harmonic(i % series.width()).0 % 2 == 1).collect())
    }

    fn part(&self, x: &[f64]) -> Vec<f64> {
        self.0.iter().map(|&i| x[i]).collect()
    }
}

/// The coefficients of a motion with the period of the load, over two of them.
fn doubled_coefficients(point: &ResponsePoint, system: &PeriodicSystem) -> Vec<f64> {
    let (series, (own, unit)) = (system.series(), point.solved.coefficients());
    let coordinates = (system.n_coefficients() / series.width()).max(1);
    let (width, factor) = (own.len() / coordinates, unit / system.unit());
    let highest = width / 2;
    let mut x = vec![0.0; system.n_coefficients()];
    for (own, x) in own.chunks(width.max(1)).zip(x.chunks_mut(series.width())) {
        for n in (0..=highest).filter(|n| 2 * n <= series.n_harmonics) {
            x[2 * n] = factor * own[n];
            if let Some(sine) = series.sine(2 * n) {
                x[sine] = factor * own[highest + n];
            }
        }
    }
    x
}

/// A curve of motions with the period of the load, with half the frequency as the base and this many harmonics of it.
/// Multipliers stay those over one period.
fn over_two_periods(curve: &ResponseCurve, harmonics: usize) -> ResponseCurve {
    let spread = |of: &[Vec<Complex64>]| -> Vec<Vec<Complex64>> {
        let zero = || vec![Complex64::default(); of.first().map_or(0, Vec::len)];
        (0..=harmonics).map(|n| of.get(n / 2).filter(|_| n % 2 == 0).cloned().unwrap_or_else(zero)).collect()
    };
    let contact = |c: &ContactMotion| ContactMotion {
        touches: 2 * c.touches,
        fundamental: Complex64::default(),
        free_fundamental: Complex64::default(),
        ..*c
    };
    let motion = |m: &PeriodicMotion| PeriodicMotion {
        at: OperatingPoint { omega: 0.5 * m.at.omega, ..m.at },
        eta: spread(&m.eta),
        stops: spread(&m.stops),
        forces: spread(&m.forces),
        reactions: spread(&m.reactions),
        contacts: m.contacts.iter().map(contact).collect(),
        ..m.clone()
    };
    let one = |p: &ResponsePoint| ResponsePoint { motion: motion(&p.motion), ..p.clone() };
    let finer = |finer: &FinerPoint| FinerPoint { found: finer.found.as_deref().map(one).map(Box::new), ..*finer };
    let finer = curve.finer.iter().map(finer).collect();
    ResponseCurve { points: curve.points.iter().map(one).collect(), finer, ..curve.clone() }
}

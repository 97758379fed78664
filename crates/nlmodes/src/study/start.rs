use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes_continuation::{Bound, Branch, ParametricSystem, StopReason};
use nlmodes_hbm::{CondensedStructure, Grazing, MixedShooting, RealSeries};

use super::branch::{continuation, problem};
use super::{BranchSettings, BranchStart, StudyError};

/// Most points on the way to a starting frequency.
const APPROACH: usize = 1000;

/// Scaled unknowns, parameter and direction with which a branch begins.
pub(super) struct Seed {
    pub x: Vec<f64>,
    pub p: f64,
    pub direction: Vec<f64>,
}

/// The beginning that the settings ask for.
///
/// A point at a given frequency is sought along the branch itself. Where an internal resonance leads that elsewhere, it is sought with
/// one harmonic, whose backbone nothing interrupts, and then corrected with more harmonics at that frequency.
pub(super) fn seed(
    structure: &CondensedStructure,
    settings: &BranchSettings,
    start: &Grazing,
    problem: &MixedShooting,
) -> Result<Seed, StudyError> {
    let dim = problem.dim();
    let BranchStart::Frequency { hz, upward } = settings.start else {
        return Ok(Seed {
            x: start.unknowns(problem.series(), dim),
            p: 0.0,
            direction: start.direction(problem.series(), dim),
        });
    };
    if let Ok((x, p, _)) = on_backbone(structure, settings, start, hz) {
        return Ok(Seed { x, p, direction: along_frequency(problem, upward) });
    }
    let coarse = BranchSettings { harmonics: 1, ..settings.clone() };
    let (mut x, mut p, mut series) = on_backbone(structure, &coarse, start, hz)?;
    for harmonics in ladder(settings.harmonics) {
        let step = BranchSettings { harmonics, ..settings.clone() };
        let mut problem = self::problem(structure, &step, start)?;
        let guess = embed(&x, series, problem.series(), start.mean.len(), problem.dim());
        let direction = along_frequency(&problem, true);
        let corrected = one_point(&step, start, &mut problem, &guess, p, &direction)
            .ok_or_else(|| no_start(hz, format!("Newton's method fails with {harmonics} harmonics")))?;
        series = problem.series();
        (x, p) = corrected;
    }
    Ok(Seed { x, p, direction: along_frequency(problem, upward) })
}

/// The point at the frequency `hz` to which the branch leads from grazing.
fn on_backbone(
    structure: &CondensedStructure,
    settings: &BranchSettings,
    start: &Grazing,
    hz: f64,
) -> Result<(Vec<f64>, f64, RealSeries), StudyError> {
    let mut problem = problem(structure, settings, start)?;
    let (dim, coordinate) = (problem.dim(), problem.frequency_index());
    let target = hz * TAU / start.omega;
    let mut method = continuation(settings, start, &problem, dim);
    let (min, max) = if target > 1.0 { (0.5, target) } else { (target, 2.0) };
    method.bounds.truncate(1); // the energy
    method.bounds.push(Bound { coordinate, min, max });
    method.max_points = APPROACH;
    let (x, direction) = (start.unknowns(problem.series(), dim), start.direction(problem.series(), dim));
    let Branch { mut points, stop, .. } =
        method.run(&mut problem, &x, 0.0, &direction, |_| ControlFlow::Continue(()))?;
    match (stop, points.pop()) {
        (StopReason::Bound { value, coordinate: at }, Some(last)) if at == coordinate && value == target => {
            Ok((last.x, last.p, problem.series()))
        }
        (_, last) => {
            let reached = last.map_or(start.omega, |point| problem.omega(&point.x)) / TAU;
            Err(no_start(hz, format!("the branch leads from {:.4} to {reached:.4} Hz", start.omega / TAU)))
        }
    }
}

fn no_start(hz: f64, reason: String) -> StudyError {
    StudyError::NoStart { hz, reason }
}

/// Numbers of harmonics on the way up from one.
fn ladder(harmonics: usize) -> Vec<usize> {
    let steps = std::iter::successors(Some(2_usize), |h| Some(h + h.div_ceil(2)));
    steps.take_while(|h| *h < harmonics).chain((harmonics > 1).then_some(harmonics)).collect()
}

/// The same motion with more harmonics, the new ones zero.
fn embed(x: &[f64], from: RealSeries, to: RealSeries, n_contact_dofs: usize, dim: usize) -> Vec<f64> {
    let (old, new) = (from.width(), to.width());
    let mut larger = vec![0.0; dim];
    for d in 0..n_contact_dofs {
        for n in 0..=from.n_harmonics {
            larger[d * new + n] = x[d * old + n];
            if let (true, Some(sine), Some(target)) = (n > 0, from.sine(n), to.sine(n)) {
                larger[d * new + target] = x[d * old + sine];
            }
        }
    }
    let (tail, larger_tail) = (n_contact_dofs * old, n_contact_dofs * new);
    larger[larger_tail..].copy_from_slice(&x[tail..]);
    larger
}

fn along_frequency(problem: &MixedShooting, upward: bool) -> Vec<f64> {
    let mut direction = vec![0.0; problem.dim() + 1];
    direction[problem.frequency_index()] = if upward { 1.0 } else { -1.0 };
    direction
}

/// Corrects a guess at its own frequency.
fn one_point(
    settings: &BranchSettings,
    start: &Grazing,
    problem: &mut MixedShooting,
    x: &[f64],
    p: f64,
    direction: &[f64],
) -> Option<(Vec<f64>, f64)> {
    let mut method = continuation(settings, start, problem, problem.dim());
    method.max_points = 1;
    let branch = method.run(problem, x, p, direction, |_| ControlFlow::Continue(())).ok()?;
    branch.points.into_iter().next().map(|point| (point.x, point.p))
}

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes_continuation::{Bound, Branch, ParametricSystem, StopReason};
use nlmodes_hbm::{CondensedStructure, Grazing, MixedShooting, RealSeries};

use super::homotopy;
use super::prepare::{continuation, problem, within_window};
use super::touching::beginning;
use super::trace::Tracer;
use super::{BranchSettings, BranchStart, StudyError};

/// Most points on the way to a start.
const APPROACH: usize = 1000;

/// Numbers of harmonics from which a refinement begins, in the order in which they are tried.
pub(super) const FEW: [usize; 4] = [1, 2, 3, 5];

/// Points after which a branch has shown which way its frequency goes.
const HEADING: usize = 8;

/// Scaled unknowns, parameter and direction with which a branch begins.
#[derive(Debug, Clone)]
pub(super) struct Seed {
    pub x: Vec<f64>,
    pub p: f64,
    pub direction: Vec<f64>,
}

/// Where on the backbone a branch begins.
#[derive(Debug, Clone, Copy)]
pub(super) enum Target {
    /// At a frequency, Hz.
    Frequency(f64),
    /// At an averaged kinetic energy over that at grazing.
    Energy(f64),
}

impl Target {
    /// The coordinate of `z = (x, p)` that it fixes, and its value.
    fn coordinate(self, problem: &MixedShooting, start: &Grazing) -> (usize, f64) {
        match self {
            Self::Frequency(hz) => (problem.frequency_index(), hz * TAU / start.omega),
            Self::Energy(ratio) => (problem.dim(), ratio.ln()),
        }
    }

    fn not_found(self, reason: String) -> StudyError {
        match self {
            Self::Frequency(hz) => StudyError::NoStart { hz, reason },
            Self::Energy(ratio) => StudyError::NoStartAtEnergy { ratio, reason },
        }
    }

    /// Where the search begins: the coordinate at grazing.
    fn at_grazing(self) -> f64 {
        match self {
            Self::Frequency(_) => 1.0,
            Self::Energy(_) => 0.0,
        }
    }
}

/// The beginning that the settings ask for.
///
/// A point elsewhere is sought along the branch itself, and where an internal resonance leads that away, with fewer harmonics.
pub(super) fn seed(
    structure: &CondensedStructure,
    settings: &BranchSettings,
    start: &Grazing,
    problem: &MixedShooting,
) -> Result<Seed, StudyError> {
    let (target, upward) = match settings.start {
        BranchStart::Frequency { hz, upward } => (Target::Frequency(hz), upward),
        BranchStart::Energy { ratio, upward } => (Target::Energy(ratio), upward),
        BranchStart::Grazing => {
            let seed = beginning(structure, settings, start)?;
            if start.touches_at_rest() {
                within_window(settings, problem.omega(&seed.x) / TAU)?;
            }
            return Ok(seed);
        }
    };
    match on_backbone(structure, settings, start, target) {
        Ok((x, p, _)) => Ok(Seed { x, p, direction: along(problem, start, target, upward) }),
        Err(_) => refined(structure, settings, start, target, upward),
    }
}

/// A point found with few harmonics, whose backbone little interrupts, and then corrected with more and more, the frequency or the
/// energy kept.
pub(super) fn refined(
    structure: &CondensedStructure,
    settings: &BranchSettings,
    start: &Grazing,
    target: Target,
    upward: bool,
) -> Result<Seed, StudyError> {
    let mut failure = None;
    for first in FEW.into_iter().filter(|few| *few == 1 || *few < settings.harmonics) {
        match refined_from(structure, settings, start, target, upward, first) {
            Err(error @ (StudyError::NoStart { .. } | StudyError::NoStartAtEnergy { .. })) => {
                failure.get_or_insert(error);
            }
            outcome => return outcome,
        }
    }
    Err(failure.unwrap_or_else(|| target.not_found("no number of harmonics leads there".to_owned())))
}

fn refined_from(
    structure: &CondensedStructure,
    settings: &BranchSettings,
    start: &Grazing,
    target: Target,
    upward: bool,
    first: usize,
) -> Result<Seed, StudyError> {
    let coarse = BranchSettings { harmonics: first, ..settings.clone() };
    let (mut x, mut p, mut series) = on_backbone(structure, &coarse, start, target)?;
    for harmonics in ladder(first, settings.harmonics) {
        let step = BranchSettings { harmonics, ..settings.clone() };
        let mut problem = self::problem(structure, &step, start)?;
        let guess = embed(&x, series, problem.series(), start.mean.len(), problem.dim());
        let direction = along(&problem, start, target, true);
        let guess: Vec<f64> = guess.into_iter().chain([p]).collect();
        let (coordinate, _) = target.coordinate(&problem, start);
        let corrected = one_point(&step, start, &mut problem, &guess, &direction)
            .or_else(|| homotopy::solve(&mut problem, &guess, coordinate, &step.step))
            .ok_or_else(|| target.not_found(format!("Newton's method fails with {harmonics} harmonics")))?;
        series = problem.series();
        (x, p) = corrected;
    }
    let problem = self::problem(structure, settings, start)?;
    Ok(Seed { x, p, direction: along(&problem, start, target, upward) })
}

/// The point at the target to which the branch leads from grazing.
fn on_backbone(
    structure: &CondensedStructure,
    settings: &BranchSettings,
    start: &Grazing,
    target: Target,
) -> Result<(Vec<f64>, f64, RealSeries), StudyError> {
    let mut problem = problem(structure, settings, start)?;
    let dim = problem.dim();
    let (coordinate, value) = target.coordinate(&problem, start);
    let mut method = continuation(settings, start, &problem, dim);
    method.bounds.truncate(1); // the energy
    let (min, max) = if value > target.at_grazing() { (f64::NEG_INFINITY, value) } else { (value, f64::INFINITY) };
    match target {
        Target::Frequency(_) => method.bounds.push(Bound { coordinate, min: min.max(0.5), max: max.min(2.0) }),
        Target::Energy(_) => method.bounds[0] = Bound { coordinate, min: min.max(method.bounds[0].min), max },
    }
    method.max_points = APPROACH;
    let Seed { x, direction, .. } = beginning(structure, settings, start)?;
    let Branch { mut points, stop, .. } =
        method.run(&mut problem, &x, 0.0, &direction, |_| ControlFlow::Continue(()))?;
    match (stop, points.pop()) {
        (StopReason::Bound { value: at, coordinate: c }, Some(last)) if c == coordinate && at == value => {
            Ok((last.x, last.p, problem.series()))
        }
        (_, last) => {
            let (omega, p) = last.map_or((start.omega, 0.0), |point| (problem.omega(&point.x), point.p));
            let [from, to] = [start.omega / TAU, omega / TAU];
            let reason = format!("the branch leads from {from:.4} to {to:.4} Hz and {:.4} grazing energies", p.exp());
            Err(target.not_found(reason))
        }
    }
}

/// Whether the backbone from `seed` leads to higher frequencies: as asked for, else as with one harmonic.
pub(super) fn heading(tracer: &Tracer, seed: &Seed) -> Result<bool, StudyError> {
    if let BranchStart::Frequency { upward, .. } = tracer.settings.start {
        return Ok(upward);
    }
    let coarse = BranchSettings { harmonics: 1, start: BranchStart::Grazing, ..tracer.settings.clone() };
    let mut problem = problem(tracer.structure, &coarse, tracer.grazing)?;
    let dim = problem.dim();
    let mut method = continuation(&coarse, tracer.grazing, &problem, dim);
    method.max_points = HEADING;
    let Seed { x, direction, .. } = beginning(tracer.structure, &coarse, tracer.grazing)?;
    let branch = method.run(&mut problem, &x, 0.0, &direction, |_| ControlFlow::Continue(()))?;
    let rises = branch.points.last().is_none_or(|last| last.x[problem.frequency_index()] >= 1.0);
    let towards_more_energy = seed.direction.last().is_none_or(|d| *d >= 0.0);
    Ok(rises == towards_more_energy)
}

/// Numbers of harmonics on the way from `first` to `last`.
pub(super) fn ladder(first: usize, last: usize) -> Vec<usize> {
    let steps = std::iter::successors(Some(first), |h| Some(h + h.div_ceil(2))).skip(1);
    steps.take_while(|h| *h < last).chain((last > first).then_some(last)).collect()
}

/// The same motion with more harmonics, the new ones zero.
pub(super) fn embed(x: &[f64], from: RealSeries, to: RealSeries, n_contact_dofs: usize, dim: usize) -> Vec<f64> {
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

/// Unit vector along the coordinate that the target fixes.
fn along(problem: &MixedShooting, start: &Grazing, target: Target, upward: bool) -> Vec<f64> {
    let mut direction = vec![0.0; problem.dim() + 1];
    direction[target.coordinate(problem, start).0] = if upward { 1.0 } else { -1.0 };
    direction
}

/// Corrects a guess across `direction`.
pub(super) fn one_point(
    settings: &BranchSettings,
    start: &Grazing,
    problem: &mut MixedShooting,
    z: &[f64],
    direction: &[f64],
) -> Option<(Vec<f64>, f64)> {
    let mut method = continuation(settings, start, problem, problem.dim());
    method.max_points = 1;
    let (p, x) = z.split_last()?;
    let branch = method.run(problem, x, *p, direction, |_| ControlFlow::Continue(())).ok()?;
    branch.points.into_iter().next().map(|point| (point.x, point.p))
}

//! The beginning of a branch, also where contacts touch at rest.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes_contact::solver_by_name;
use nlmodes_continuation::{Bound, Continuation, ParametricSystem, RunLog, StopReason, Watched};
use nlmodes_hbm::{CondensedStructure, FEW_HARMONICS, Grazing, RealSeries, ShrinkingGaps, harmonics_on_the_way};

use super::homotopy::{self, Effort};
use super::periodic::Periodic;
use super::prepare::problem;
use super::start::{Seed, one_point};
use super::{BranchError, BranchSettings};

/// Most points on the way from contacts that are set back to contacts that touch.
const MOST: usize = 1000;

/// Share of the amplitude by which a start may lie beyond grazing by rounding.
const ROUNDED: f64 = 1e-9;

/// Share of the amplitude at which a mode touches at which it is clear of the stops.
const CLEAR: f64 = 0.99;

/// The linear mode that just touches; where contacts touch at rest, the motion before them at the energy of the start.
pub(super) fn beginning(
    problem: &mut Periodic,
    settings: &BranchSettings,
    start: &Grazing,
    log: &mut dyn RunLog,
) -> Result<Seed, BranchError> {
    match problem.harmonics() {
        Some(harmonic) if start.touches_at_rest() => {
            let harmonics = harmonic.series().n_harmonics;
            before_touching_contacts(
                harmonic.structure(),
                &BranchSettings { harmonics, ..settings.clone() },
                start,
                log,
            )
        }
        _ => {
            let (x, direction) = problem.start(start);
            Ok(before_contact(problem, settings, start, Seed { x, p: 0.0, direction, harmonics: settings.harmonics }))
        }
    }
}

/// The start, taken back to where nothing touches yet if corrected it would touch by rounding. In contact the branch
/// may turn towards less energy: of its two ways the one of growing amplitude then leads out of contact and back along
/// the linear mode.
fn before_contact(problem: &mut Periodic, settings: &BranchSettings, start: &Grazing, seed: Seed) -> Seed {
    let back = |share: f64| {
        let x = seed.x.iter().zip(&seed.direction).map(|(x, d)| x - share * d).collect();
        let p = seed.p - share * seed.direction.last().copied().unwrap_or(0.0);
        Seed { x, p, ..seed.clone() }
    };
    let Some(clear) = problem.pattern_at(&back(1.0 - CLEAR).point()) else { return seed };
    let mut is_clear = |seed: &Seed| {
        let corrected = one_point(settings, start, problem, &seed.point(), &seed.direction, &mut ());
        corrected.is_some_and(|(mut z, p)| {
            z.push(p);
            problem.pattern_at(&z) == Some(clear)
        })
    };
    let shares = std::iter::successors(Some(f64::EPSILON), |share| Some(8.0 * share));
    let shares = std::iter::once(0.0).chain(shares.take_while(|share| *share < ROUNDED));
    let found = shares.map(back).find(&mut is_clear);
    found.unwrap_or(seed)
}

/// The contacts are closed with few harmonics, whose backbone little interrupts, and the motion is then corrected with
/// more and more.
fn before_touching_contacts(
    structure: &CondensedStructure,
    settings: &BranchSettings,
    start: &Grazing,
    log: &mut dyn RunLog,
) -> Result<Seed, BranchError> {
    settings.watch.begins("looking for the motion before contacts that touch at rest")?;
    let mut failure = None;
    for first in FEW_HARMONICS.into_iter().filter(|few| *few == 1 || *few < settings.harmonics) {
        match refined_from(structure, settings, start, first, log) {
            Err(BranchError::NoStartTouching { reason }) => failure = failure.or(Some(reason)),
            outcome => return outcome,
        }
    }
    Err(BranchError::NoStartTouching { reason: failure.unwrap_or_default() })
}

fn refined_from(
    structure: &CondensedStructure,
    settings: &BranchSettings,
    start: &Grazing,
    first: usize,
    log: &mut dyn RunLog,
) -> Result<Seed, BranchError> {
    let (mut x, mut series) = close(structure, &BranchSettings { harmonics: first, ..settings.clone() }, start, log)?;
    for harmonics in harmonics_on_the_way(first, settings.harmonics) {
        let finer = BranchSettings { harmonics, ..settings.clone() };
        let problem = problem(structure, &finer, start)?;
        let (next, dim) = (problem.series(), problem.dim());
        let guess: Vec<f64> = problem.resized(&x, series).into_iter().chain([0.0]).collect();
        let mut problem = Periodic::in_harmonics(problem, &finer);
        let mut energy = vec![0.0; dim + 1];
        energy[dim] = 1.0;
        let corrected = one_point(&finer, start, &mut problem, &guess, &energy, log)
            .or_else(|| homotopy::solve(&mut problem, &guess, dim, &finer.step, Effort::FULL, log));
        let Some((found, _)) = corrected else {
            return Err(BranchError::NoStartTouching {
                reason: format!("Newton's method fails with {harmonics} harmonics"),
            });
        };
        (x, series) = (found, next);
    }
    let direction = growing(&x, &problem(structure, settings, start)?.coefficients_at_rest(start));
    Ok(Seed { x, p: 0.0, direction, harmonics: settings.harmonics })
}

/// The motion to which that before contacts that are set back leads as they are closed.
fn close(
    structure: &CondensedStructure,
    settings: &BranchSettings,
    start: &Grazing,
    log: &mut dyn RunLog,
) -> Result<(Vec<f64>, RealSeries), BranchError> {
    let problem = problem(structure, settings, start)?;
    let (series, dim, frequency) = (problem.series(), problem.dim(), problem.frequency_index());
    let solver = solver_by_name(&settings.contact_solver)?;
    let mut closing =
        ShrinkingGaps::new(structure, problem.settings(), start.scales(), &start.opening, solver.as_ref())?;
    let bounds = vec![Bound { coordinate: dim, min: 0.0, max: 1.5 }];
    let method = Continuation { step: settings.step.clone(), bounds, max_points: MOST, ..Continuation::default() };
    let mut direction = vec![0.0; dim + 1];
    direction[dim] = -1.0;
    let mut closing = Watched { system: &mut closing, watch: &settings.watch };
    let x = closing.system.start(start);
    let branch = method
        .run_with_log(&mut closing, &x, 1.0, &direction, log, |_| ControlFlow::Continue(()))
        .map_err(|error| BranchError::NoStartTouching { reason: error.to_string() })?;
    match (branch.stop, branch.points.into_iter().next_back()) {
        (StopReason::Bound { value: 0.0, .. }, Some(last)) => Ok((last.x, series)),
        (stop, last) => {
            let (share, omega) = last.map_or((1.0, 1.0), |q| (q.p * q.p, q.x[frequency]));
            let hz = omega * start.omega / TAU;
            let reason =
                format!("with gaps made smaller, the way ends at {share:.3} of the first, at {hz:.4} Hz ({stop:?})");
            Err(BranchError::NoStartTouching { reason })
        }
    }
}

/// Direction of growing energy where motions can be multiplied: the distance from rest grows like the root of the
/// energy.
fn growing(x: &[f64], rest: &[f64]) -> Vec<f64> {
    let mut direction = vec![0.0; x.len() + 1];
    direction.iter_mut().zip(x).zip(rest).for_each(|((to, x), rest)| *to = 0.5 * (x - rest));
    direction[x.len()] = 1.0;
    direction
}

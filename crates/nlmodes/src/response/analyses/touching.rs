use nlmodes_contact::LcpSolver;
use nlmodes_continuation::{Bound, ParametricSystem, StopReason};
use nlmodes_hbm::{FEW_HARMONICS, PeriodicSystem, RealSeries, harmonics_on_the_way};

use crate::response::follow::{Curve, newton};
use crate::response::{ResponseError, ResponseSettings};

/// Most points on the way from contacts that are set back to contacts that touch.
const MOST: usize = 1000;

/// Unknowns of a mode or a phase resonance before contacts that touch at rest without force: those to which `x` lead,
/// its motion at the parameter zero before contacts that are set back by `opening` (m, c), as these are closed.
///
/// They are closed with few harmonics, whose curves little interrupts, and the motion is then corrected with more and
/// more.
///
/// # Errors
/// [`ResponseError::NoModeTouching`] where the way does not arrive, [`ResponseError::Stopped`].
pub(super) fn as_gaps_close(
    system: &PeriodicSystem,
    x: &[f64],
    opening: &[f64],
    by: (&ResponseSettings, &dyn LcpSolver),
) -> Result<Vec<f64>, ResponseError> {
    let (all, least) = (system.series().n_harmonics, system.load().highest_harmonic().max(1));
    let few = FEW_HARMONICS.into_iter().filter(|few| (least..all).contains(few));
    let mut failure = None;
    for first in few.chain([all]) {
        match refined_from(system, x, opening, first, by) {
            Err(error @ ResponseError::NoModeTouching { .. }) => {
                failure.get_or_insert(error);
            }
            outcome => return outcome,
        }
    }
    Err(failure.unwrap_or(ResponseError::NoModeTouching { left: 0.0, why: String::new() }))
}

fn refined_from(
    system: &PeriodicSystem,
    x: &[f64],
    opening: &[f64],
    first: usize,
    by: (&ResponseSettings, &dyn LcpSolver),
) -> Result<Vec<f64>, ResponseError> {
    let all = system.series().n_harmonics;
    let few = system.with_harmonics(first, by.1)?;
    let (mut series, start) = (few.series(), few.resized(x, system.series()));
    let mut x = closed(few, start, opening, by)?;
    for harmonics in harmonics_on_the_way(first, all) {
        // In one step, or in as many as there are harmonics between.
        let between = (series.n_harmonics + 1..=harmonics).collect();
        let ways: [Vec<usize>; 2] = [vec![harmonics], between];
        let failed = || ResponseError::NoModeTouching {
            left: 0.0,
            why: format!("Newton's method fails with {harmonics} harmonics"),
        };
        let mut found = None;
        for way in ways.into_iter().filter(|_| !by.0.watch.asks_to_end()) {
            found = finer(system, (&x, series), &way, by.1)?;
            if found.is_some() {
                break;
            }
        }
        (x, series) = found.ok_or_else(failed)?;
    }
    Ok(x)
}

/// A motion corrected with each of these numbers of harmonics, one after the other; none where one of them fails.
fn finer(
    system: &PeriodicSystem,
    (x, series): (&[f64], RealSeries),
    way: &[usize],
    solver: &dyn LcpSolver,
) -> Result<Option<(Vec<f64>, RealSeries)>, ResponseError> {
    let (mut x, mut series) = (x.to_vec(), series);
    for &harmonics in way {
        let mut finer = system.with_harmonics(harmonics, solver)?;
        let guess = finer.resized(&x, series);
        finer.hold_phase(&guess);
        series = finer.series();
        match newton(&mut finer, &guess, 0.0) {
            Some(found) => x = found,
            None => return Ok(None),
        }
    }
    Ok(Some((x, series)))
}

fn closed(
    system: PeriodicSystem,
    x: Vec<f64>,
    opening: &[f64],
    (settings, solver): (&ResponseSettings, &dyn LcpSolver),
) -> Result<Vec<f64>, ResponseError> {
    let system = system.beside_opening(opening.to_vec())?;
    let n = system.dim();
    let mut direction = vec![0.0; n + 1];
    direction[n] = -1.0;
    let bounds = vec![Bound { coordinate: n, min: 0.0, max: 1.5 }];
    let own = ResponseSettings { max_points: MOST, ..settings.clone() };
    let budget = own.budget();
    let mut curve = Curve { system, x, p: 1.0, direction, bounds, drive: None, settings: &own, solver, budget };
    let branch = curve.run()?;
    let last = branch.points.last().map_or((1.0, Vec::new()), |q| (q.p, q.x.clone()));
    match &branch.stop {
        StopReason::Bound { coordinate, value } if *coordinate == n && *value == 0.0 => Ok(last.1),
        StopReason::Stopped => Err(ResponseError::Stopped),
        stop => {
            let by = opening.iter().copied().fold(0.0, f64::max);
            Err(ResponseError::NoModeTouching { left: last.0 * by, why: curve.end(stop, (usize::MAX, 1.0)).message })
        }
    }
}

/// Direction in which a motion is multiplied, of its unknowns `x` beside those at rest, as the parameter grows.
pub(super) fn growing(system: &PeriodicSystem, x: &[f64], rest: &[f64], by_parameter: f64) -> Vec<f64> {
    let n = system.n_coefficients();
    let mut direction: Vec<f64> = x[..n].iter().zip(rest).map(|(x, rest)| by_parameter * (x - rest)).collect();
    direction.resize(x.len(), 0.0);
    direction.push(1.0);
    direction
}

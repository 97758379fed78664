//! The beginning of a branch, also where contacts touch at rest.

use nlmodes_contact::solver_by_name;
use nlmodes_continuation::{ParametricSystem, RunLog};
use nlmodes_hbm::{Grazing, PeriodicSystem};

use super::periodic::Periodic;
use super::start::{Seed, one_point};
use super::{BranchError, BranchSettings, Ended};
use crate::touching::{Closing, NotClosed, growing};

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
        Some(harmonic) if start.touches_at_rest() => before_touching_contacts(harmonic, settings, start, log),
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

/// The motion before contacts that touch at rest at the energy of the start.
fn before_touching_contacts(
    system: &PeriodicSystem,
    settings: &BranchSettings,
    start: &Grazing,
    log: &mut dyn RunLog,
) -> Result<Seed, BranchError> {
    settings.watch.begins("looking for the motion before contacts that touch at rest")?;
    let solver = solver_by_name(&settings.contact_solver)?;
    let closing = Closing { step: &settings.step, solver: solver.as_ref(), watch: &settings.watch };
    let found = closing.unknowns(system, &start.unknowns(system), &start.opening, log);
    let x = found.map_err(|failure| match failure {
        NotClosed::Lost { left, why } => {
            let reason = format!("with gaps made smaller, the way ends at {left:.3} of the first: {why}");
            BranchError::NoStartTouching { reason }
        }
        NotClosed::Ended => Ended.into(),
        NotClosed::Problem(error) => error.into(),
    })?;
    // The distance from rest grows like the root of the energy.
    let direction = growing(system, &x, &start.coefficients_at_rest(system), 0.5);
    Ok(Seed { x, p: 0.0, direction, harmonics: system.series().n_harmonics })
}

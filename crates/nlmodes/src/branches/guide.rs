//! Branches with few harmonics, which few internal resonances interrupt: where the backbone is looked for.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes_continuation::{Bound, RunLog, StopReason};
use nlmodes_hbm::Grazing;

use super::periodic::Periodic;
use super::prepare::continuation;
use super::start::{Place, Seed, Target, along, one_point};
use super::touching::beginning;
use super::{BranchError, BranchSettings};

/// Most points of a guide.
const APPROACH: usize = 1000;

/// Frequencies of a guide, over that of its beginning.
const WINDOW: [f64; 2] = [0.5, 2.0];

/// The branch from its beginning with some number of harmonics.
pub(super) struct Guide {
    /// `z = (x, p)` of each point.
    points: Vec<Vec<f64>>,
    /// Coordinate and value of the bound at which it ended.
    bound: Option<(usize, f64)>,
    /// Angular frequency of its last point, rad/s.
    last_omega: f64,
}

impl Guide {
    /// Follows the branch to a target, or as far as the energies of the settings and the [`WINDOW`] allow.
    pub fn trace(
        problem: &mut Periodic,
        settings: &BranchSettings,
        start: &Grazing,
        to: Option<Target>,
        log: &mut dyn RunLog,
    ) -> Result<Self, BranchError> {
        let place = Place::from(&*problem);
        let mut method = continuation(settings, start, place.frequency, place.dim);
        method.bounds.truncate(1); // the energy
        let [mut low, mut high] = WINDOW;
        if let Some(target) = to {
            let (_, value) = target.coordinate(place, start);
            let energy = &mut method.bounds[0];
            match (target, value > target.at_grazing()) {
                (Target::Frequency(_), true) => high = value.min(high),
                (Target::Frequency(_), false) => low = value.max(low),
                (Target::Energy(_), true) => energy.max = value,
                (Target::Energy(_), false) => (energy.min, energy.max) = (value.max(energy.min), f64::INFINITY),
            }
        }
        if !matches!(to, Some(Target::Energy(_))) {
            method.bounds.push(Bound { coordinate: place.frequency, min: low, max: high });
        }
        method.max_points = APPROACH;
        let Seed { x, p, direction, .. } = beginning(problem, settings, start, log)?;
        let branch = method.run_with_log(problem, &x, p, &direction, log, |_| ControlFlow::Continue(()))?;
        let last_omega = branch.points.last().map_or(start.omega, |last| problem.omega(&last.x));
        let bound = match branch.stop {
            StopReason::Bound { coordinate, value } => Some((coordinate, value)),
            _ => None,
        };
        Ok(Self { points: branch.points.iter().map(|point| point.z()).collect(), bound, last_omega })
    }

    /// The first point of the branch at the target.
    pub fn at(
        &self,
        problem: &mut Periodic,
        settings: &BranchSettings,
        start: &Grazing,
        target: Target,
        log: &mut dyn RunLog,
    ) -> Result<(Vec<f64>, f64), BranchError> {
        let place = Place::from(&*problem);
        let (coordinate, value) = target.coordinate(place, start);
        let split = |z: &[f64]| z.split_last().map(|(p, x)| (x.to_vec(), *p));
        let passes = |pair: &&[Vec<f64>]| (pair[0][coordinate] - value) * (pair[1][coordinate] - value) <= 0.0;
        let found = match self.points.windows(2).find(passes) {
            _ if self.bound == Some((coordinate, value)) => self.points.last().and_then(|last| split(last)),
            Some(pair) => {
                let (from, to) = (&pair[0], &pair[1]);
                let length = to[coordinate] - from[coordinate];
                let share = if length == 0.0 { 0.0 } else { (value - from[coordinate]) / length };
                let mut guess: Vec<f64> = from.iter().zip(to).map(|(a, b)| a + share * (b - a)).collect();
                guess[coordinate] = value;
                one_point(settings, start, problem, &guess, &along(place, start, target, true), log)
            }
            None => None,
        };
        found.ok_or_else(|| {
            let [from, to] = [start.omega / TAU, self.last_omega / TAU];
            let energy = self.points.last().and_then(|z| z.last()).map_or(1.0, |p| p.exp());
            let word = start.word();
            target.not_found(format!("the branch leads from {from:.4} to {to:.4} Hz and {energy:.4} {word} energies"))
        })
    }
}

/// Guides with different numbers of harmonics, each followed when it is asked for.
#[derive(Default)]
pub(super) struct Guides {
    /// Where they end, if not at the energies of the settings and the [`WINDOW`].
    to: Option<Target>,
    traced: BTreeMap<usize, Guide>,
}

impl Guides {
    /// That end at a target.
    pub fn to(target: Target) -> Self {
        Self { to: Some(target), ..Self::default() }
    }

    /// The guide of the problem, which has the harmonics of the settings.
    pub fn of(
        &mut self,
        problem: &mut Periodic,
        settings: &BranchSettings,
        start: &Grazing,
        log: &mut dyn RunLog,
    ) -> Result<&Guide, BranchError> {
        Ok(match self.traced.entry(settings.harmonics) {
            Entry::Occupied(traced) => traced.into_mut(),
            Entry::Vacant(none) => none.insert(Guide::trace(problem, settings, start, self.to, log)?),
        })
    }
}

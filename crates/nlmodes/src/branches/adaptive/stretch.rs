//! What runs with one number of harmonics leave to the next one.

use nlmodes_continuation::BranchPoint;
use nlmodes_hbm::{RealSeries, TruncationError};
use nlmodes_modal::Event;

use super::carry::{LIKE, Place};
use crate::branches::found::{First, Found};
use crate::branches::stability::length;

/// Share of the unknowns within which points with different numbers of harmonics are the same, if that many in a row
/// are.
const BACK_WITHIN: f64 = 0.02;
const SURELY_BACK: usize = 3;

/// Logarithm of the energy by which a branch from grazing is back on the linear mode below it.
const BELOW: f64 = 1e-4;

/// A point without events that counts, from which the branch may go on with another number of harmonics.
#[derive(Clone)]
pub(super) struct Base {
    pub point: BranchPoint,
    /// The layout of its unknowns.
    pub series: RealSeries,
    /// Whether its error is as small as was asked for: then the branch with more harmonics is near.
    pub is_accurate: bool,
    pub is_shown: bool,
    /// Points that were shown up to it.
    pub shown: usize,
}

/// Why a run with one number of harmonics gives way to another.
pub(super) enum Change {
    /// At least this number takes over, from this point or one before it.
    From(Base, usize),
    /// Since the last change, at this point, the branch leads nowhere but back to where it came from.
    Undo(Base),
}

/// Points that wait to be shown until one without events behind them counts, and where the branch goes on if none does.
pub(super) struct Stretch {
    /// Limits of the frequency, over that of grazing.
    pub frequency: Option<[f64; 2]>,
    /// The last point without events that counts.
    pub base: Option<Base>,
    pub waiting: Vec<(BranchPoint, Option<TruncationError>, Vec<Event>)>,
    /// Events of the first point of the next run.
    pub first: Vec<Event>,
    /// The first point of the next run is known and is not kept.
    pub known: bool,
    pub at_limit: bool,
    /// Points that were shown with this accuracy.
    accurate: Vec<Base>,
    /// Where the number of harmonics was changed. Behind an internal-resonance branch that only the former number has,
    /// another one may know but the branch beside it, and lead back along that: the beam of Peter et al. falls back to
    /// grazing with an accuracy of 2e-3 where changes stay.
    pub changes: Vec<Base>,
    /// Points in a row since the last one that lie where the branch has been before it.
    back: usize,
    /// The branch began at grazing, with growing energy.
    from_grazing: bool,
}

impl Stretch {
    pub fn new(first: &First, frequency: Option<[f64; 2]>) -> Self {
        Self {
            frequency,
            base: None,
            waiting: Vec::new(),
            first: if let First::Named(event) = first { vec![*event] } else { Vec::new() },
            known: matches!(first, First::Known),
            at_limit: false,
            accurate: Vec::new(),
            changes: Vec::new(),
            back: 0,
            from_grazing: matches!(first, First::Named(Event::Grazing | Event::LiftOff)),
        }
    }

    /// A point that counts, and where the branch goes on if the next one does not.
    pub fn counts(&mut self, base: Base) {
        if base.is_accurate && base.is_shown {
            self.accurate.push(base.clone());
        }
        self.base = Some(base);
    }

    /// Where more harmonics are tried: the last point that counts, and of those with this accuracy the ones so many
    /// points before the last of them.
    pub fn bases(&self, last: &Base, back: &[usize]) -> Vec<Base> {
        let earlier = back.iter().filter_map(|back| self.accurate.len().checked_sub(back + 1));
        std::iter::once(last).chain(earlier.map(|k| &self.accurate[k])).cloned().collect()
    }

    /// The branch goes on from this point: what was shown since then is found anew.
    pub fn go_back_to(&mut self, base: &Base, found: &mut Found) {
        found.truncate(base.shown);
        self.accurate.retain(|accurate| accurate.shown <= base.shown);
        self.base = Some(base.clone());
        self.back = 0;
    }

    /// The last change of the number of harmonics, if no point has been shown since then.
    pub fn change_without_points(&mut self, found: &Found) -> Option<Base> {
        self.changes.pop_if(|change| change.shown == found.points.len())
    }

    /// The last change of the number of harmonics, if the branch has come back to where it was before, and goes back
    /// along that.
    pub fn change_that_runs_back(
        &mut self,
        point: &BranchPoint,
        error: &TruncationError,
        found: &Found,
        place: &Place,
    ) -> Option<Base> {
        let change = self.changes.last()?;
        let near = (LIKE * error.motion * length(&point.x)).max(BACK_WITHIN * length(&point.x));
        let back = place.passed_before(point, near, found, change.shown);
        self.back = if back { self.back + 1 } else { 0 };
        let below = self.from_grazing && point.p < -BELOW;
        if below || self.back >= SURELY_BACK { self.changes.pop() } else { None }
    }
}

//! What runs with one number of harmonics leave to the next one.

use nlmodes_continuation::BranchPoint;
use nlmodes_hbm::{RealSeries, TruncationError};
use nlmodes_modal::Event;

use super::carry::{LIKE, Place};
use crate::branches::found::Found;
use crate::branches::stability::length;

/// Share of the unknowns within which points with different numbers of harmonics are the same, if that many in a row are.
const BACK_WITHIN: f64 = 0.02;
const SURELY_BACK: usize = 3;

/// Logarithm of the energy by which a branch from grazing is back on the linear mode below it.
const BELOW: f64 = 1e-4;

/// A point that was shown with its accuracy, the layout of its unknowns, and the number of points shown by then.
pub(super) type Passed = (BranchPoint, RealSeries, usize);

/// Points that wait to be shown until one without events behind them counts, and where the branch goes on if none does.
pub(super) struct Stretch {
    /// The last point without events that counts, and the layout of its unknowns.
    pub base: Option<(BranchPoint, RealSeries)>,
    pub base_is_shown: bool,
    /// Whether its error is as small as was asked for: then the branch with more harmonics is near.
    pub base_is_accurate: bool,
    pub waiting: Vec<(BranchPoint, Option<TruncationError>, Vec<Event>)>,
    /// Events of the first point of the next run.
    pub first: Vec<Event>,
    /// Points without events that were shown with this accuracy, each with the number of points shown by then.
    pub passed: Vec<Passed>,
    /// Most points that were shown when some were taken back. Only a branch that has come further is taken back again, or there would be
    /// no end to it where numbers of harmonics lead back to each other.
    pub furthest: usize,
    /// The first point of the next run is known and is not kept.
    pub known: bool,
    pub at_limit: bool,
    /// Where more harmonics are tried until points with them are shown.
    pub tried_from: Option<Trial>,
    /// They have not helped, which the next point is to say.
    pub in_vain: bool,
    /// Changes of the number of harmonics, until they are undone.
    pub changes: Vec<Undo>,
    /// Points in a row since the last one that lie where the branch has been before it.
    pub back: usize,
    /// The branch began at grazing, with growing energy.
    pub from_grazing: bool,
}

/// Where the number of harmonics was changed.
///
/// Behind a tongue that only the former number has, another one may know but the branch beside it, and lead back along that. The beam
/// of Peter et al. falls back to grazing with an accuracy of 2e-3 where changes stay, and with 1e-2 also where the first three points of a change must not lead back.
pub(super) struct Undo {
    pub base: (BranchPoint, RealSeries),
    pub base_is_accurate: bool,
    /// Points shown by then, and of these the accurate ones.
    pub kept: usize,
    pub passed: usize,
}

/// Where more harmonics are tried from, and what was taken back for it.
pub(super) struct Trial {
    pub base: (BranchPoint, RealSeries),
    pub base_is_shown: bool,
    pub base_is_accurate: bool,
    pub first: Vec<Event>,
    pub known: bool,
    pub taken_back: Option<(Found, Vec<Passed>)>,
}

/// Why a run with one number of harmonics gives way to another.
#[derive(Clone, Copy)]
pub(super) enum Change {
    /// This number takes over.
    To(usize),
    /// More than this number have been tried in vain.
    BackTo(usize),
    /// Since the last one the branch runs back to where it came from.
    Undo,
}

impl Stretch {
    /// What it takes to undo a change of the number of harmonics at this base, when so many points are shown.
    pub fn undo(&self, base: &(BranchPoint, RealSeries), kept: usize) -> Undo {
        Undo { base: base.clone(), base_is_accurate: self.base_is_accurate, kept, passed: self.passed.len() }
    }

    /// Whether the branch has come back to where it was before the last change of the number of harmonics, and goes back along that.
    pub fn runs_back(&mut self, point: &BranchPoint, error: &TruncationError, found: &Found, place: &Place) -> bool {
        let Some(undo) = self.changes.last() else { return false };
        if self.from_grazing && point.p < -BELOW {
            return true;
        }
        let near = (LIKE * error.motion * length(&point.x)).max(BACK_WITHIN * length(&point.x));
        let back = place.passed_before(point, near, found, undo.kept);
        self.back = if back { self.back + 1 } else { 0 };
        self.back >= SURELY_BACK
    }

    /// More harmonics are tried from this base, if they are not from an earlier one.
    pub fn begin_trial(&mut self, base: &(BranchPoint, RealSeries), harmonics: usize) {
        if self.tried_from.is_some() || harmonics <= base.1.n_harmonics {
            return;
        }
        self.in_vain = false;
        self.tried_from = Some(Trial {
            base: base.clone(),
            base_is_shown: self.base_is_shown,
            base_is_accurate: self.base_is_accurate,
            first: self.first.clone(),
            known: self.known,
            taken_back: None,
        });
    }
}

//! The number of harmonics chosen from the estimates along a branch.

use nlmodes_hbm::TruncationError;

use crate::branches::Accuracy;
use crate::branches::accuracy::{AIM, OF_HARMONICS, ORDER};

/// Largest growth of the number of harmonics at once.
const GROWTH: f64 = 1.6;

/// Fewer harmonics are tried only if they are at most this share of those in use.
const WORTH_LESS: f64 = 0.75;

/// Points that fewer harmonics must have sufficed for, by their estimate, before they are tried.
const PATIENCE: usize = 5;

/// Points after a failed trial of fewer harmonics before the next one.
const AFTER_FAILURE: usize = 25;

/// More harmonics help if they lower the estimate at least to this share.
const HELPS: f64 = 0.5;

/// Trials of more harmonics in a row that do not help before the most are tried.
const IN_VAIN: usize = 2;

/// Changes that may be undone.
const MOST_UNDONE: usize = 2;

/// Points for which the number stays after it was found that more do not help, the first time and at most; each time it doubles.
const STAY: (usize, usize) = (8, 128);

/// What is done after a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Decision {
    /// The point counts.
    Keep,
    /// It counts, and the branch goes on from it with fewer harmonics.
    Fewer(usize),
    /// It does not; the branch goes on from the one before it with more harmonics.
    More(usize),
    /// It counts although its error is too large: there are no more harmonics.
    Limit,
    /// It does not: more harmonics than this have been tried since the last point that does, and do not help. The branch goes on
    /// from that point with these.
    InVain(usize),
    /// The modes of the held structure do not suffice.
    Modes,
}

/// Chooses the number of harmonics from the estimates along a branch.
#[derive(Debug, Clone)]
pub(in crate::branches) struct Control {
    accuracy: Accuracy,
    fewest: usize,
    /// Whether held modes can be added.
    more_modes: bool,
    harmonics: usize,
    /// Points in a row for which fewer harmonics would have sufficed, and the largest number that one of them needs.
    easy: (usize, usize),
    /// Points until fewer harmonics may be tried.
    pause: usize,
    /// Whether the number was lowered last.
    lowered: bool,
    /// Points for which the number stays, since no solution with another one was found, or more do not help.
    stays: usize,
    /// How long it stays the next time.
    next_stay: usize,
    /// What more harmonics have brought since the last point that was shown.
    raised: Raised,
    /// Points in a row that reach the accuracy.
    good: usize,
    /// Changes that were undone.
    undone: usize,
}

/// Trials of more harmonics from one point on.
#[derive(Debug, Clone, Copy, Default)]
struct Raised {
    /// The number that was last shown to help, with its estimate where that is too large; at first the one in use.
    best: Option<(usize, f64)>,
    /// Trials since then.
    in_vain: usize,
}

impl Control {
    pub fn new(accuracy: Accuracy, fewest: usize, more_modes: bool) -> Self {
        Self {
            accuracy,
            fewest,
            more_modes,
            harmonics: fewest,
            easy: (0, 0),
            pause: 0,
            lowered: false,
            stays: 0,
            next_stay: STAY.0,
            raised: Raised::default(),
            good: 0,
            undone: 0,
        }
    }

    /// The branch goes on with another number of harmonics.
    pub fn changed(&mut self, harmonics: usize) {
        if harmonics > self.harmonics && self.lowered {
            self.pause = AFTER_FAILURE;
        }
        self.lowered = harmonics < self.harmonics;
        self.harmonics = harmonics;
        self.easy = (0, 0);
    }

    /// The number is not lowered for some points.
    pub fn pause(&mut self) {
        self.pause = AFTER_FAILURE;
    }

    /// No solution with another number of harmonics was found here, or more do not help. Each time it stays longer.
    pub fn stay(&mut self) {
        (self.stays, self.pause) = (self.next_stay, self.next_stay);
        self.next_stay = (2 * self.next_stay).min(STAY.1);
        self.raised = Raised::default();
    }

    /// The last change led back. After some of them there are no more: the branch goes on to its limit with the number that it has.
    pub fn undo(&mut self) {
        self.undone += 1;
        self.stay();
    }

    /// Points of the present number of harmonics are shown: it serves.
    pub fn serves(&mut self) {
        self.raised = Raised::default();
    }

    /// What is done after a point with this estimate.
    pub(super) fn decide(&mut self, error: &TruncationError) -> Decision {
        let harmonics = self.harmonics;
        if self.more_modes && error.held_modes > (1.0 - OF_HARMONICS) * self.accuracy.error {
            return Decision::Modes;
        }
        let own = error.frequency - error.held_modes;
        let needed = self.needed(own);
        // Not a number where both are infinite.
        if own.is_nan() || own > OF_HARMONICS * self.accuracy.error {
            self.good = 0;
            return self.too_large(error, needed);
        }
        self.good += 1;
        if self.good >= PATIENCE {
            (self.stays, self.next_stay) = (0, STAY.0);
        }
        self.pause = self.pause.saturating_sub(1);
        if self.pause > 0 || needed as f64 > WORTH_LESS * harmonics as f64 || needed < self.fewest {
            self.easy = (0, 0);
            return Decision::Keep;
        }
        self.easy = (self.easy.0 + 1, self.easy.1.max(needed));
        if self.easy.0 < PATIENCE || self.undone >= MOST_UNDONE { Decision::Keep } else { Decision::Fewer(self.easy.1) }
    }

    /// What is done after a point whose harmonics leave out too much.
    fn too_large(&mut self, error: &TruncationError, needed: usize) -> Decision {
        let (harmonics, max) = (self.harmonics, self.accuracy.max_harmonics);
        let as_it_is = if error.frequency <= self.accuracy.error { Decision::Keep } else { Decision::Limit };
        if self.stays > 0 || self.undone >= MOST_UNDONE {
            self.stays = self.stays.saturating_sub(1);
            return as_it_is;
        }
        // Where both are infinite their difference is not a number.
        let own = Some(error.frequency - error.held_modes).filter(|e| !e.is_nan()).unwrap_or(f64::INFINITY);
        let Some((best, smallest)) = self.raised.best else {
            self.raised.best = Some((harmonics, own));
            return if harmonics < max { self.more(needed) } else { as_it_is };
        };
        if own < HELPS * smallest {
            self.raised = Raised { best: Some((harmonics, own)), in_vain: 0 };
            return if harmonics < max { self.more(needed) } else { as_it_is };
        }
        self.raised.in_vain += 1;
        match () {
            () if best >= max => as_it_is,
            () if harmonics >= max => Decision::InVain(best),
            () if self.raised.in_vain >= IN_VAIN => Decision::More(max),
            () => self.more(needed),
        }
    }

    /// More harmonics, but not too many at once; as many as that where some more have not helped.
    fn more(&self, needed: usize) -> Decision {
        let harmonics = self.harmonics;
        let most = ((GROWTH * harmonics as f64).ceil() as usize).max(harmonics + 2);
        let least = if self.raised.in_vain > 0 { most } else { harmonics + 2 };
        Decision::More(needed.clamp(least, most).min(self.accuracy.max_harmonics))
    }

    /// Harmonics with which the error would be what is aimed at, were it to fall with a power of their number.
    fn needed(&self, error: f64) -> usize {
        let factor = (error / (AIM * self.accuracy.error)).powf(1.0 / ORDER);
        let needed = (self.harmonics as f64 * factor).ceil();
        if needed.is_finite() { (needed as usize).max(self.fewest) } else { usize::MAX }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn control(harmonics: usize) -> Control {
        let mut control = Control::new(Accuracy { error: 1e-6, max_harmonics: 40 }, 2, true);
        control.changed(harmonics);
        control
    }

    fn error(frequency: f64, held_modes: f64) -> TruncationError {
        TruncationError { frequency, held_modes, motion: 0.0 }
    }

    #[test]
    fn more_harmonics_where_the_error_is_too_large_up_to_the_limit() {
        assert_eq!(control(10).decide(&error(6e-7, 0.0)), Decision::Keep);
        // 8e-6 over 2.5e-7 is two to the fifth: twice as many, but not at once.
        assert_eq!(control(10).decide(&error(8e-6, 0.0)), Decision::More(16));
        assert_eq!(control(10).decide(&error(8e-7, 0.0)), Decision::More(13));
        assert_eq!(control(39).decide(&error(f64::INFINITY, 0.0)), Decision::More(40));
        assert_eq!(control(40).decide(&error(1e-3, 0.0)), Decision::Limit);
    }

    #[test]
    fn fewer_harmonics_only_where_they_have_sufficed_for_long() {
        let mut control = control(20);
        let small = error(2.5e-7 / 32.0, 0.0);
        for _ in 1..PATIENCE {
            assert_eq!(control.decide(&small), Decision::Keep);
        }
        assert_eq!(control.decide(&small), Decision::Fewer(10));
        control.changed(10);
        assert_eq!(control.decide(&error(1e-5, 0.0)), Decision::More(16));
        control.changed(16);
        for _ in 1..AFTER_FAILURE {
            assert_eq!(control.decide(&error(1e-12, 0.0)), Decision::Keep);
        }
    }

    /// A trial of more harmonics after another, none of which lowers the estimate, and then the most.
    #[test]
    fn where_more_harmonics_do_not_help_the_number_stays() {
        let mut control = control(10);
        let large = error(1e-4, 0.0);
        for number in [16, 26, 40] {
            assert_eq!(control.decide(&large), Decision::More(number));
            control.changed(number);
        }
        assert_eq!(control.decide(&large), Decision::InVain(10));
        // It stays for some points, which count, and for twice as many the next time.
        for points in [STAY.0, 2 * STAY.0] {
            control.changed(10);
            control.stay();
            for _ in 0..points {
                assert_eq!(control.decide(&large), Decision::Limit);
            }
            assert_eq!(control.decide(&large), Decision::More(16));
        }
    }

    #[test]
    fn changes_that_lead_back_are_not_tried_for_ever() {
        let mut control = control(10);
        (0..MOST_UNDONE).for_each(|_| control.undo());
        for estimate in [1e-3, 1e-12, 1e-3] {
            for _ in 0..300 {
                let decision = control.decide(&error(estimate, 0.0));
                assert!(matches!(decision, Decision::Keep | Decision::Limit), "{decision:?}");
            }
        }
    }

    #[test]
    fn the_last_number_that_helped_is_kept() {
        let mut control = control(10);
        for (estimate, number) in [(1e-4, 16), (3e-5, 26), (2e-5, 40)] {
            assert_eq!(control.decide(&error(estimate, 0.0)), Decision::More(number));
            control.changed(number);
        }
        assert_eq!(control.decide(&error(2e-5, 0.0)), Decision::InVain(16));
        // The most, which do help, stay although they do not suffice.
        let mut control = self::control(30);
        assert_eq!(control.decide(&error(1e-4, 0.0)), Decision::More(40));
        control.changed(40);
        assert_eq!(control.decide(&error(1e-5, 0.0)), Decision::Limit);
        assert_eq!(control.decide(&error(1e-5, 0.0)), Decision::Limit);
    }

    #[test]
    fn held_modes_are_added_where_they_can_be() {
        assert_eq!(control(10).decide(&error(6e-7, 5e-7)), Decision::Modes);
        let mut given = Control::new(Accuracy { error: 1e-6, max_harmonics: 40 }, 2, false);
        given.changed(10);
        assert_eq!(given.decide(&error(6e-7, 5e-7)), Decision::Keep);
    }
}

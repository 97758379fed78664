//! The number of harmonics chosen from the estimates along a branch.

use nlmodes_hbm::TruncationError;

use crate::branches::{Accuracy, GrowthSettings};

/// What is done after a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Decision {
    /// The point counts.
    Keep,
    /// It does not; the branch goes on from the one before it with more harmonics.
    More(usize),
    /// It counts although its error is too large: there are no more harmonics, or none that lead on, which was found
    /// here or before.
    Limit { tried_here: bool },
    /// The modes of the held structure do not suffice.
    Modes,
}

/// Chooses the number of harmonics from the estimates along a branch.
#[derive(Debug, Clone, Copy)]
pub(in crate::branches) struct Control {
    accuracy: Accuracy,
    growth: GrowthSettings,
    fewest: usize,
    /// Whether held modes can be added.
    more_modes: bool,
    harmonics: usize,
    /// The least number that may be asked for next: more than was ever asked for, so that there is an end to it.
    next: usize,
    /// Points for which the number stays, since more do not lead on.
    stays: usize,
}

impl Control {
    pub fn new(accuracy: Accuracy, growth: GrowthSettings, fewest: usize, more_modes: bool) -> Self {
        Self { accuracy, growth, fewest, more_modes, harmonics: fewest, next: fewest, stays: 0 }
    }

    /// The branch goes on with this number of harmonics.
    pub fn changed(&mut self, harmonics: usize) {
        self.harmonics = harmonics;
        self.next = self.next.max(harmonics + 1);
    }

    /// More harmonics do not lead on here.
    pub fn stay(&mut self) {
        self.stays = self.growth.stay;
    }

    /// What is done after a point with this estimate.
    pub(super) fn decide(&mut self, error: &TruncationError) -> Decision {
        if self.more_modes && error.held_modes > (1.0 - self.growth.share) * self.accuracy.error {
            return Decision::Modes;
        }
        let own = error.frequency - error.held_modes;
        // Not a number where both are infinite.
        if !own.is_nan() && own <= self.growth.share * self.accuracy.error {
            return Decision::Keep;
        }
        if self.stays == 0 && self.next <= self.accuracy.max_harmonics {
            let more = self.more(own);
            self.next = more + 1;
            return Decision::More(more);
        }
        let tried_here = self.stays == self.growth.stay;
        self.stays = self.stays.saturating_sub(1);
        if error.frequency <= self.accuracy.error { Decision::Keep } else { Decision::Limit { tried_here } }
    }

    /// More harmonics than ever, but not too many at once.
    fn more(&self, error: f64) -> usize {
        let harmonics = self.harmonics;
        let most = ((self.growth.most * harmonics as f64).ceil() as usize).max(harmonics + 2);
        self.needed(error).clamp(harmonics + 2, most).max(self.next).min(self.accuracy.max_harmonics)
    }

    /// Harmonics with which the error would be what is aimed at, were it to fall with a power of their number.
    fn needed(&self, error: f64) -> usize {
        let factor = (error / (self.growth.aim * self.accuracy.error)).powf(1.0 / self.growth.order);
        let needed = (self.harmonics as f64 * factor).ceil();
        if needed.is_finite() { (needed as usize).max(self.fewest) } else { usize::MAX }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn control(harmonics: usize) -> Control {
        let mut control = Control::new(Accuracy { error: 1e-6, max_harmonics: 40 }, GrowthSettings::default(), 2, true);
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
        for large in [f64::INFINITY, f64::NAN] {
            assert_eq!(control(39).decide(&error(large, 0.0)), Decision::More(40));
            assert_eq!(control(40).decide(&error(large, 0.0)), Decision::Limit { tried_here: false });
        }
    }

    /// Each number asked for is larger than any before it, whether it was found or not.
    #[test]
    fn numbers_of_harmonics_are_asked_for_once() {
        for is_found in [true, false] {
            let (mut control, mut asked) = (control(10), vec![10]);
            for estimate in [1e-4, 1e-8].into_iter().cycle().take(1000) {
                if let Decision::More(more) = control.decide(&error(estimate, 0.0)) {
                    assert!(more > asked[asked.len() - 1] && more <= 40, "{more} after {asked:?}");
                    asked.push(more);
                    if is_found {
                        control.changed(more);
                    } else {
                        control.stay();
                    }
                }
            }
            assert!(matches!(control.decide(&error(1e-4, 0.0)), Decision::Limit { .. }));
            assert!(asked.len() > 3, "{asked:?}");
        }
    }

    #[test]
    fn where_more_harmonics_lead_nowhere_the_number_stays_for_some_points() {
        let mut control = control(10);
        assert_eq!(control.decide(&error(1e-4, 0.0)), Decision::More(16));
        control.stay();
        assert_eq!(control.decide(&error(1e-8, 0.0)), Decision::Keep);
        for point in 0..GrowthSettings::default().stay {
            assert_eq!(control.decide(&error(1e-4, 0.0)), Decision::Limit { tried_here: point == 0 });
        }
        assert_eq!(control.decide(&error(1e-8, 0.0)), Decision::Keep);
        assert_eq!(control.decide(&error(1e-4, 0.0)), Decision::More(17));
    }

    #[test]
    fn held_modes_are_added_where_they_can_be() {
        assert_eq!(control(10).decide(&error(6e-7, 5e-7)), Decision::Modes);
        let mut given = Control::new(Accuracy { error: 1e-6, max_harmonics: 40 }, GrowthSettings::default(), 2, false);
        given.changed(10);
        assert_eq!(given.decide(&error(6e-7, 5e-7)), Decision::Keep);
    }
}

//! Progress and outcome of a study.

use std::time::Duration;

use super::worker::Done;
use crate::case::Case;
use crate::store::Status;

/// Observer of the computation of a study.
pub trait StudyObserver {
    /// Called with the progress: once at the beginning, and after each case.
    fn progress(&mut self, _: &StudyOutcome) {}

    /// Whether the study is to end: the cases in progress end too, and continue the next time.
    fn is_cancelled(&self) -> bool {
        false
    }
}

impl StudyObserver for nlmodes_run::Silent {}

/// Outcome of a run of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyOutcome {
    /// Cases of this shard.
    pub cases: usize,
    /// Cases of it whose scene was rejected: they have a row, but nothing to compute.
    pub refused: usize,
    /// Cases of it with the scene of another one.
    pub repeated: usize,
    /// Cases that existed before.
    pub there: usize,
    /// Cases computed now, including failed ones.
    pub computed: usize,
    /// Cases without a branch, including earlier ones.
    pub failed: usize,
    /// Cases whose branch ended early, including earlier ones.
    pub incomplete: usize,
    /// Cases that another process is computing.
    pub elsewhere: usize,
    /// Whether the end was requested before all were complete.
    pub is_cut_off: bool,
    /// Duration from the first to the last case.
    pub wall_time: Duration,
}

impl StudyOutcome {
    pub(super) fn new(own: &[Case]) -> Self {
        Self {
            cases: own.len(),
            refused: own.iter().filter(|case| case.id.is_err()).count(),
            repeated: 0,
            there: 0,
            computed: 0,
            failed: 0,
            incomplete: 0,
            elsewhere: 0,
            is_cut_off: false,
            wall_time: Duration::ZERO,
        }
    }

    /// Whether every case of this shard is complete, with its branch or its reason.
    pub fn is_done(&self) -> bool {
        !self.is_cut_off && self.there + self.computed == self.to_compute()
    }

    /// Cases to compute, each scene once.
    pub fn to_compute(&self) -> usize {
        self.cases - self.refused - self.repeated
    }

    /// Cases per second; `None` before the first one is complete.
    pub fn rate(&self) -> Option<f64> {
        (self.computed > 0).then(|| self.computed as f64 / self.wall_time.as_secs_f64().max(1e-9))
    }

    /// Estimated time to the end.
    pub fn rest(&self) -> Option<Duration> {
        let left = self.to_compute().saturating_sub(self.there + self.computed) as f64;
        Duration::try_from_secs_f64(left / self.rate()?).ok()
    }

    pub(super) fn there(&mut self, status: Status) {
        self.there += 1;
        self.count(status);
    }

    pub(super) fn take(&mut self, done: &Done) {
        match done {
            Done::Ended(status) => {
                self.computed += 1;
                self.count(*status);
            }
            Done::There(status) => self.there(*status),
            Done::Elsewhere => self.elsewhere += 1,
            Done::CutOff => {}
        }
    }

    fn count(&mut self, status: Status) {
        match status {
            Status::Complete => {}
            Status::Incomplete => self.incomplete += 1,
            Status::Failed => self.failed += 1,
        }
    }
}

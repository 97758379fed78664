//! How far a study is, and what came out.

use std::time::Duration;

use super::{Shard, worker::Done};
use crate::case::Case;
use crate::store::Status;

/// How far a study is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StudyProgress {
    /// Cases of this run that are to be there at its end, each scene once.
    pub cases: usize,
    /// Those that were there before.
    pub there: usize,
    /// Those that were computed now, failed ones included.
    pub computed: usize,
    /// Those without a branch, of before and now.
    pub failed: usize,
    /// Those whose branch ended early, of before and now.
    pub incomplete: usize,
    /// Time since the first one began.
    pub time: Duration,
}

impl StudyProgress {
    /// Cases a second; nothing before the first one is done.
    pub fn rate(&self) -> Option<f64> {
        (self.computed > 0).then(|| self.computed as f64 / self.time.as_secs_f64().max(1e-9))
    }

    /// Time to the end, if it goes on like this.
    pub fn rest(&self) -> Option<Duration> {
        let left = self.cases.saturating_sub(self.there + self.computed) as f64;
        Duration::try_from_secs_f64(left / self.rate()?).ok()
    }
}

/// Whoever looks on while a study is computed.
pub trait StudyObserver {
    /// Takes note of how far it is: once at the beginning, and behind each case.
    fn progress(&mut self, progress: &StudyProgress);

    /// Whether the study is to end: the cases in progress end with it, and go on the next time.
    fn is_cancelled(&self) -> bool {
        false
    }
}

impl StudyObserver for nlmodes_run::Silent {
    fn progress(&mut self, _: &StudyProgress) {}
}

/// What a run of a study came to.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyOutcome {
    /// Cases of the whole study.
    pub of_study: usize,
    /// Cases of this shard.
    pub cases: usize,
    /// Cases of it whose scene was refused: they have a row, but nothing to compute.
    pub refused: usize,
    /// Cases of it with the scene of another one.
    pub repeated: usize,
    /// Cases that were there before.
    pub there: usize,
    /// Cases that were computed now, failed ones included.
    pub computed: usize,
    /// Cases without a branch, of before and now.
    pub failed: usize,
    /// Cases whose branch ended early, of before and now.
    pub incomplete: usize,
    /// Cases that another process is computing.
    pub elsewhere: usize,
    /// Whether it was asked to end before all were done.
    pub is_cut_off: bool,
    /// From the first to the last.
    pub wall_time: Duration,
}

impl StudyOutcome {
    pub(super) fn new(all: &[Case], shard: Shard) -> Self {
        let own = || all.iter().filter(|case| shard.has(case.number));
        Self {
            of_study: all.len(),
            cases: own().count(),
            refused: own().filter(|case| case.id.is_err()).count(),
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

    /// Whether every case of this shard is there, with its branch or with its reason.
    pub fn is_done(&self) -> bool {
        !self.is_cut_off && self.there + self.computed == self.to_compute()
    }

    fn to_compute(&self) -> usize {
        self.cases - self.refused - self.repeated
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

    pub(super) fn progress(&self, time: Duration) -> StudyProgress {
        StudyProgress {
            cases: self.to_compute(),
            there: self.there,
            computed: self.computed,
            failed: self.failed,
            incomplete: self.incomplete,
            time,
        }
    }
}

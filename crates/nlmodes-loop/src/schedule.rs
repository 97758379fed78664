use crate::PhaseLoopError;
use crate::error::{not_negative, positive};
use crate::steady::{Drifts, Sample, SteadyCriteria, Windows};

/// Most levels of a schedule.
pub const MAX_LEVELS: usize = 64;

/// Levels of a test and their timing.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelSchedule {
    /// Amplitudes in their order, in the unit of what is [controlled](crate::Controlled).
    pub levels: [f64; MAX_LEVELS],
    /// How many of them there are.
    pub count: usize,
    /// Time from one level to the next, and to zero after the last, s.
    pub ramp: f64,
    /// Time at the first level with frozen frequency, s, until response and detector have settled; zero: the frequency
    /// is not frozen on the way there either.
    pub start: f64,
    /// When a level is steady.
    pub settling: SteadyCriteria,
    /// Length of the record of each level, s.
    pub record: f64,
}

impl LevelSchedule {
    /// These levels, with one second at the start, ramps and records of one second.
    ///
    /// # Errors
    /// [`PhaseLoopError::TooMany`].
    pub fn new(levels: &[f64]) -> Result<Self, PhaseLoopError> {
        let mut all = [0.0; MAX_LEVELS];
        if levels.len() > MAX_LEVELS {
            return Err(PhaseLoopError::TooMany { what: "levels", given: levels.len(), most: MAX_LEVELS });
        }
        all.iter_mut().zip(levels).for_each(|(mine, given)| *mine = *given);
        Ok(Self {
            levels: all,
            count: levels.len(),
            ramp: 1.0,
            start: 1.0,
            settling: SteadyCriteria::default(),
            record: 1.0,
        })
    }

    /// The levels.
    pub fn levels(&self) -> impl Iterator<Item = f64> + '_ {
        self.levels.iter().take(self.count).copied()
    }

    pub(crate) fn check(&self) -> Result<(), PhaseLoopError> {
        positive("number of levels", self.count as f64)?;
        if self.count > MAX_LEVELS {
            return Err(PhaseLoopError::TooMany { what: "levels", given: self.count, most: MAX_LEVELS });
        }
        for level in self.levels() {
            not_negative("level", level)?;
        }
        not_negative("time from level to level (s)", self.ramp)?;
        not_negative("time at the start (s)", self.start)?;
        not_negative("length of a record (s)", self.record)?;
        self.settling.check()
    }

    fn level(&self, index: usize) -> f64 {
        if index < self.count { self.levels.get(index).copied().unwrap_or(0.0) } else { 0.0 }
    }
}

/// What a test does at present.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Stage {
    /// On the way to a level.
    #[default]
    Ramp,
    /// At the first level with frozen frequency.
    Start,
    /// At a level, until it is steady.
    Settle,
    /// At a level that is to be recorded.
    Record,
    /// On the way to zero after the last level.
    Down,
    /// At zero after the last level.
    Finished,
    /// On the way to zero in an emergency.
    Stopping,
    /// At zero after an emergency.
    Stopped,
}

/// Where in its schedule a test is.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ScheduleState {
    pub(crate) stage: Stage,
    /// Index of the level, from zero.
    pub(crate) level: usize,
    /// Samples in this stage.
    pub(crate) samples: u64,
    /// Level at the beginning of a ramp.
    from: f64,
    /// Level that is wanted now.
    pub(crate) wanted: f64,
    windows: Windows,
    pub(crate) drifts: Drifts,
    /// Whether the level that is recorded was steady.
    pub(crate) settled: bool,
}

impl ScheduleState {
    pub(crate) const START: Self = Self {
        stage: Stage::Ramp,
        level: 0,
        samples: 0,
        from: 0.0,
        wanted: 0.0,
        windows: Windows::EMPTY,
        drifts: Drifts {
            lag_error: 0.0,
            lag_noise: 0.0,
            frequency_drift: 0.0,
            frequency_noise: 0.0,
            amplitude_drift: 0.0,
            amplitude_noise: 0.0,
            amplitude_deviation: 0.0,
            deviation_noise: 0.0,
            spread: 0.0,
            spread_noise: 0.0,
            harmonic_error: 0.0,
            windows: 0,
            settled: false,
        },
        settled: false,
    };

    /// The beginning of a schedule at the level that is wanted now.
    pub(crate) fn again(&self) -> Self {
        Self { from: self.wanted, wanted: self.wanted, ..Self::START }
    }

    /// Whether the frequency is frozen.
    pub(crate) fn freezes(&self, plan: &LevelSchedule) -> bool {
        match self.stage {
            Stage::Ramp => self.level == 0 && plan.start > 0.0,
            Stage::Settle | Stage::Record => false,
            _ => true,
        }
    }

    pub(crate) fn begin(&mut self, stage: Stage) {
        (self.stage, self.samples, self.from) = (stage, 0, self.wanted);
    }

    /// One sample further; `wrapped` where a period begins with it; `impeded` where something is at a limit, with which
    /// no level counts as settled.
    pub(crate) fn step(&mut self, plan: &LevelSchedule, sample: &Sample, wrapped: bool, impeded: bool, step: f64) {
        self.samples = self.samples.saturating_add(1);
        match self.stage {
            Stage::Ramp => {
                if self.ramp(plan.level(self.level), plan.ramp, step) {
                    self.arrive(plan);
                }
            }
            Stage::Start => {
                if self.is_over(plan.start, step) {
                    self.settle();
                }
            }
            Stage::Settle => {
                if let Some(found) = self.windows.push(&plan.settling, sample, wrapped, step) {
                    self.drifts = Drifts { settled: found.settled && !impeded, ..found };
                }
                if self.drifts.settled || self.is_over(plan.settling.longest, step) {
                    self.settled = self.drifts.settled;
                    self.begin(Stage::Record);
                }
            }
            Stage::Record => {
                if self.is_over(plan.record, step) {
                    self.level += 1;
                    self.begin(if self.level < plan.count { Stage::Ramp } else { Stage::Down });
                }
            }
            Stage::Down => {
                if self.ramp(0.0, plan.ramp, step) {
                    self.begin(Stage::Finished);
                }
            }
            Stage::Finished | Stage::Stopping | Stage::Stopped => {}
        }
    }

    fn arrive(&mut self, plan: &LevelSchedule) {
        if self.level == 0 && plan.start > 0.0 {
            self.begin(Stage::Start);
        } else {
            self.settle();
        }
    }

    fn settle(&mut self) {
        self.begin(Stage::Settle);
        (self.windows, self.drifts, self.settled) = (Windows::EMPTY, Self::START.drifts, false);
    }

    /// The level of this sample on a line to `to`; whether it is there.
    fn ramp(&mut self, to: f64, duration: f64, step: f64) -> bool {
        let all = samples(duration, step).max(1);
        let share = self.samples as f64 / all as f64;
        self.wanted = if self.samples >= all { to } else { self.from + share * (to - self.from) };
        self.samples >= all
    }

    fn is_over(&self, duration: f64, step: f64) -> bool {
        self.samples >= samples(duration, step)
    }
}

/// Samples in a time.
pub(crate) fn samples(duration: f64, step: f64) -> u64 {
    libm::round(duration / step) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MAX_HARMONICS;
    use crate::steady::Means;
    use num_complex::Complex64;
    use std::f64::consts::PI;

    fn steady(theta: f64) -> Sample {
        let means = Some(Means { omega: 250.0, response: 1.0, ..Means::ZERO });
        Sample { theta, signals: [theta.cos(), theta.sin()], means, missing: [Complex64::ZERO; MAX_HARMONICS] }
    }

    /// Stages and their lengths in samples, for a steady motion of ten samples a period.
    fn course(plan: &LevelSchedule, impeded: bool) -> Vec<(Stage, usize, u64)> {
        let (mut state, mut stages) = (ScheduleState::START, Vec::<(Stage, usize, u64)>::new());
        for k in 0..100_000_u32 {
            let (stage, level) = (state.stage, state.level);
            match stages.last_mut() {
                Some(last) if (last.0, last.1) == (stage, level) => last.2 += 1,
                _ => stages.push((stage, level, 1)),
            }
            let theta = 0.2 * PI * f64::from(k % 10);
            state.step(plan, &steady(theta), k.is_multiple_of(10), impeded, 1e-3);
        }
        stages
    }

    #[test]
    fn levels_follow_each_other_with_the_lengths_that_were_asked_for() {
        let settling = SteadyCriteria { periods: 5, windows: 3, longest: 2.0, ..SteadyCriteria::default() };
        let plan =
            LevelSchedule { ramp: 0.5, start: 0.3, record: 0.2, settling, ..LevelSchedule::new(&[1.0, 2.5]).unwrap() };
        let found = course(&plan, false);
        // Three windows of 50 samples, from the first beginning of a period on.
        let expected = [
            (Stage::Ramp, 0, 500),
            (Stage::Start, 0, 300),
            (Stage::Settle, 0, 151),
            (Stage::Record, 0, 200),
            (Stage::Ramp, 1, 500),
            (Stage::Settle, 1, 160),
            (Stage::Record, 1, 200),
            (Stage::Down, 2, 500),
        ];
        assert_eq!(found.len(), expected.len() + 1, "{found:?}");
        for (found, expected) in found.iter().zip(&expected) {
            assert_eq!((found.0, found.1), (expected.0, expected.1));
            // The first beginning of a period comes within ten samples.
            assert!(found.2.abs_diff(expected.2) < 10, "{found:?} {expected:?}");
        }
        assert_eq!(found[8].0, Stage::Finished);
        let held = course(&plan, true);
        assert!(held.contains(&(Stage::Settle, 0, 2000)) && held.contains(&(Stage::Settle, 1, 2000)), "{held:?}");
    }

    #[test]
    fn a_ramp_is_a_line_from_the_level_before_and_ends_at_the_next() {
        let plan = LevelSchedule { ramp: 0.01, ..LevelSchedule::new(&[1.0, 4.0]).unwrap() };
        let mut state = ScheduleState { level: 1, wanted: 1.0, from: 1.0, ..ScheduleState::START };
        for k in 1..=10 {
            state.step(&plan, &steady(0.0), false, false, 1e-3);
            assert!((state.wanted - (1.0 + 0.3 * f64::from(k))).abs() < 1e-14);
        }
        assert_eq!((state.stage, state.wanted), (Stage::Settle, 4.0));
    }
}

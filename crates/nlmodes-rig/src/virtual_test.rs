use std::ops::ControlFlow;

use nlmodes_experiment::phase_loop::LoopSettings;
use nlmodes_experiment::records::Record;

use num_complex::Complex64;

use crate::error::not_negative;
use crate::harmonics::HarmonicControl;
use crate::hold::Settling;
use crate::session::Session;
use crate::{ControlledHarmonics, Drive, Finding, Hold, RigError, RigSetup, SteadyState};

/// Levels of a test and their timing.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// Amplitudes of the drive in their order, N or V.
    pub levels: Vec<f64>,
    /// Time at the first level with frozen frequency, s, until response and detector have settled.
    pub start: f64,
    /// Time from one level to the next, s.
    pub ramp: f64,
    /// Criterion for a steady level.
    pub hold: Hold,
    /// Length of the record of each level, s.
    pub record: f64,
}

impl Schedule {
    /// These levels, with one second at the start, ramps of one second, the default hold and records of one second.
    pub fn new(levels: Vec<f64>) -> Self {
        Self { levels, start: 1.0, ramp: 1.0, hold: Hold::default(), record: 1.0 }
    }

    /// These levels, then back down from the last but one.
    pub fn up_and_down(mut levels: Vec<f64>) -> Self {
        let back: Vec<f64> = levels.iter().rev().skip(1).copied().collect();
        levels.extend(back);
        Self::new(levels)
    }
}

/// One level of a test.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LevelOutcome {
    /// Amplitude of the drive, N or V.
    pub level: f64,
    /// How it settled.
    pub settling: Settling,
    /// Means over the record.
    pub steady: SteadyState,
    /// Complex amplitudes of the force in the controlled harmonics 1, 2 … at its end, N, with phases relative to the
    /// cosine of the fundamental of the drive point's displacement; empty if only the fundamental is controlled.
    pub force_harmonics: Vec<Complex64>,
    /// Deviations after the hold, or within the record. Empty for a good level.
    pub findings: Vec<Finding>,
    /// Time of the first sample since the test began, s.
    pub start: f64,
    /// Samples of all channels, named by the number of the level in the schedule: `level-1`, `level-2` …
    pub record: Record,
}

/// A complete test: rig, loop, schedule.
#[derive(Debug, Clone, PartialEq)]
pub struct VirtualTest {
    /// The rig.
    pub rig: RigSetup,
    /// The loop.
    pub settings: LoopSettings,
    /// Channel of the excitation force, for the loop.
    pub force: usize,
    /// Channel of the response, for the loop.
    pub response: usize,
    /// Harmonics of the force that are controlled beyond the first; without them the loop controls the fundamental
    /// alone, and the exciter determines the others.
    pub harmonics: Option<ControlledHarmonics>,
    /// The levels.
    pub schedule: Schedule,
}

impl VirtualTest {
    /// Whether the test can start: rejects everything that [`run`](Self::run) rejects before its first sample.
    ///
    /// # Errors
    /// Those of [`Session::new`], [`RigError::DriveTooFast`] at the starting frequency, and unsuitable numbers in the
    /// schedule.
    pub fn check(&self) -> Result<(), RigError> {
        self.session().map(drop)
    }

    /// The rig at rest, ready for the schedule.
    fn session(&self) -> Result<Session, RigError> {
        let session = Session::new(self.rig.clone(), self.settings.clone(), self.force, self.response)?;
        self.schedule.hold.check()?;
        not_negative("time at the start (s)", self.schedule.start)?;
        for duration in [self.schedule.ramp, self.schedule.record] {
            not_negative("duration (s)", duration)?;
        }
        let mut first = Drive { omega: self.settings.start, ..Drive::OFF };
        if let Some(wanted) = &self.harmonics {
            HarmonicControl::new(session.rig(), session.control().settings(), wanted, None)?;
            first.amplitudes[0][wanted.harmonics - 1] = Complex64::ONE;
        }
        first.polynomial(0.0, 1.0 / session.rig().substeps() as f64, self.rig.interval)?;
        Ok(session)
    }

    /// Runs the schedule. `observe` is called with each level as soon as it is recorded.
    ///
    /// # Errors
    /// Those of [`Session::new`], of the motion, and of unsuitable numbers in the schedule. A level that does not
    /// settle is not an error: it is one of its findings.
    pub fn run(&self, mut observe: impl FnMut(&LevelOutcome)) -> Result<Vec<LevelOutcome>, RigError> {
        let told = |level: &LevelOutcome| {
            observe(level);
            ControlFlow::Continue(())
        };
        self.run_while(|| ControlFlow::Continue(()), told)
    }

    /// As [`run`](Self::run), as long as `asked`, called many times per level, permits, and up to the level after which
    /// `observe` ends it.
    ///
    /// # Errors
    /// As [`run`](Self::run); [`RigError::Interrupted`] if `asked` ended it.
    pub fn run_while(
        &self,
        asked: impl Fn() -> ControlFlow<()> + Send + Sync + 'static,
        mut observe: impl FnMut(&LevelOutcome) -> ControlFlow<()>,
    ) -> Result<Vec<LevelOutcome>, RigError> {
        let mut session = self.session()?.asking(asked);
        let mut outcomes = Vec::with_capacity(self.schedule.levels.len());
        for (index, &level) in self.schedule.levels.iter().enumerate() {
            session.hold_frequency(index == 0);
            session.ramp(level, self.schedule.ramp)?;
            if index == 0 {
                session.run(self.schedule.start)?;
                session.hold_frequency(false);
                if let Some(wanted) = &self.harmonics {
                    session.control_harmonics(wanted)?;
                }
            }
            let settling = session.settle(&self.schedule.hold)?;
            let start = session.rig().time();
            let (mut record, steady) = session.record(self.schedule.record)?;
            record.name = format!("level-{}", index + 1);
            let in_record = self.schedule.hold.judge_record(&steady, session.control().target_lag());
            let mut findings = settling.findings.clone();
            findings.extend(in_record.into_iter().filter(|f| settling.findings.iter().all(|g| g.name() != f.name())));
            let force_harmonics = session.force_harmonics();
            let outcome = LevelOutcome { level, settling, steady, force_harmonics, findings, start, record };
            let told = observe(&outcome);
            outcomes.push(outcome);
            if told.is_break() {
                break;
            }
        }
        Ok(outcomes)
    }
}

use std::ops::ControlFlow;

use nlmodes_experiment::phase_loop::{Drifts, ForceAppropriation, LevelSchedule, TestSettings};
use nlmodes_experiment::records::Record;
use num_complex::Complex64;

use crate::rig::error::positive;
use crate::rig::harmonics::{TONE, appropriation, wait};
use crate::rig::{ControlChannels, ControlledHarmonics, Drive, Finding, RigError, RigSetup, Session};

/// What the control measured over a record, in the mean.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SteadyState {
    /// Angular frequency, rad/s.
    pub omega: f64,
    /// Lag of the response behind the force, rad.
    pub lag: f64,
    /// Amplitude of the fundamental of the force, N.
    pub force: f64,
    /// Amplitude of the fundamental of the response, in its unit.
    pub response: f64,
}

/// One level of a test.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LevelOutcome {
    /// The level: amplitude of the drive, N or V, or of what is controlled.
    pub level: f64,
    /// Time from reaching the level until it was recorded, s.
    pub settling: f64,
    /// How steady it was then.
    pub drifts: Drifts,
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

/// A complete test: a rig and its control.
#[derive(Debug, Clone, PartialEq)]
pub struct VirtualTest {
    /// The rig.
    pub rig: RigSetup,
    /// The control: loop, amplitude, levels, limits. Its harmonics are those below.
    pub control: TestSettings,
    /// What it reads.
    pub channels: ControlChannels,
    /// Harmonics of the force that are controlled beyond the first; without them the loop controls the fundamental
    /// alone, and the exciter determines the others.
    pub harmonics: Option<ControlledHarmonics>,
}

impl VirtualTest {
    /// Whether the test can start: rejects everything that [`run`](Self::run) rejects before its first sample.
    ///
    /// # Errors
    /// Those of [`Session::new`], and [`RigError::DriveTooFast`] at the starting frequency.
    pub fn check(&self) -> Result<(), RigError> {
        let session = self.session_with(self.control.schedule, None)?;
        let mut first = Drive { omega: self.control.phase.start, ..Drive::OFF };
        if let Some(wanted) = &self.harmonics {
            first.amplitudes[0][wanted.harmonics - 1] = Complex64::ONE;
        }
        first.polynomial(0.0, 1.0 / session.rig().substeps() as f64, self.rig.interval).map(drop)
    }

    /// The rig at rest, ready for the levels. Where harmonics are controlled the answer of the force is measured
    /// before.
    ///
    /// # Errors
    /// As [`check`](Self::check); those of the motion; [`RigError::NotPositive`] without a first level to measure at.
    pub fn session(&self) -> Result<Session, RigError> {
        self.check()?;
        self.session_asking(|| ControlFlow::Continue(()))
    }

    fn session_asking(
        &self,
        asked: impl Fn() -> ControlFlow<()> + Send + Sync + Clone + 'static,
    ) -> Result<Session, RigError> {
        let transfer = self.harmonics.as_ref().map(|wanted| self.transfer(wanted, asked.clone())).transpose()?;
        Ok(self.session_with(self.control.schedule, transfer.as_deref())?.asking(asked))
    }

    fn session_with(&self, schedule: LevelSchedule, transfer: Option<&[Complex64]>) -> Result<Session, RigError> {
        let of = |wanted: &ControlledHarmonics| -> Result<ForceAppropriation, RigError> {
            appropriation(&self.rig, &self.control.phase, wanted, transfer)
        };
        let harmonics = self.harmonics.as_ref().map(of).transpose()?;
        let motions = self.harmonics.as_ref().map_or_else(Vec::new, |wanted| wanted.channels.clone());
        let control = TestSettings { schedule, harmonics, ..self.control.clone() };
        Session::new(self.rig.clone(), &control, ControlChannels { motions, ..self.channels.clone() })
    }

    /// How the force answers to the drive in the harmonics 2, 3 …, N or N/V: with tones of a tenth of the first level
    /// and without them, at the frequency of the start.
    fn transfer(
        &self,
        wanted: &ControlledHarmonics,
        asked: impl Fn() -> ControlFlow<()> + Send + Sync + Clone + 'static,
    ) -> Result<Vec<Complex64>, RigError> {
        let level = positive("level", self.control.schedule.levels().next().unwrap_or(0.0))?;
        let ramp = self.control.schedule.ramp;
        let start = self.control.schedule.start + wait(&self.control.phase);
        let schedule = LevelSchedule { ramp, start, ..LevelSchedule::new(&[level])? };
        let force = |tone: f64| -> Result<Vec<Complex64>, RigError> {
            let mut session = self.session_with(schedule, None)?.asking(asked.clone());
            session.state_mut().hold_harmonics(&vec![tone.into(); wanted.harmonics]);
            session.run(ramp + start)?;
            Ok(session.state().harmonics().force().to_vec())
        };
        let (without, with) = (force(0.0)?, force(TONE * level)?);
        Ok(without.iter().zip(&with).skip(1).map(|(a, b)| (b - a) / (TONE * level)).collect())
    }

    /// Runs the schedule. `observe` is called with each level as soon as it is recorded.
    ///
    /// # Errors
    /// Those of [`Session::new`] and of the motion. A level that does not settle is not an error: it is one of its
    /// findings.
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
        asked: impl Fn() -> ControlFlow<()> + Send + Sync + Clone + 'static,
        mut observe: impl FnMut(&LevelOutcome) -> ControlFlow<()>,
    ) -> Result<Vec<LevelOutcome>, RigError> {
        self.check()?;
        let mut session = self.session_asking(asked)?;
        let mut outcomes = Vec::with_capacity(self.control.schedule.count);
        while let Some(outcome) = session.next_level()? {
            let told = observe(&outcome);
            outcomes.push(outcome);
            if told.is_break() {
                break;
            }
        }
        Ok(outcomes)
    }
}

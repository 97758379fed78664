mod levels;
mod motion;
mod newton;

use std::f64::consts::TAU;

use nlmodes_experiment::phase_loop::{LevelSchedule, TestSettings};

use crate::rig::session::EVER;
use crate::rig::{ControlChannels, RigError, RigSetup, Session};

pub use levels::{HeldLevel, LevelsAhead};
pub use motion::LockedMotion;

/// Rig and control as one small periodic system: structure, stop, exciter, detector, controller.
///
/// ```text
/// y = (θ, ∫e, detector, drive if it is controlled; modal coordinates and velocities, exciter)
/// y(t + N h) = P(y(t)) ,   θ → θ + 2π
/// ```
///
/// `P` is what rig and control do in `N` samples without noise, with the code that runs the test: exact from contact
/// instant to contact instant. The sampling interval `h` is that of the test to half a sample in a period, so that the
/// period is a whole number of samples.
#[derive(Debug, Clone)]
pub(crate) struct ClosedLoop {
    rig: RigSetup,
    control: TestSettings,
    channels: ControlChannels,
}

/// The loop at a level, with its sampling interval.
#[derive(Debug, Clone)]
pub(crate) struct Map {
    session: Session,
    samples: usize,
}

impl ClosedLoop {
    pub(crate) fn new(rig: &RigSetup, control: &TestSettings, channels: &ControlChannels) -> Self {
        let mut rig = rig.clone();
        for sensor in &mut rig.sensors {
            (sensor.noise, sensor.chain) = (0.0, sensor.chain.smooth());
        }
        let control = TestSettings { harmonics: None, ..control.clone() };
        Self { rig, control, channels: channels.clone() }
    }

    /// Samples of a period at this angular frequency, rad/s.
    pub(crate) fn samples(&self, omega: f64) -> usize {
        (TAU / (omega * self.rig.interval)).round().max(1.0) as usize
    }

    /// The map of a level over `samples` samples at an angular frequency, rad/s.
    pub(crate) fn map(&self, level: f64, omega: f64, samples: usize, drive: f64) -> Result<Map, RigError> {
        let interval = TAU / (omega * samples as f64);
        let mut session = self.session(level, interval, EVER)?;
        session.begin_at(level, omega, drive);
        Ok(Map { session, samples })
    }

    /// A session at this level alone, with this sampling interval, s.
    pub(crate) fn session(&self, level: f64, interval: f64, record: f64) -> Result<Session, RigError> {
        let mut control = self.control.clone();
        control.phase.step = interval;
        let plan = control.schedule;
        control.schedule =
            LevelSchedule { ramp: plan.ramp, start: plan.start, record, ..LevelSchedule::new(&[level])? };
        let rig = RigSetup { interval, substeps: None, ..self.rig.clone() };
        Session::new(rig, &control, self.channels.clone())
    }
}

impl Map {
    /// `P(y)`, with the phase beyond a turn.
    pub(crate) fn after(&self, y: &[f64]) -> Result<Vec<f64>, RigError> {
        let mut session = self.session.clone();
        session.set_numbers(y);
        (0..self.samples).try_for_each(|_| session.step().map(drop))?;
        let mut numbers = session.numbers();
        numbers[0] = (numbers[0] + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
        Ok(numbers)
    }

    /// Largest size of each channel over the period, in its unit.
    pub(crate) fn peaks(&self, y: &[f64]) -> Result<Vec<f64>, RigError> {
        let mut session = self.session.clone();
        session.set_numbers(y);
        let mut peaks = vec![0.0_f64; session.rig().setup().sensors.len()];
        for _ in 0..self.samples {
            for (channel, peak) in peaks.iter_mut().enumerate() {
                *peak = peak.max(session.rig().exact(channel)?.abs());
            }
            session.step()?;
        }
        Ok(peaks)
    }

    /// What the control measures over the period in the mean: amplitudes of force and response.
    pub(crate) fn amplitudes(&self, y: &[f64]) -> Result<[f64; 2], RigError> {
        let mut session = self.session.clone();
        session.set_numbers(y);
        let mut sum = [0.0; 2];
        for _ in 0..self.samples {
            let output = session.step()?;
            sum = [sum[0] + output.force, sum[1] + output.response];
        }
        Ok(sum.map(|sum| sum / self.samples as f64))
    }
}

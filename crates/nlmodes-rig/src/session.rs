use std::collections::VecDeque;
use std::f64::consts::FRAC_PI_2;
use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;

use nlmodes_experiment::phase_loop::{AppropriationState, LoopSettings, LoopState, PhaseLockedLoop, ResponseQuantity};
use nlmodes_experiment::records::{Channel, Quantity, Record, Role};
use num_complex::Complex64;

use crate::error::{finite, not_negative, positive};
use crate::harmonics::{ControlledHarmonics, HarmonicControl};
use crate::hold::Settling;
use crate::period::{Period, PeriodAnalyzer};
use crate::{Drive, Finding, Hold, RigError, RigSetup, SteadyState, VirtualRig};

/// Name of the channel with the phase of the drive.
pub const DRIVE_PHASE: &str = "drive_phase";

/// A rig in a closed loop: ramp, wait, settle, record, freeze the frequency.
///
/// The loop has access only to two channels of the rig, with their noise.
#[derive(Debug, Clone)]
pub struct Session {
    rig: VirtualRig,
    pll: PhaseLockedLoop,
    state: LoopState,
    force: usize,
    response: usize,
    amplitude: f64,
    harmonics: Option<HarmonicControl>,
    /// The readings of this interval, channel by channel.
    readings: Vec<Option<f64>>,
    asked: Asked,
}

/// Cancellation callback, and the samples since its last call.
#[derive(Clone, Default)]
struct Asked {
    who: Option<Arc<dyn Fn() -> ControlFlow<()> + Send + Sync>>,
    samples: usize,
}

impl Asked {
    /// Samples between calls of the callback: some milliseconds of computation.
    const EVERY: usize = 500;

    fn goes_on(&mut self) -> Result<(), RigError> {
        self.samples += 1;
        match &self.who {
            Some(who) if self.samples.is_multiple_of(Self::EVERY) && who().is_break() => Err(RigError::Interrupted),
            _ => Ok(()),
        }
    }
}

impl fmt::Debug for Asked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.who.is_some() { "Asked(somebody)" } else { "Asked(nobody)" })
    }
}

impl Session {
    /// A rig at rest and a loop before its first sample. `force` and `response` are the channels used by the loop.
    ///
    /// # Errors
    /// Those of [`VirtualRig::new`]; [`RigError::Loop`], among others for unstable gains; [`RigError::NoChannel`];
    /// [`RigError::SamplingIntervals`] and [`RigError::ResponseQuantity`] if rig and loop are incompatible.
    pub fn new(setup: RigSetup, settings: LoopSettings, force: usize, response: usize) -> Result<Self, RigError> {
        let rig = VirtualRig::new(setup)?;
        let pll = PhaseLockedLoop::new(settings)?;
        check_channels(&rig, &pll, force, response)?;
        let state = pll.start();
        let readings = vec![None; rig.setup().sensors.len()];
        let asked = Asked::default();
        Ok(Self { rig, pll, state, force, response, amplitude: 0.0, harmonics: None, readings, asked })
    }

    /// Calls `who` from time to time to ask whether to continue; if not, the current operation ends with
    /// [`RigError::Interrupted`].
    #[must_use]
    pub fn asking(mut self, who: impl Fn() -> ControlFlow<()> + Send + Sync + 'static) -> Self {
        self.asked.who = Some(Arc::new(who));
        self
    }

    /// The rig.
    pub fn rig(&self) -> &VirtualRig {
        &self.rig
    }

    /// The state of the loop.
    pub fn state(&self) -> &LoopState {
        &self.state
    }

    /// The loop.
    pub fn control(&self) -> &PhaseLockedLoop {
        &self.pll
    }

    /// Amplitude of the drive, N or V.
    pub fn amplitude(&self) -> f64 {
        self.amplitude
    }

    /// Freezes the present frequency, or returns it to the loop.
    pub fn hold_frequency(&mut self, held: bool) {
        self.state = self.state.hold_frequency(held);
    }

    /// Freezes the frequency at `omega`, rad/s.
    ///
    /// # Errors
    /// [`RigError::NotPositive`].
    pub fn hold_frequency_at(&mut self, omega: f64) -> Result<(), RigError> {
        self.state = self.state.hold_frequency_at(positive("frequency (rad/s)", omega)?);
        Ok(())
    }

    /// Starts control of the higher harmonics of the force: measures the transfer function from drive to force in each
    /// of them, with a tone of a tenth of the present level, and lets them settle. To be called at a nonzero level,
    /// preferably without contact.
    ///
    /// # Errors
    /// [`RigError::Loop`] for invalid settings of the controller, or a force that does not respond;
    /// [`RigError::NoChannel`] and [`RigError::ResponseQuantity`] for channels that are not motions;
    /// [`RigError::DriveTooFast`]; those of [`Session::ramp`].
    pub fn control_harmonics(&mut self, wanted: &ControlledHarmonics) -> Result<(), RigError> {
        let tone = HarmonicControl::TONE * positive("level", self.amplitude.abs())?;
        let tones = [0.0, tone].map(|tone| (1..=wanted.harmonics).map(move |n| if n > 1 { tone } else { 0.0 }.into()));
        let mut answers = Vec::with_capacity(2);
        for tones in tones {
            let tones: Vec<Complex64> = tones.collect();
            let mut control = HarmonicControl::new(&self.rig, self.pll.settings(), wanted, None)?;
            control.state = control.state.held_at(&tones);
            let wait = control.wait();
            self.harmonics = Some(control);
            self.run(wait)?;
            answers.push(self.harmonics.as_ref().map_or_else(Vec::new, |control| control.state.force().to_vec()));
        }
        let transfer: Vec<Complex64> =
            answers[0].iter().zip(&answers[1]).skip(1).map(|(a, b)| (b - a) / tone).collect();
        let control = HarmonicControl::new(&self.rig, self.pll.settings(), wanted, Some(&transfer))?;
        let wait = control.wait();
        self.harmonics = Some(control);
        self.run(wait)
    }

    /// The controlled harmonics of the force, if any beyond the first.
    pub fn harmonics(&self) -> Option<&AppropriationState> {
        self.harmonics.as_ref().map(|control| &control.state)
    }

    /// Complex amplitudes of the force in the controlled harmonics 1, 2 …, N, with phases relative to the cosine of the
    /// fundamental of the response's displacement; empty if only the first is controlled.
    pub fn force_harmonics(&self) -> Vec<Complex64> {
        let [_, response] = self.state.fundamentals();
        let ahead = FRAC_PI_2 * f64::from(self.pll.settings().quantity.derivatives());
        let angle = response.arg() - ahead;
        let turned = |(index, force): (usize, &Complex64)| force * Complex64::cis(-((index + 1) as f64) * angle);
        self.harmonics().map_or_else(Vec::new, |control| control.force().iter().enumerate().map(turned).collect())
    }

    /// Changes the amplitude of the drive linearly to `amplitude` in `duration` seconds, under control.
    ///
    /// # Errors
    /// Those of [`VirtualRig::advance`], and unsuitable numbers.
    pub fn ramp(&mut self, amplitude: f64, duration: f64) -> Result<(), RigError> {
        let (from, to) = (self.amplitude, finite("level", amplitude)?);
        let samples = self.samples(duration)?.max(1);
        for k in 1..=samples {
            let share = k as f64 / samples as f64;
            self.sample(from + share * (to - from), |_, _| Ok(()))?;
        }
        Ok(())
    }

    /// Continues for `duration` seconds at the present amplitude.
    ///
    /// # Errors
    /// As [`Session::ramp`].
    pub fn run(&mut self, duration: f64) -> Result<(), RigError> {
        self.ramp(self.amplitude, duration)
    }

    /// Holds the level until it is steady, or as long as allowed.
    ///
    /// # Errors
    /// As [`Session::ramp`].
    pub fn settle(&mut self, hold: &Hold) -> Result<Settling, RigError> {
        hold.check()?;
        let start = self.rig.time();
        let mut windows: VecDeque<SteadyState> = VecDeque::with_capacity(hold.windows + 1);
        loop {
            let before = self.rig.time();
            windows.push_back(self.window(hold.periods)?);
            let off = self.harmonics.as_mut().map(HarmonicControl::take_off);
            if windows.len() > hold.windows {
                windows.pop_front();
            }
            let (now, last) = (self.rig.time(), windows.make_contiguous());
            let out_of_time = now - start >= hold.longest;
            if last.len() < 2 || (last.len() < hold.windows && !out_of_time) {
                continue;
            }
            let mut findings = hold.judge(last, self.pll.target_lag(), now - before);
            if let (Some(off), Some(control)) = (off, self.harmonics()) {
                findings.extend(hold.judge_harmonics(&off, control));
            }
            if self.state.is_at_limit() {
                findings.push(Finding::FrequencyLimit { omega: self.state.omega() });
            }
            if findings.is_empty() || out_of_time {
                return Ok(Settling { duration: now - start, steady: SteadyState::mean(last), findings });
            }
        }
    }

    /// Means over the next `periods` periods.
    ///
    /// # Errors
    /// As [`Session::ramp`].
    pub fn window(&mut self, periods: usize) -> Result<SteadyState, RigError> {
        let mut window = Window::new(periods, self.angle());
        while !window.is_complete() {
            let (force, response) = (self.force, self.response);
            self.sample(self.amplitude, |readings, state| {
                window.push(state, readings(force)?, readings(response)?);
                Ok(())
            })?;
        }
        Ok(window.steady_state(self.pll.target_lag()))
    }

    /// Records all channels for `duration` seconds, and the means over the whole periods of that time (at least one).
    /// The last channel is the phase of the drive, [`DRIVE_PHASE`], rad in [0, 2π).
    ///
    /// # Errors
    /// As [`Session::ramp`].
    pub fn record(&mut self, duration: f64) -> Result<(Record, SteadyState), RigError> {
        self.record_ramp(self.amplitude, duration)
    }

    /// The same while the amplitude of the drive changes linearly to `amplitude`: as a recorder that runs through a
    /// whole test.
    ///
    /// # Errors
    /// As [`Session::ramp`].
    pub fn record_ramp(&mut self, amplitude: f64, duration: f64) -> Result<(Record, SteadyState), RigError> {
        let (from, to) = (self.amplitude, finite("level", amplitude)?);
        let samples = self.samples(duration)?;
        let at = |taken: usize| from + ((taken + 1) as f64 / samples.max(1) as f64).min(1.0) * (to - from);
        let mut record = self.empty_record(samples)?;
        let mut window = Window::new(usize::MAX, self.angle());
        let (force, response) = (self.force, self.response);
        let sensors = record.channels.len() - 1;
        let mut taken = 0;
        while taken < samples || window.periods.is_empty() {
            self.sample(at(taken), |readings, state| {
                let mut values = [0.0; 2];
                for (index, samples_of) in record.samples[..sensors].iter_mut().enumerate() {
                    let value = readings(index)?;
                    if index == force {
                        values[0] = value;
                    }
                    if index == response {
                        values[1] = value;
                    }
                    if taken < samples {
                        samples_of.push(value);
                    }
                }
                if taken < samples {
                    record.samples[sensors].push(state.drive_phase());
                }
                window.push(state, values[0], values[1]);
                Ok(())
            })?;
            taken += 1;
        }
        Ok((record, window.steady_state(self.pll.target_lag())))
    }

    /// Angle of the drive in a sampling interval, rad.
    fn angle(&self) -> f64 {
        self.state.omega() * self.rig.setup().interval
    }

    fn empty_record(&self, samples: usize) -> Result<Record, RigError> {
        let mut record = Record::new("", 1.0 / self.rig.setup().interval);
        for index in 0..self.rig.setup().sensors.len() {
            record = record.with(self.rig.channel(index)?, Vec::with_capacity(samples));
        }
        let phase = Channel::new(DRIVE_PHASE, Quantity::Phase, Role::ExcitationPhase, None);
        Ok(record.with(phase, Vec::with_capacity(samples)))
    }

    fn samples(&self, duration: f64) -> Result<usize, RigError> {
        Ok((not_negative("duration (s)", duration)? / self.rig.setup().interval).round() as usize)
    }

    /// One sample: read, pass the readings to `see` (each channel is read once), step the loop, advance.
    fn sample(
        &mut self,
        amplitude: f64,
        see: impl FnOnce(&mut dyn FnMut(usize) -> Result<f64, RigError>, &LoopState) -> Result<(), RigError>,
    ) -> Result<(), RigError> {
        self.asked.goes_on()?;
        self.readings.fill(None);
        let (rig, readings) = (&mut self.rig, &mut self.readings);
        let mut read = |channel: usize| match readings.get(channel) {
            Some(&Some(value)) => Ok(value),
            _ => {
                let value = rig.read(channel)?;
                readings[channel] = Some(value);
                Ok(value)
            }
        };
        let (force, response) = (read(self.force)?, read(self.response)?);
        let mut drive = Drive::sine([self.amplitude, amplitude], self.state.drive_phase(), self.state.omega());
        if let Some(control) = &mut self.harmonics {
            control.step(&mut drive, force, &mut read)?;
        }
        see(&mut read, &self.state)?;
        self.state = self.pll.step(&self.state, force, response);
        drive.omega = self.state.omega();
        self.amplitude = amplitude;
        self.rig.advance(&drive)
    }
}

fn check_channels(rig: &VirtualRig, pll: &PhaseLockedLoop, force: usize, response: usize) -> Result<(), RigError> {
    rig.channel(force)?;
    let (of_loop, of_rig) = (pll.settings().step, rig.setup().interval);
    if (of_loop / of_rig - 1.0).abs() > 1e-9 {
        return Err(RigError::SamplingIntervals { of_loop, of_rig });
    }
    let expected = match pll.settings().quantity {
        ResponseQuantity::Displacement => Quantity::Displacement,
        ResponseQuantity::Velocity => Quantity::Velocity,
        ResponseQuantity::Acceleration => Quantity::Acceleration,
    };
    let found = rig.channel(response)?.quantity;
    if found == expected {
        return Ok(());
    }
    let sensor = rig.setup().sensors[response].name.clone();
    Err(RigError::ResponseQuantity { sensor, expected: expected.si_unit(), found: found.si_unit() })
}

/// Whole periods, and the mean frequency over them.
struct Window {
    wanted: usize,
    analyzer: PeriodAnalyzer,
    periods: Vec<Period>,
    omega: f64,
    samples: usize,
}

impl Window {
    fn new(wanted: usize, angle: f64) -> Self {
        Self { wanted, analyzer: PeriodAnalyzer::new(angle), periods: Vec::new(), omega: 0.0, samples: 0 }
    }

    fn is_complete(&self) -> bool {
        self.periods.len() >= self.wanted
    }

    fn push(&mut self, state: &LoopState, force: f64, response: f64) {
        self.periods.extend(self.analyzer.push(state.drive_phase(), force, response));
        self.omega += state.omega();
        self.samples += 1;
    }

    /// The lag is given on the branch nearest to the target.
    fn steady_state(&self, target: f64) -> SteadyState {
        let mean = Period::mean(&self.periods);
        let (force, response) = (mean.force[0], mean.response[0]);
        let turned = (force * response.conj() * num_complex::Complex64::cis(-target)).arg();
        SteadyState {
            omega: self.omega / self.samples as f64,
            lag: target + turned,
            force: force.norm(),
            response: response.norm(),
            spread: Period::spread(&self.periods),
        }
    }
}

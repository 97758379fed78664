use std::f64::consts::FRAC_PI_2;
use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;

use nlmodes_experiment::phase_loop::{
    LevelSchedule, MAX_SENSORS, ResponseQuantity, Stage, SteadyCriteria, TestControl, TestInput, TestOutput,
    TestSettings, TestState,
};
use nlmodes_experiment::records::{Channel, Quantity, Record, Role};
use num_complex::Complex64;

use crate::rig::error::not_negative;
use crate::rig::{Drive, Finding, LevelOutcome, RigError, RigSetup, SteadyState, VirtualRig};

/// Name of the channel with the phase of the drive.
pub const DRIVE_PHASE: &str = "drive_phase";

/// Longer than any test, s.
pub(crate) const EVER: f64 = 1e9;

/// The channels that the control of a test reads.
#[derive(Debug, Clone, PartialEq)]
pub struct ControlChannels {
    /// The excitation force.
    pub force: usize,
    /// The response.
    pub response: usize,
    /// A displacement for the limit of the stroke.
    pub stroke: Option<usize>,
    /// The contact force for its limit.
    pub contact_force: Option<usize>,
    /// Motions for the control of harmonics.
    pub motions: Vec<usize>,
}

impl ControlChannels {
    /// Force and response, and nothing else.
    pub fn new(force: usize, response: usize) -> Self {
        Self { force, response, stroke: None, contact_force: None, motions: Vec::new() }
    }
}

/// A rig under the control of a test, [`TestControl`], as at a real one: each sample the control is given the readings
/// of some channels, with their noise, and drives the rig until the next.
#[derive(Debug, Clone)]
pub struct Session {
    rig: VirtualRig,
    control: TestControl,
    quantity: ResponseQuantity,
    settling: SteadyCriteria,
    /// Whether an operator has left the levels of the schedule.
    by_hand: bool,
    state: TestState,
    channels: ControlChannels,
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
    /// A rig at rest and a control before its first sample.
    ///
    /// # Errors
    /// Those of [`VirtualRig::new`]; [`RigError::Loop`] for settings that cannot work; [`RigError::NoChannel`];
    /// [`RigError::SamplingIntervals`], [`RigError::ResponseQuantity`] and [`RigError::LimitWithoutChannel`] if rig and
    /// control are incompatible.
    pub fn new(setup: RigSetup, settings: &TestSettings, channels: ControlChannels) -> Result<Self, RigError> {
        let rig = VirtualRig::new(setup)?;
        let control = TestControl::new(settings)?;
        check_channels(&rig, settings, &channels)?;
        let readings = vec![None; rig.setup().sensors.len()];
        let (state, settling) = (control.start(), settings.schedule.settling);
        let (quantity, asked) = (settings.phase.quantity, Asked::default());
        Ok(Self { rig, control, quantity, settling, by_hand: false, state, channels, readings, asked })
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

    /// The state of the control.
    pub fn state(&self) -> &TestState {
        &self.state
    }

    /// The state of the control, for what an operator may do to it.
    pub fn state_mut(&mut self) -> &mut TestState {
        &mut self.state
    }

    /// Complex amplitudes of the force in the controlled harmonics 1, 2 …, N, with phases relative to the cosine of the
    /// fundamental of the response's displacement; empty if only the first is controlled.
    pub fn force_harmonics(&self) -> Vec<Complex64> {
        let [_, response] = self.state.phase().fundamentals();
        let angle = response.arg() - FRAC_PI_2 * f64::from(self.quantity.derivatives());
        let turned = |(index, force): (usize, &Complex64)| force * Complex64::cis(-((index + 1) as f64) * angle);
        self.state.harmonics().force().iter().enumerate().map(turned).collect()
    }

    /// One sample.
    ///
    /// # Errors
    /// Those of [`VirtualRig::advance`]; [`RigError::Interrupted`].
    pub fn step(&mut self) -> Result<TestOutput, RigError> {
        self.sample(None)
    }

    /// Continues for `duration` seconds.
    ///
    /// # Errors
    /// As [`Session::step`].
    pub fn run(&mut self, duration: f64) -> Result<(), RigError> {
        (0..self.samples(duration)?).try_for_each(|_| self.step().map(drop))
    }

    /// Goes to `level` in `ramp` seconds, and stays there: what an operator wants instead of the schedule.
    ///
    /// # Errors
    /// [`RigError::Loop`] for a level that cannot be; those of [`Session::step`].
    pub fn go(&mut self, level: f64, ramp: f64) -> Result<(), RigError> {
        self.begin(level, ramp, &SteadyCriteria { longest: EVER, ..self.settling })?;
        self.run(ramp)
    }

    /// Holds the present level until it is steady, or as long as these criteria allow; what it was then, and why it was
    /// not steady.
    ///
    /// # Errors
    /// As [`Session::go`].
    pub fn settle(&mut self, settling: &SteadyCriteria) -> Result<(TestOutput, Vec<Finding>), RigError> {
        self.begin(self.state.level(), 0.0, settling)?;
        loop {
            let output = self.step()?;
            if !matches!(output.stage, Stage::Ramp | Stage::Settle) {
                return Ok((output, Finding::of_hold(&output, settling, &self.state)));
            }
        }
    }

    /// A schedule of this level alone.
    fn begin(&mut self, level: f64, ramp: f64, settling: &SteadyCriteria) -> Result<(), RigError> {
        let only = LevelSchedule::new(&[level])?;
        let only = LevelSchedule { ramp, start: 0.0, settling: *settling, record: EVER, ..only };
        self.control = self.control.with_schedule(only)?;
        self.state.begin_levels();
        self.by_hand = true;
        Ok(())
    }

    /// Goes on to the end of the record of the next level of the schedule; none after the last one, or after
    /// [`Session::go`].
    ///
    /// # Errors
    /// As [`Session::step`]; [`RigError::Stopped`] after an emergency stop.
    pub fn next_level(&mut self) -> Result<Option<LevelOutcome>, RigError> {
        let mut record = self.empty_record(0)?;
        let mut means = Means::default();
        let (mut settling_from, mut held) = (None, None);
        loop {
            match self.state.stage() {
                _ if self.by_hand => return Ok(None),
                Stage::Down | Stage::Finished => return Ok(None),
                Stage::Stopping | Stage::Stopped => {
                    return Err(RigError::Stopped { reason: self.state.stop_reason(), time: self.rig.time() });
                }
                _ => {}
            }
            let now = self.rig.time();
            let output = self.sample(Some((&mut record, false)))?;
            if output.stage == Stage::Settle {
                settling_from.get_or_insert(now);
            }
            if output.recorded {
                held.get_or_insert((output, now));
                means.push(&output);
            } else if let Some((held, start)) = held {
                let (steady, number) = (means.steady_state(), held.level_index + 1);
                record.name = format!("level-{number}");
                let mut findings = Finding::of_hold(&held, &self.settling, &self.state);
                findings.extend(Finding::of_record(&held, &self.settling, steady.lag - self.control.target_lag()));
                return Ok(Some(LevelOutcome {
                    level: held.level,
                    settling: start - settling_from.unwrap_or(start),
                    drifts: held.drifts,
                    steady,
                    force_harmonics: self.force_harmonics(),
                    findings,
                    start,
                    record,
                }));
            }
        }
    }

    /// A level that is reached, at phase zero and this angular frequency, with this drive if it is controlled.
    pub(crate) fn begin_at(&mut self, level: f64, omega: f64, drive: f64) {
        self.state = self.control.at_level(level, omega, drive);
    }

    /// Everything on which the further course depends: the numbers of the control, phase first, and those of the rig.
    pub(crate) fn numbers(&self) -> Vec<f64> {
        let (mut state, mut all) = (self.state, Vec::new());
        self.control.each_number(&mut state, &mut |number| all.push(*number));
        all.extend(self.rig.states());
        all
    }

    /// Continues from these numbers.
    pub(crate) fn set_numbers(&mut self, numbers: &[f64]) {
        let mut rest = numbers.iter();
        self.control.each_number(&mut self.state, &mut |number| *number = rest.next().copied().unwrap_or(0.0));
        let (omega, [amplitude, ..]) = (self.state.phase().omega(), self.state.amplitudes());
        let phase = self.state.phase().drive_phase() - omega * self.rig.setup().interval;
        self.rig.set_states(rest.as_slice(), &Drive::sine([amplitude.re; 2], phase, omega));
    }

    /// Records all channels for `duration` seconds (at least one sample), and the means over that time. The last
    /// channel is the phase of the drive, [`DRIVE_PHASE`], rad in [0, 2π).
    ///
    /// # Errors
    /// As [`Session::step`].
    pub fn record(&mut self, duration: f64) -> Result<(Record, SteadyState), RigError> {
        let samples = self.samples(duration)?.max(1);
        let (mut record, mut means) = (self.empty_record(samples)?, Means::default());
        for _ in 0..samples {
            means.push(&self.sample(Some((&mut record, true)))?);
        }
        Ok((record, means.steady_state()))
    }

    /// The same while the level changes to `level`: as a recorder that runs through a whole test.
    ///
    /// # Errors
    /// As [`Session::go`].
    pub fn record_ramp(&mut self, level: f64, duration: f64) -> Result<(Record, SteadyState), RigError> {
        self.begin(level, duration, &SteadyCriteria { longest: EVER, ..self.settling })?;
        self.record(duration)
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

    /// One sample: read, step the control, record if it says so or in any case, advance.
    fn sample(&mut self, record: Option<(&mut Record, bool)>) -> Result<TestOutput, RigError> {
        self.asked.goes_on()?;
        self.readings.fill(None);
        let input = self.input()?;
        let output = self.control.step(&mut self.state, &input);
        if let Some((record, always)) = record
            && (always || output.recorded)
        {
            let sensors = self.readings.len();
            for (channel, samples) in record.samples.iter_mut().enumerate() {
                samples.push(if channel < sensors { self.read(channel)? } else { output.phase });
            }
        }
        self.rig.advance(&Drive { amplitudes: output.amplitudes, phase: output.phase, omega: output.omega })?;
        Ok(output)
    }

    /// What the control is given.
    fn input(&mut self) -> Result<TestInput, RigError> {
        let mut input = TestInput::new(self.read(self.channels.force)?, self.read(self.channels.response)?);
        if let Some(channel) = self.channels.stroke {
            input.stroke = self.read(channel)?;
        }
        if let Some(channel) = self.channels.contact_force {
            input.contact_force = self.read(channel)?;
        }
        for (at, motion) in input.motions.iter_mut().enumerate().take(self.channels.motions.len()) {
            *motion = self.read(self.channels.motions[at])?;
        }
        Ok(input)
    }

    /// The reading of a channel; each is read once a sample.
    fn read(&mut self, channel: usize) -> Result<f64, RigError> {
        if let Some(&Some(value)) = self.readings.get(channel) {
            return Ok(value);
        }
        let value = self.rig.read(channel)?;
        self.readings[channel] = Some(value);
        Ok(value)
    }
}

fn check_channels(rig: &VirtualRig, settings: &TestSettings, channels: &ControlChannels) -> Result<(), RigError> {
    let optional = [channels.stroke, channels.contact_force];
    for channel in [channels.force].into_iter().chain(optional.into_iter().flatten()) {
        rig.channel(channel)?;
    }
    let limits = [("stroke", settings.limits.stroke), ("contact force", settings.limits.contact_force)];
    for ((what, limit), channel) in limits.into_iter().zip(optional) {
        if limit.is_finite() && channel.is_none() {
            return Err(RigError::LimitWithoutChannel { what });
        }
    }
    let (of_loop, of_rig) = (settings.phase.step, rig.setup().interval);
    if (of_loop / of_rig - 1.0).abs() > 1e-9 {
        return Err(RigError::SamplingIntervals { of_loop, of_rig });
    }
    for channel in channels.motions.iter().take(MAX_SENSORS) {
        rig.channel(*channel)?;
    }
    let expected = match settings.phase.quantity {
        ResponseQuantity::Displacement => Quantity::Displacement,
        ResponseQuantity::Velocity => Quantity::Velocity,
        ResponseQuantity::Acceleration => Quantity::Acceleration,
    };
    let found = rig.channel(channels.response)?.quantity;
    if found == expected {
        return Ok(());
    }
    let sensor = rig.setup().sensors[channels.response].name.clone();
    Err(RigError::ResponseQuantity { sensor, expected: expected.si_unit(), found: found.si_unit() })
}

/// Sums of what the control has measured.
#[derive(Debug, Default)]
struct Means {
    /// Angular frequency, lag, amplitudes of force and response.
    sum: [f64; 4],
    samples: usize,
}

impl Means {
    fn push(&mut self, output: &TestOutput) {
        let values = [output.omega, output.lag, output.force, output.response];
        self.sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        self.samples += 1;
    }

    fn steady_state(&self) -> SteadyState {
        let [omega, lag, force, response] = self.sum.map(|sum| sum / self.samples as f64);
        SteadyState { omega, lag, force, response }
    }
}

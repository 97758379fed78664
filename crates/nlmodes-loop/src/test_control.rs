use num_complex::Complex64;

use crate::appropriation::AppropriationState;
use crate::harmonics::powers;
use crate::limits::fade;
use crate::math::{between, cis, norm};
use crate::pll::PreparedLoop;
use crate::schedule::{ScheduleState, samples};
use crate::steady::{Means, Sample};
use crate::{
    AmplitudeSettings, Controlled, Drifts, EmergencyReason, ForceAppropriation, LevelSchedule, Limits, LoopSettings,
    LoopState, MAX_HARMONICS, MAX_SENSORS, PhaseLoopError, Stage,
};

/// Everything that the control of a test has to know.
#[derive(Debug, Clone, PartialEq)]
pub struct TestSettings {
    /// The phase-locked loop.
    pub phase: LoopSettings,
    /// What the levels are, and how they are reached.
    pub amplitude: AmplitudeSettings,
    /// The levels.
    pub schedule: LevelSchedule,
    /// What must not be exceeded.
    pub limits: Limits,
    /// Control of the higher harmonics of the force, if there is any.
    pub harmonics: Option<ForceAppropriation>,
}

impl TestSettings {
    /// These levels of the drive, without limits, with the fundamental of the force alone under control.
    pub fn new(phase: LoopSettings, schedule: LevelSchedule) -> Self {
        Self { phase, amplitude: AmplitudeSettings::drive(), schedule, limits: Limits::default(), harmonics: None }
    }
}

/// A test under control: phase, amplitude, higher harmonics, levels and limits, with checked settings.
///
/// Within a sampling interval the drive is `Re Σ U_n e^{inθ}` with amplitudes that change linearly. For a converter
/// that holds its value, [`TestOutput::drive`] is that of the next sample.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TestControl {
    pub(crate) phase: PreparedLoop,
    pub(crate) amplitude: AmplitudeSettings,
    schedule: LevelSchedule,
    limits: Limits,
    harmonics: ForceAppropriation,
    controls_harmonics: bool,
}

/// The samples of an instant.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TestInput {
    /// Force of the exciter, N.
    pub force: f64,
    /// Response of the loop, in its unit.
    pub response: f64,
    /// Displacement for the limit of the stroke, m; without that limit of no account.
    pub stroke: f64,
    /// Contact force for its limit, N; without that limit of no account.
    pub contact_force: f64,
    /// Motions for the control of harmonics, one a sensor; without it of no account.
    pub motions: [f64; MAX_SENSORS],
    /// Other than zero if the operator wants the test to end.
    pub stop: u32,
}

impl TestInput {
    /// Force and response, and nothing else.
    pub fn new(force: f64, response: f64) -> Self {
        Self { force, response, stroke: 0.0, contact_force: 0.0, motions: [0.0; MAX_SENSORS], stop: 0 }
    }
}

/// What to drive with until the next sample, and how the test goes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TestOutput {
    /// Drive at the next sample, N or V: to be given out when that is read.
    pub drive: f64,
    /// Complex amplitudes `U_n` of the harmonics 1, 2 … at this sample and at the next, N or V.
    pub amplitudes: [[Complex64; MAX_HARMONICS]; 2],
    /// Phase `θ` of this sample, rad.
    pub phase: f64,
    /// Angular frequency until the next, rad/s.
    pub omega: f64,
    /// Measured lag of the response behind the force, rad.
    pub lag: f64,
    /// Amplitude of the fundamental of the force, N.
    pub force: f64,
    /// Amplitude of the fundamental of the response, in its unit.
    pub response: f64,
    /// Level that is wanted at the next sample.
    pub level: f64,
    /// Its index in the schedule, from zero; the number of levels after the last.
    pub level_index: usize,
    /// What the test does.
    pub stage: Stage,
    /// Why it was ended.
    pub stop_reason: EmergencyReason,
    /// How steady the level is.
    pub drifts: Drifts,
    /// Whether the lag has been within its tolerance for the required time.
    pub locked: bool,
    /// Whether this sample belongs to the record of a level.
    pub recorded: bool,
    /// Whether the level that is recorded had settled.
    pub settled: bool,
    /// Whether the frequency is at an end of its range.
    pub frequency_at_limit: bool,
    /// Whether the drive would have to be larger than its limit.
    pub drive_at_limit: bool,
}

/// What a test remembers from one sample to the next.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TestState {
    pub(crate) phase: LoopState,
    harmonics: AppropriationState,
    pub(crate) schedule: ScheduleState,
    /// Amplitudes of the drive at the last sample.
    pub(crate) amplitudes: [Complex64; MAX_HARMONICS],
    /// Amplitudes when an emergency began.
    stopped_from: [Complex64; MAX_HARMONICS],
    stop_reason: EmergencyReason,
    /// Time without finite samples, s.
    silent: f64,
    /// Phase of the sample before, for the beginnings of periods.
    phase_before: f64,
    drive_at_limit: bool,
    /// Error of a controlled amplitude at the last sample.
    pub(crate) amplitude_error: f64,
}

impl TestControl {
    /// A test with these settings.
    ///
    /// # Errors
    /// [`PhaseLoopError`] for settings that cannot work.
    pub fn new(settings: &TestSettings) -> Result<Self, PhaseLoopError> {
        settings.amplitude.check()?;
        settings.limits.check()?;
        let control = Self {
            phase: PreparedLoop::new(&settings.phase)?,
            amplitude: settings.amplitude,
            schedule: settings.schedule,
            limits: settings.limits,
            harmonics: settings.harmonics.unwrap_or(ForceAppropriation::NONE),
            controls_harmonics: settings.harmonics.is_some(),
        };
        control.with_schedule(settings.schedule)
    }

    /// The same with other levels. A state goes on with them from its present level, and with its loop as it is, after
    /// [`TestState::begin_levels`].
    ///
    /// # Errors
    /// [`PhaseLoopError`] for levels that cannot be.
    pub fn with_schedule(&self, schedule: LevelSchedule) -> Result<Self, PhaseLoopError> {
        schedule.check()?;
        let limit = self.limits.drive;
        let too_high = |level: &f64| self.amplitude.controlled == Controlled::Drive && *level > limit;
        schedule.levels().find(too_high).map_or(Ok(()), |level| Err(PhaseLoopError::AboveLimit { level, limit }))?;
        Ok(Self { schedule, ..*self })
    }

    /// Lag of the measured response that the loop works for, rad.
    pub fn target_lag(&self) -> f64 {
        self.phase.target
    }

    /// Sampling interval, s.
    pub fn sampling_interval(&self) -> f64 {
        self.phase.step
    }

    /// State before the first sample: no drive, phase zero.
    pub fn start(&self) -> TestState {
        TestState {
            phase: self.phase.start().hold_frequency(true),
            harmonics: self.harmonics.start(),
            schedule: ScheduleState::START,
            amplitudes: [Complex64::ZERO; MAX_HARMONICS],
            stopped_from: [Complex64::ZERO; MAX_HARMONICS],
            stop_reason: EmergencyReason::None,
            silent: 0.0,
            phase_before: 0.0,
            drive_at_limit: false,
            amplitude_error: 1.0,
        }
    }

    /// Moves on by the samples of an instant.
    pub fn step(&self, state: &mut TestState, input: &TestInput) -> TestOutput {
        let (before, theta) = (state.amplitudes, state.phase.theta);
        self.watch(state, input);
        state.phase = state.phase.hold_frequency(state.schedule.freezes(&self.schedule));
        let omega = state.phase.omega;
        state.phase = self.phase.step(&state.phase, input.force, input.response);
        if state.stop_reason == EmergencyReason::None {
            self.follow(state, input, theta);
            self.drive(state, input, theta, omega);
        } else {
            self.stop(state);
        }
        state.phase_before = theta;
        self.output(state, before, theta)
    }

    /// Limits, and time without samples. The first excess is the reason; a test that was ended remains so.
    fn watch(&self, state: &mut TestState, input: &TestInput) {
        let read = input.force.is_finite()
            && input.response.is_finite()
            && self.limits.are_read(input.stroke, input.contact_force);
        state.silent = if read { 0.0 } else { state.silent + self.phase.step };
        if state.stop_reason != EmergencyReason::None {
            return;
        }
        let excess = self.limits.judge(input.stroke, input.contact_force, input.force, state.silent);
        state.stop_reason = if input.stop != 0 { EmergencyReason::Operator } else { excess };
        if state.stop_reason != EmergencyReason::None {
            state.stopped_from = state.amplitudes;
            state.schedule.begin(Stage::Stopping);
        }
    }

    /// The schedule, with what the loop has measured.
    fn follow(&self, state: &mut TestState, input: &TestInput, theta: f64) {
        let measured = state.phase.fundamentals().map(norm);
        let [_, response] = measured;
        let means = state.phase.error().map(|error| Means {
            lag_error: -error,
            omega: state.phase.omega,
            response,
            deviation: self.amplitude.deviation(state.schedule.wanted, measured),
            ..Means::ZERO
        });
        let missing = state.harmonics.missing();
        let sample = Sample { theta, signals: [input.force, input.response], means, missing };
        let impeded = state.phase.at_limit || state.drive_at_limit || state.harmonics.has_limit();
        state.schedule.step(&self.schedule, &sample, theta < state.phase_before, impeded, self.phase.step);
    }

    /// Amplitudes of the drive at the next sample.
    fn drive(&self, state: &mut TestState, input: &TestInput, theta: f64, omega: f64) {
        let mut room = self.limits.drive;
        if self.controls_harmonics && state.schedule.stage != Stage::Finished {
            self.harmonics.step(&mut state.harmonics, theta, omega, input.force, &input.motions);
            let harmonics = state.harmonics.drive().iter();
            state.amplitudes.iter_mut().zip(harmonics).skip(1).for_each(|(mine, wanted)| *mine = *wanted);
            room -= state.amplitudes.iter().skip(1).map(|u| norm(*u)).sum::<f64>();
        } else if self.controls_harmonics {
            state.amplitudes.iter_mut().skip(1).for_each(|mine| *mine = Complex64::ZERO);
        }
        let [fundamental, ..] = &mut state.amplitudes;
        let measured = state.phase.fundamentals().map(norm);
        let (before, step) = (&mut state.amplitude_error, self.phase.step);
        let wanted = self.amplitude.step(fundamental.re, state.schedule.wanted, measured, before, step);
        *fundamental = between(wanted, 0.0, room.max(0.0)).into();
        state.drive_at_limit = fundamental.re < wanted;
    }

    /// Everything goes to zero together.
    fn stop(&self, state: &mut TestState) {
        state.schedule.samples = state.schedule.samples.saturating_add(1);
        let all = samples(self.limits.stop_duration, self.phase.step).max(1);
        let share = fade(state.schedule.samples as f64 / all as f64);
        state.amplitudes.iter_mut().zip(&state.stopped_from).for_each(|(mine, from)| *mine = from * share);
        if state.schedule.samples >= all {
            state.schedule.stage = Stage::Stopped;
        }
        state.schedule.wanted = 0.0;
    }

    fn output(&self, state: &TestState, before: [Complex64; MAX_HARMONICS], theta: f64) -> TestOutput {
        let [force, response] = state.phase.fundamentals().map(norm);
        let waves = powers(cis(state.phase.theta));
        let drive = state.amplitudes.iter().zip(&waves).map(|(u, wave)| u.re * wave.re - u.im * wave.im).sum();
        TestOutput {
            drive,
            amplitudes: [before, state.amplitudes],
            phase: theta,
            omega: state.phase.omega,
            lag: state.phase.lag,
            force,
            response,
            level: state.schedule.wanted,
            level_index: state.schedule.level,
            stage: state.schedule.stage,
            stop_reason: state.stop_reason,
            drifts: state.schedule.drifts,
            locked: state.phase.locked,
            recorded: state.schedule.stage == Stage::Record,
            settled: state.schedule.settled,
            frequency_at_limit: state.phase.at_limit,
            drive_at_limit: state.drive_at_limit,
        }
    }
}

impl TestState {
    /// The loop.
    pub fn phase(&self) -> &LoopState {
        &self.phase
    }

    /// Complex amplitudes of the drive in the harmonics 1, 2 … at the next sample, N or V.
    pub fn amplitudes(&self) -> &[Complex64; MAX_HARMONICS] {
        &self.amplitudes
    }

    /// Level that is wanted at the next sample.
    pub fn level(&self) -> f64 {
        self.schedule.wanted
    }

    /// What the test does.
    pub fn stage(&self) -> Stage {
        self.schedule.stage
    }

    /// Why it was ended.
    pub fn stop_reason(&self) -> EmergencyReason {
        self.stop_reason
    }

    /// The control of the higher harmonics of the force.
    pub fn harmonics(&self) -> &AppropriationState {
        &self.harmonics
    }

    /// Fixes the drive in the harmonics 1, 2 … at these amplitudes, the first of which is of no account: a tone with
    /// which the answer of the force is measured.
    pub fn hold_harmonics(&mut self, drive: &[Complex64]) {
        self.harmonics = self.harmonics.held_at(drive);
    }

    /// Begins the levels of a control anew, from the present level; a test that was ended remains so.
    pub fn begin_levels(&mut self) {
        if self.stop_reason == EmergencyReason::None {
            self.schedule = self.schedule.again();
        }
    }
}

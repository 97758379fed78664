use num_complex::Complex64;

use crate::{
    AmplitudeSettings, AppropriationSettings, Controlled, ForceAppropriation, Gains, LevelSchedule, Limits,
    LockSettings, LoopSettings, MAX_HARMONICS, MAX_LEVELS, MAX_MODES, MAX_SENSORS, ModalFilter, Order, PhaseDetector,
    PhaseLoopError, Resonance, ResponseQuantity, SteadyCriteria, TestSettings,
};

/// The settings of a test for C: plain numbers, of which any is checked before it is used.
///
/// `nlmodes_loop_default_settings` fills in all of them; set the levels and whatever else differs.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CSettings {
    /// Sampling interval, s.
    pub step_s: f64,
    /// Rough angular eigenfrequency, for the gains and their limit, rad/s.
    pub resonance_rad_s: f64,
    /// Rough damping ratio.
    pub damping_ratio: f64,
    /// Angular frequency at the start, rad/s.
    pub start_rad_s: f64,
    /// Lowest angular frequency, rad/s.
    pub lowest_rad_s: f64,
    /// Highest angular frequency, rad/s.
    pub highest_rad_s: f64,
    /// What the response sensor measures: 0 displacement, 1 velocity, 2 acceleration.
    pub quantity: u32,
    /// 0: adaptive detector; 1, 2: demodulation with a low-pass of first, second order.
    pub detector: u32,
    /// Harmonics of the adaptive detector, 1 to 8.
    pub detector_harmonics: u32,
    /// What the levels are amplitudes of: 0 drive, 1 force, 2 response.
    pub controlled: u32,
    /// Lag of the displacement behind the force to work for, rad.
    pub lag_rad: f64,
    /// Cut-off of the detector, rad/s.
    pub cut_off_rad_s: f64,
    /// Proportional gain, 1/s; with both gains zero they are designed.
    pub proportional_1_s: f64,
    /// Integral gain, 1/s².
    pub integral_1_s2: f64,
    /// Amplitude of the force below which it has no phase, N.
    pub smallest_force_n: f64,
    /// Amplitude of the response below which it has no phase, in its unit.
    pub smallest_response: f64,
    /// Largest lag error of the lock, rad.
    pub lock_tolerance_rad: f64,
    /// Time for which it has to stay below, s.
    pub lock_duration_s: f64,
    /// Rate of the control of an amplitude, 1/s.
    pub amplitude_rate_1_s: f64,
    /// Proportional gain of the control of an amplitude: of a response the rate over the decay rate, of a force zero.
    pub amplitude_gain: f64,
    /// Drive from which a controlled amplitude grows, N or V.
    pub smallest_drive: f64,
    /// Levels, in the unit of what they are amplitudes of.
    pub levels: [f64; MAX_LEVELS],
    /// How many of them there are.
    pub level_count: u32,
    /// Periods a window of the judgement whether a level is steady.
    pub window_periods: u32,
    /// Number of windows, 3 to 16.
    pub windows: u32,
    /// Harmonics of the force that are controlled; 1: the fundamental alone.
    pub controlled_harmonics: u32,
    /// Time from level to level, s.
    pub ramp_s: f64,
    /// Time at the first level with frozen frequency, s.
    pub start_s: f64,
    /// Length of a record, s.
    pub record_s: f64,
    /// Largest deviation of the mean lag, rad.
    pub settled_lag_rad: f64,
    /// Largest relative drift of the frequency, 1/s.
    pub settled_frequency_drift_1_s: f64,
    /// Largest relative drift of the response, 1/s.
    pub settled_amplitude_drift_1_s: f64,
    /// Largest relative deviation of a controlled amplitude.
    pub settled_amplitude: f64,
    /// Largest relative difference between single periods.
    pub settled_spread: f64,
    /// Largest deviation of a controlled harmonic of the force over its fundamental.
    pub settled_harmonics: f64,
    /// Standard errors of the noise that are let through beyond the first five.
    pub settled_confidence: f64,
    /// Longest time at a level before it is recorded as it is, s.
    pub longest_hold_s: f64,
    /// Largest peak of the drive, N or V; infinite: no limit, as for those below.
    pub largest_drive: f64,
    /// Largest displacement, m.
    pub largest_stroke_m: f64,
    /// Largest contact force, N.
    pub largest_contact_force_n: f64,
    /// Largest force of the exciter, N.
    pub largest_force_n: f64,
    /// Longest time without finite samples, s.
    pub longest_silence_s: f64,
    /// Time in which the drive goes to zero in an emergency, s.
    pub stop_duration_s: f64,
    /// Rate of the controlled harmonics, 1/s.
    pub harmonics_rate_1_s: f64,
    /// Largest controlled harmonic of the force over its fundamental.
    pub harmonics_largest: f64,
    /// Motion sensors of the control of harmonics.
    pub sensor_count: u32,
    /// Linear modes that they tell apart.
    pub mode_count: u32,
    /// Index of the sensor at the drive point.
    pub drive_sensor: u32,
    /// What each sensor measures, as `quantity`.
    pub sensor_quantities: [u32; MAX_SENSORS],
    /// Pseudo-inverse of the mode shapes, a row a mode and a column a sensor, √kg.
    pub modal_rows: [[f64; MAX_SENSORS]; MAX_MODES],
    /// Angular eigenfrequency of each mode, rad/s.
    pub mode_rad_s: [f64; MAX_MODES],
    /// Damping ratio of each mode.
    pub mode_damping_ratios: [f64; MAX_MODES],
    /// Answer of the force to the drive in the harmonics 2, 3 …, N or N/V.
    pub transfer: [Complex64; MAX_HARMONICS],
}

impl CSettings {
    /// The defaults of the library.
    pub(crate) fn new(resonance: Resonance, start: f64, step: f64) -> Self {
        let (phase, limits) = (LoopSettings::new(resonance, start, step), Limits::default());
        let response = AmplitudeSettings::response(&phase, 0.0);
        let (settling, lock) = (SteadyCriteria::default(), phase.lock);
        Self {
            step_s: step,
            resonance_rad_s: resonance.omega,
            damping_ratio: resonance.damping_ratio,
            start_rad_s: start,
            lowest_rad_s: phase.range[0],
            highest_rad_s: phase.range[1],
            quantity: 0,
            detector: 0,
            detector_harmonics: phase.detector.highest_harmonic() as u32,
            controlled: 0,
            lag_rad: phase.displacement_lag,
            cut_off_rad_s: phase.cut_off,
            proportional_1_s: 0.0,
            integral_1_s2: 0.0,
            smallest_force_n: phase.smallest[0],
            smallest_response: phase.smallest[1],
            lock_tolerance_rad: lock.tolerance,
            lock_duration_s: lock.duration,
            amplitude_rate_1_s: response.rate,
            amplitude_gain: response.gain,
            smallest_drive: 0.0,
            levels: [0.0; MAX_LEVELS],
            level_count: 0,
            window_periods: settling.periods as u32,
            windows: settling.windows as u32,
            controlled_harmonics: 1,
            ramp_s: 1.0,
            start_s: 1.0,
            record_s: 1.0,
            settled_lag_rad: settling.lag,
            settled_frequency_drift_1_s: settling.frequency_drift,
            settled_amplitude_drift_1_s: settling.amplitude_drift,
            settled_amplitude: settling.amplitude,
            settled_spread: settling.spread,
            settled_harmonics: settling.harmonics,
            settled_confidence: settling.confidence,
            longest_hold_s: settling.longest,
            largest_drive: limits.drive,
            largest_stroke_m: limits.stroke,
            largest_contact_force_n: limits.contact_force,
            largest_force_n: limits.force,
            longest_silence_s: limits.silence,
            stop_duration_s: limits.stop_duration,
            harmonics_rate_1_s: 0.2 * phase.cut_off,
            harmonics_largest: 1.0,
            sensor_count: 0,
            mode_count: 0,
            drive_sensor: 0,
            sensor_quantities: [0; MAX_SENSORS],
            modal_rows: [[0.0; MAX_SENSORS]; MAX_MODES],
            mode_rad_s: [0.0; MAX_MODES],
            mode_damping_ratios: [0.0; MAX_MODES],
            transfer: [Complex64::ONE; MAX_HARMONICS],
        }
    }

    /// The same as settings of the library.
    pub(crate) fn checked(&self) -> Result<TestSettings, PhaseLoopError> {
        let mut schedule =
            LevelSchedule { levels: self.levels, count: self.level_count as usize, ..LevelSchedule::new(&[])? };
        (schedule.ramp, schedule.start, schedule.record) = (self.ramp_s, self.start_s, self.record_s);
        schedule.settling = self.settling();
        Ok(TestSettings {
            phase: self.phase()?,
            amplitude: self.amplitude()?,
            schedule,
            limits: self.limits(),
            harmonics: self.harmonics()?,
        })
    }

    fn phase(&self) -> Result<LoopSettings, PhaseLoopError> {
        let designed = self.proportional_1_s == 0.0 && self.integral_1_s2 == 0.0;
        Ok(LoopSettings {
            step: self.step_s,
            resonance: Resonance { omega: self.resonance_rad_s, damping_ratio: self.damping_ratio },
            start: self.start_rad_s,
            range: [self.lowest_rad_s, self.highest_rad_s],
            quantity: quantity(self.quantity)?,
            displacement_lag: self.lag_rad,
            detector: match self.detector {
                0 => PhaseDetector::Adaptive { harmonics: self.detector_harmonics as usize },
                1 => PhaseDetector::Demodulation { order: Order::First },
                2 => PhaseDetector::Demodulation { order: Order::Second },
                code => return Err(PhaseLoopError::Code { what: "detector", code, most: 2 }),
            },
            cut_off: self.cut_off_rad_s,
            gains: (!designed).then_some(Gains { proportional: self.proportional_1_s, integral: self.integral_1_s2 }),
            smallest: [self.smallest_force_n, self.smallest_response],
            lock: LockSettings { tolerance: self.lock_tolerance_rad, duration: self.lock_duration_s },
        })
    }

    fn amplitude(&self) -> Result<AmplitudeSettings, PhaseLoopError> {
        let controlled = match self.controlled {
            0 => return Ok(AmplitudeSettings::drive()),
            1 => Controlled::Force,
            2 => Controlled::Response,
            code => return Err(PhaseLoopError::Code { what: "controlled", code, most: 2 }),
        };
        let (rate, gain, smallest) = (self.amplitude_rate_1_s, self.amplitude_gain, self.smallest_drive);
        Ok(AmplitudeSettings { controlled, rate, gain, smallest })
    }

    fn settling(&self) -> SteadyCriteria {
        SteadyCriteria {
            periods: self.window_periods as usize,
            windows: self.windows as usize,
            lag: self.settled_lag_rad,
            frequency_drift: self.settled_frequency_drift_1_s,
            amplitude_drift: self.settled_amplitude_drift_1_s,
            amplitude: self.settled_amplitude,
            spread: self.settled_spread,
            harmonics: self.settled_harmonics,
            confidence: self.settled_confidence,
            longest: self.longest_hold_s,
        }
    }

    fn limits(&self) -> Limits {
        Limits {
            drive: self.largest_drive,
            stroke: self.largest_stroke_m,
            contact_force: self.largest_contact_force_n,
            force: self.largest_force_n,
            silence: self.longest_silence_s,
            stop_duration: self.stop_duration_s,
        }
    }

    fn harmonics(&self) -> Result<Option<ForceAppropriation>, PhaseLoopError> {
        if self.controlled_harmonics == 1 {
            return Ok(None);
        }
        let sensors = self.sensor_count as usize;
        let mut modes = ModalFilter::new(sensors)?;
        let count = self.mode_count as usize;
        if count > MAX_MODES {
            return Err(PhaseLoopError::TooMany { what: "linear modes", given: count, most: MAX_MODES });
        }
        let figures = self.mode_rad_s.iter().zip(&self.mode_damping_ratios);
        for (row, (omega, damping_ratio)) in self.modal_rows.iter().zip(figures).take(count) {
            modes = modes.with_mode(row.get(..sensors).unwrap_or_default(), *omega, *damping_ratio)?;
        }
        let mut quantities = [ResponseQuantity::default(); MAX_SENSORS];
        for (mine, code) in quantities.iter_mut().zip(&self.sensor_quantities).take(sensors) {
            *mine = quantity(*code)?;
        }
        let (drive, harmonics) = (self.drive_sensor as usize, self.controlled_harmonics as usize);
        let quantities = quantities.get(..sensors).unwrap_or_default();
        let settings = AppropriationSettings {
            rate: self.harmonics_rate_1_s,
            largest: self.harmonics_largest,
            ..AppropriationSettings::new(harmonics, modes, quantities, drive, self.step_s, self.cut_off_rad_s)?
        };
        ForceAppropriation::new(settings, &self.transfer).map(Some)
    }
}

fn quantity(code: u32) -> Result<ResponseQuantity, PhaseLoopError> {
    match code {
        0 => Ok(ResponseQuantity::Displacement),
        1 => Ok(ResponseQuantity::Velocity),
        2 => Ok(ResponseQuantity::Acceleration),
        code => Err(PhaseLoopError::Code { what: "quantity", code, most: 2 }),
    }
}

use core::f64::consts::PI;

use num_complex::Complex64;

use crate::detector::PreparedDetector;
use crate::math::{arg, between, norm, rem_tau};
use crate::{Gains, LockSettings, LoopSettings, LoopState, LowPass, PhaseLoopError};

/// A phase-locked loop with checked settings; see the [crate](crate) for its equations.
#[derive(Debug, Clone, PartialEq)]
pub struct PhaseLockedLoop {
    settings: LoopSettings,
    prepared: PreparedLoop,
}

impl PhaseLockedLoop {
    /// A loop with these settings.
    ///
    /// # Errors
    /// [`PhaseLoopError::UnstableGains`] beyond the limit of Routh, and the other variants for settings that cannot
    /// work.
    pub fn new(settings: LoopSettings) -> Result<Self, PhaseLoopError> {
        let prepared = PreparedLoop::new(&settings)?;
        Ok(Self { settings, prepared })
    }

    /// The settings.
    pub fn settings(&self) -> &LoopSettings {
        &self.settings
    }

    /// The gains in use.
    pub fn gains(&self) -> Gains {
        self.prepared.gains
    }

    /// The low-pass of the detector, as the stability limit sees it.
    pub fn low_pass(&self) -> LowPass {
        self.settings.detector.low_pass(self.settings.cut_off)
    }

    /// Lag of the measured response that the loop works for, rad.
    pub fn target_lag(&self) -> f64 {
        self.prepared.target
    }

    /// State before the first sample: phase zero at the starting frequency.
    pub fn start(&self) -> LoopState {
        self.prepared.start()
    }

    /// The state after the samples `force` and `response`, taken at the phase [`LoopState::drive_phase`] of `state`.
    ///
    /// The phase of the result is that of the next sample, one step later. Samples that are not finite are ignored: the
    /// drive continues at its frequency, and the loop counts as not locked.
    pub fn step(&self, state: &LoopState, force: f64, response: f64) -> LoopState {
        self.prepared.step(state, force, response)
    }
}

/// What a step needs of the settings.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PreparedLoop {
    /// Sampling interval, s.
    pub(crate) step: f64,
    start: f64,
    range: [f64; 2],
    gains: Gains,
    detector: PreparedDetector,
    /// Lag of the measured response that the loop works for, rad.
    pub(crate) target: f64,
    smallest: [f64; 2],
    lock: LockSettings,
}

impl PreparedLoop {
    /// Checked settings.
    pub(crate) fn new(settings: &LoopSettings) -> Result<Self, PhaseLoopError> {
        settings.check()?;
        let low_pass = settings.detector.low_pass(settings.cut_off);
        let gains = match settings.gains {
            Some(gains) => gains,
            None => Gains::design(settings.resonance, low_pass)?,
        };
        gains.check(settings.resonance, low_pass)?;
        Ok(Self {
            step: settings.step,
            start: settings.start,
            range: settings.range,
            gains,
            detector: settings.detector.prepare(settings.cut_off, settings.step)?,
            target: settings.quantity.lag(settings.displacement_lag),
            smallest: settings.smallest,
            lock: settings.lock,
        })
    }

    pub(crate) fn start_frequency(&self) -> f64 {
        self.start
    }

    pub(crate) fn detector(&self) -> PreparedDetector {
        self.detector
    }

    pub(crate) fn start(&self) -> LoopState {
        LoopState {
            theta: 0.0,
            omega: self.start,
            integral: 0.0,
            lag: self.target,
            error: 0.0,
            within: 0.0,
            measurable: false,
            locked: false,
            held: false,
            at_limit: false,
            detector: self.detector.start(),
        }
    }

    pub(crate) fn step(&self, state: &LoopState, force: f64, response: f64) -> LoopState {
        let mut next = *state;
        let finite = force.is_finite() && response.is_finite();
        if finite {
            next.detector = self.detector.step(&state.detector, state.theta, force, response);
            // Samples near the floating-point limit overflow: the detector restarts.
            if !next.detector.fundamentals().iter().all(|z| z.is_finite()) {
                next.detector = self.detector.start();
            }
        }
        self.measure(&mut next, finite);
        if let (Some(error), false) = (next.error(), next.held) {
            self.control(&mut next, error);
        }
        next.theta = rem_tau(state.theta + next.omega * self.step);
        next
    }

    /// Lag, its error, and the lock.
    fn measure(&self, state: &mut LoopState, finite: bool) {
        let [force, response] = state.detector.fundamentals();
        let above = |z: Complex64, least: f64| z.is_finite() && norm(z) > 0.0 && norm(z) >= least;
        let [least_force, least_response] = self.smallest;
        state.measurable = finite && above(force, least_force) && above(response, least_response);
        state.error = if state.measurable { wrap(self.target - (arg(force) - arg(response))) } else { 0.0 };
        state.lag = self.target - state.error;
        state.within = self.lock.count(state.within, state.error(), self.step);
        state.locked = state.within > 0.0 && state.within >= self.lock.duration;
    }

    /// Loop filter. At an end of the range the integral is frozen (anti-windup).
    fn control(&self, state: &mut LoopState, error: f64) {
        let [low, high] = self.range;
        let integral = state.integral + self.gains.integral * error * self.step;
        let omega = self.start + self.gains.proportional * error + integral;
        state.omega = between(omega, low, high);
        state.at_limit = state.omega != omega;
        if !state.at_limit || (omega > high) != (error > 0.0) {
            state.integral = integral;
        }
    }
}

/// `angle` in (−π, π].
fn wrap(angle: f64) -> f64 {
    PI - rem_tau(PI - angle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Resonance;

    fn made(range: [f64; 2], lock: LockSettings) -> PhaseLockedLoop {
        let resonance = Resonance { omega: 250.0, damping_ratio: 0.01 };
        PhaseLockedLoop::new(LoopSettings { range, lock, ..LoopSettings::new(resonance, 250.0, 1e-4) }).unwrap()
    }

    /// The integral would wind up under an error that presses against the end, however small, and falls under one that
    /// leads away from it.
    #[test]
    fn at_an_end_of_the_range_the_integral_only_goes_back() {
        let pll = made([249.0, 251.0], Default::default());
        for (integral, sign) in [(5.0, 1.0), (-5.0, -1.0)] {
            for error in [0.5, 0.05, 1e-6] {
                let mut state = LoopState { integral, ..pll.start() };
                pll.prepared.control(&mut state, sign * error);
                assert!(state.at_limit && state.omega == 250.0 + sign && state.integral == integral, "{error}");
                let mut state = LoopState { integral, ..pll.start() };
                pll.prepared.control(&mut state, -sign * error);
                assert!((state.integral - integral) * sign < 0.0, "{error}");
            }
        }
    }

    #[test]
    fn a_loop_is_locked_after_the_time_asked_for_however_short() {
        for duration in [0.5, 0.05, 1e-3] {
            let pll = made([200.0, 300.0], LockSettings { tolerance: 0.01, duration });
            let mut state = pll.start();
            let (mut first, mut k) = (None, 0);
            while first.is_none() && k < 100_000 {
                // A response that lags by a quarter of a period: no error from the first sample on that has a phase.
                let theta = state.drive_phase();
                state = pll.step(&state, theta.cos(), theta.sin());
                k += 1;
                first = state.locked.then_some((state.within, pll.settings.step));
            }
            let (within, step) = first.unwrap();
            assert!(within >= duration && within < duration + 1.5 * step, "{duration}: {within}");
        }
    }

    #[test]
    fn a_loop_begins_at_phase_zero_with_the_frequency_asked_for_and_no_error() {
        let resonance = Resonance { omega: 250.0, damping_ratio: 0.01 };
        let pll = PhaseLockedLoop::new(LoopSettings::new(resonance, 240.0, 1e-4)).unwrap();
        let start = pll.start();
        // Without an error it stays where it is.
        let mut later = start;
        pll.prepared.control(&mut later, 0.0);
        assert_eq!((later, start.within), (start, 0.0));
        assert_eq!((start.drive_phase(), start.omega(), start.lag()), (0.0, 240.0, 0.5 * PI));
        assert_eq!(start.fundamentals(), [Complex64::default(); 2]);
        assert!(start.error().is_none() && !start.is_locked() && !start.is_held() && !start.is_at_limit());
    }
}

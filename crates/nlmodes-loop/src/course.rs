use num_complex::Complex64;

use crate::detector::{DetectorState, PreparedDetector};
use crate::{Controlled, Stage, TestControl, TestState};

/// A level as a map from sample to sample: for whoever wants to know whether it can be held.
impl TestControl {
    /// The state at phase zero of a level that is being recorded, at the angular frequency `omega`, rad/s, before
    /// anything was measured. A drive that is itself controlled begins at `drive`, N or V.
    pub fn at_level(&self, level: f64, omega: f64, drive: f64) -> TestState {
        let mut state = self.start();
        (state.schedule.stage, state.schedule.wanted) = (Stage::Record, level);
        (state.phase.omega, state.phase.integral) = (omega, omega - self.phase.start_frequency());
        let [fundamental, ..] = &mut state.amplitudes;
        *fundamental = if self.amplitude.controlled == Controlled::Drive { level } else { drive }.into();
        state
    }

    /// Shows `see` each number on which the further course of a level depends, in an order of its own but for the
    /// first, the phase `θ`, and the second, the integral of the loop filter; it may change them. The control of higher
    /// harmonics is left out.
    pub fn each_number(&self, state: &mut TestState, see: &mut dyn FnMut(&mut f64)) {
        see(&mut state.phase.theta);
        see(&mut state.phase.integral);
        match (&self.phase.detector(), &mut state.phase.detector) {
            (PreparedDetector::Adaptive { harmonics, .. }, DetectorState::Adaptive { force, response }) => {
                for signal in [force, response] {
                    signal.amplitudes.iter_mut().take(*harmonics as usize).for_each(|z| both(z, see));
                    see(&mut signal.mean);
                }
            }
            (_, DetectorState::Demodulation { force, response }) => {
                force.filter.iter_mut().chain(&mut response.filter).for_each(|z| both(z, see));
            }
            _ => {}
        }
        if self.amplitude.controlled != Controlled::Drive {
            let [fundamental, ..] = &mut state.amplitudes;
            see(&mut fundamental.re);
            see(&mut state.amplitude_error);
        }
    }
}

fn both(z: &mut Complex64, see: &mut dyn FnMut(&mut f64)) {
    see(&mut z.re);
    see(&mut z.im);
}

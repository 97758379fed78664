use crate::error::{not_negative, positive};
use crate::math::between;
use crate::{LoopSettings, PhaseLoopError};

/// What the levels of a test are amplitudes of.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Controlled {
    /// The drive, N or V: no amplitude is controlled.
    #[default]
    Drive,
    /// The fundamental of the measured force, N.
    Force,
    /// The fundamental of the response, in its unit: stepped response.
    Response,
}

/// Control of an amplitude by that of the drive.
///
/// ```text
/// u̇ = max(u, u_0) (κ e + K ė) ,   e = 1 − |Y_1| / A* ,   −1 ≤ e ≤ 1
/// ```
///
/// Near the level `A*` the logarithm of the drive is under a proportional and an integral control, whatever the gain of
/// the exciter; from zero, and wherever `e` is at its limit, the drive grows at the rate `κ`. A resonance of decay rate
/// `δ` answers through `δ / (s + δ)`: with `K = κ/δ` the pole is cancelled, and the level is reached at the rate `κ`
/// without overshoot. Against a stop the amplitude hardly depends on the drive, `ε = d ln|Y_1| / d ln u ≪ 1`, and the
/// rest of a deviation decays at the rate `κ ε` only.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AmplitudeSettings {
    /// What is controlled.
    pub controlled: Controlled,
    /// Rate `κ`, 1/s.
    pub rate: f64,
    /// Proportional gain `K`.
    pub gain: f64,
    /// Drive `u_0` from which the amplitude grows, N or V.
    pub smallest: f64,
}

impl AmplitudeSettings {
    /// The drive itself: levels are its amplitudes.
    pub const fn drive() -> Self {
        Self { controlled: Controlled::Drive, rate: 0.0, gain: 0.0, smallest: 0.0 }
    }

    /// The response, at an eighth of the cut-off of this loop's detector, with the pole of its resonance cancelled.
    pub fn response(phase: &LoopSettings, smallest: f64) -> Self {
        let (rate, delta) = (0.125 * phase.cut_off, phase.resonance.decay_rate());
        let gain = if delta > 0.0 { rate / delta } else { 0.0 };
        Self { controlled: Controlled::Response, rate, gain, smallest }
    }

    pub(crate) fn check(&self) -> Result<(), PhaseLoopError> {
        not_negative("gain of the amplitude", self.gain)?;
        if self.controlled == Controlled::Drive {
            return not_negative("rate of the amplitude (1/s)", self.rate).map(drop);
        }
        positive("rate of the amplitude (1/s)", self.rate)?;
        positive("smallest drive (N or V)", self.smallest).map(drop)
    }

    /// Drive after a step of this length, with the amplitudes `|F_1|` and `|X_1|` that were measured; `before` is the
    /// error of the step before, and becomes that of this one.
    pub(crate) fn step(&self, drive: f64, wanted: f64, measured: [f64; 2], before: &mut f64, step: f64) -> f64 {
        let [force, response] = measured;
        let found = match self.controlled {
            Controlled::Drive => return wanted,
            Controlled::Force => force,
            Controlled::Response => response,
        };
        let error = if wanted > 0.0 { between(1.0 - found / wanted, -1.0, 1.0) } else { -1.0 };
        let at_limit = error.abs() >= 1.0 || before.abs() >= 1.0;
        let change = if at_limit { 0.0 } else { error - *before };
        *before = error;
        let change = step * self.rate * error + self.gain * change;
        // An exponential takes back what ripple of the amplitude has added; a product of small changes would drift.
        if drive > self.smallest { drive * libm::exp(change) } else { (drive + self.smallest * change).max(0.0) }
    }

    /// Deviation from the level relative to it; none where the drive itself is the level.
    pub(crate) fn deviation(&self, wanted: f64, measured: [f64; 2]) -> f64 {
        let [force, response] = measured;
        match self.controlled {
            Controlled::Force if wanted > 0.0 => force / wanted - 1.0,
            Controlled::Response if wanted > 0.0 => response / wanted - 1.0,
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `K = κ/δ` leaves `1/(s + κ)`: a small step of the level is followed without overshoot, at the rate `κ`.
    #[test]
    fn a_resonance_follows_a_small_step_of_the_level_at_the_rate_of_the_control() {
        let (delta, rate, step, plant) = (0.5, 3.0, 1e-4, 3e-5);
        let gain = rate / delta;
        let control = AmplitudeSettings { controlled: Controlled::Response, rate, gain, smallest: 1e-3 };
        let (mut drive, mut response, mut before) = (1.0, plant, 0.0);
        let (level, mut worst) = (1.001 * plant, 0.0_f64);
        for k in 0..40_000 {
            let t = step * f64::from(k);
            worst = worst.max((response / plant - 1.0 - 1e-3 * (1.0 - (-rate * t).exp())).abs());
            assert!(response <= level * (1.0 + 1e-6));
            drive = control.step(drive, level, [0.0, response], &mut before, step);
            response += step * delta * (plant * drive - response);
        }
        assert!(worst < 2e-5, "{worst}");
        assert!((response / level - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_drive_begins_at_its_smallest_and_never_goes_below_zero() {
        let control = AmplitudeSettings { controlled: Controlled::Force, rate: 2.0, gain: 5.0, smallest: 0.1 };
        let step = |drive: f64, wanted: f64, force: f64| control.step(drive, wanted, [force, 9.0], &mut 0.3, 1e-3);
        assert!((step(0.0, 1.0, 0.0) - 2e-4).abs() < 1e-15);
        assert_eq!(step(1e-5, 0.0, 0.0), 0.0);
        // However far above the level: no faster down than at its rate.
        assert!((step(1.0, 1e-3, 50.0) - (-2e-3_f64).exp()).abs() < 1e-15);
        // Within reach of it the change of the error counts, too: from 0.3 to 0.2.
        assert!((step(1.0, 1.0, 0.8) - (2e-3 * 0.2 - 5.0 * 0.1_f64).exp()).abs() < 1e-12);
    }

    #[test]
    fn ripple_of_the_amplitude_leaves_the_drive_where_it_is() {
        let control = AmplitudeSettings { controlled: Controlled::Response, rate: 3.0, gain: 6.0, smallest: 1e-3 };
        let (mut drive, mut before) = (1.0, 0.0);
        for k in 0..20_000 {
            let ripple = 1e-3 * (0.9 * f64::from(k)).cos();
            drive = control.step(drive, 1.0, [0.0, 1.0 + ripple], &mut before, 5e-5);
        }
        // A product of changes of 1 ± K ripple would have lost 2 % in this second.
        assert!((drive - 1.0).abs() < 7e-3, "{drive}");
    }
}

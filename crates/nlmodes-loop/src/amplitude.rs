use crate::PhaseLoopError;
use crate::error::{not_negative, positive};
use crate::math::between;

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
/// u̇ = κ max(u, u_0) (1 − |Y_1| / A*) ,   −1 ≤ 1 − |Y_1| / A* ≤ 1
/// ```
///
/// Near the level `A*` the drive follows at the rate `κ`, whatever the gain of the exciter; from zero it begins at the
/// rate `κ u_0`. A resonance of decay rate `δ` answers through `δ / (s + δ)`, so that `κ = δ/4` has a double pole and
/// no overshoot; a larger one overshoots. Where the amplitude hardly depends on the drive, as against a hard stop, the
/// level is reached as much more slowly, with `κ d ln|Y_1| / d ln u`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AmplitudeSettings {
    /// What is controlled.
    pub controlled: Controlled,
    /// Rate `κ`, 1/s.
    pub rate: f64,
    /// Drive `u_0` from which the amplitude grows, N or V.
    pub smallest: f64,
}

impl AmplitudeSettings {
    /// The drive itself: levels are its amplitudes.
    pub const fn drive() -> Self {
        Self { controlled: Controlled::Drive, rate: 0.0, smallest: 0.0 }
    }

    pub(crate) fn check(&self) -> Result<(), PhaseLoopError> {
        if self.controlled == Controlled::Drive {
            return not_negative("rate of the amplitude (1/s)", self.rate).map(drop);
        }
        positive("rate of the amplitude (1/s)", self.rate)?;
        positive("smallest drive (N or V)", self.smallest).map(drop)
    }

    /// Drive after a step, not above `largest`, with the amplitudes `|F_1|` and `|X_1|` that were measured.
    pub(crate) fn step(&self, drive: f64, wanted: f64, measured: [f64; 2], step: f64) -> f64 {
        let [force, response] = measured;
        let found = match self.controlled {
            Controlled::Drive => return wanted,
            Controlled::Force => force,
            Controlled::Response => response,
        };
        let missing = if wanted > 0.0 { between(1.0 - found / wanted, -1.0, 1.0) } else { -1.0 };
        (drive + step * self.rate * drive.max(self.smallest) * missing).max(0.0)
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

    /// `δ/4` gives `u = u* (1 − (1 + δt/2) e^{−δt/2})` about the level for a small step, without overshoot.
    #[test]
    fn a_quarter_of_the_decay_rate_has_a_double_pole() {
        let (delta, step, gain) = (8.0, 1e-4, 3e-5);
        let control = AmplitudeSettings { controlled: Controlled::Response, rate: 0.25 * delta, smallest: 1e-3 };
        let (mut drive, mut response) = (1.0, gain);
        let (level, mut worst) = (1.001 * gain, 0.0_f64);
        for k in 0..20_000 {
            let t = step * f64::from(k);
            let expected = 1e-3 * (1.0 - (1.0 + 0.5 * delta * t) * (-0.5 * delta * t).exp());
            worst = worst.max((response / gain - 1.0 - expected).abs());
            assert!(response <= level * (1.0 + 1e-9));
            drive = control.step(drive, level, [0.0, response], step);
            response += step * delta * (gain * drive - response);
        }
        assert!(worst < 2e-6, "{worst}");
        assert!((response / level - 1.0).abs() < 1e-5);
    }

    #[test]
    fn a_drive_begins_at_its_smallest_and_never_goes_below_zero() {
        let control = AmplitudeSettings { controlled: Controlled::Force, rate: 2.0, smallest: 0.1 };
        assert!((control.step(0.0, 1.0, [0.0, 9.0], 1e-3) - 2e-4).abs() < 1e-15);
        assert_eq!(control.step(1e-5, 0.0, [0.0, 0.0], 1e-3), 0.0);
        // However far above the level: no faster down than at its rate.
        assert!((control.step(1.0, 1e-3, [50.0, 0.0], 1e-3) - 0.998).abs() < 1e-15);
    }
}

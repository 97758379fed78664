use nlmodes_linalg::eigenvalues;
use num_complex::Complex64;

use super::ClosedLoop;
use super::newton::{Guess, period};
use crate::rig::RigError;

/// A periodic motion of rig and control at a level, and whether the control holds it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LockedMotion {
    /// The level.
    pub level: f64,
    /// Angular frequency, rad/s.
    pub omega: f64,
    /// Amplitude of the fundamental of the force, N.
    pub force: f64,
    /// Amplitude of the fundamental of the response, in its unit.
    pub response: f64,
    /// Largest size of each channel over the period, in its unit.
    pub peaks: Vec<f64>,
    /// Floquet multipliers of a period, largest first, without the one of a shift in time.
    pub multipliers: Vec<Complex64>,
    /// Distance of that one from 1: what differences and sampling leave.
    pub trivial_defect: f64,
    pub(crate) at: Guess,
}

impl LockedMotion {
    /// Magnitude of the largest multiplier.
    pub fn largest(&self) -> f64 {
        self.multipliers.first().map_or(0.0, |μ| μ.norm())
    }

    /// Rate at which the slowest disturbance decays, 1/s; negative where it grows.
    pub fn decay_rate(&self) -> f64 {
        -self.largest().ln() / period(self.omega)
    }

    /// Whether all multipliers lie inside the unit circle, by more than their error.
    pub fn is_held(&self) -> bool {
        self.largest() < 1.0 - self.trivial_defect
    }
}

impl ClosedLoop {
    /// A motion that was found, with its multipliers.
    pub(crate) fn locked(&self, level: f64, at: Guess) -> Result<Option<LockedMotion>, RigError> {
        let samples = self.samples(at.omega);
        let map = self.map(level, at.omega, samples, 0.0)?;
        let after = map.after(&at.y)?;
        let Some(found) = self.derivatives(level, &at, samples, &after)? else { return Ok(None) };
        let mut multipliers = eigenvalues(&found.by_state)?;
        // A shift in time returns as it was.
        let neutral = (0..multipliers.len())
            .min_by(|a, b| (multipliers[*a] - 1.0).norm().total_cmp(&(multipliers[*b] - 1.0).norm()));
        let trivial_defect = neutral.map_or(0.0, |k| (multipliers.swap_remove(k) - 1.0).norm());
        multipliers.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        let [force, response] = map.amplitudes(&at.y)?;
        let peaks = map.peaks(&at.y)?;
        Ok(Some(LockedMotion { level, omega: at.omega, force, response, peaks, multipliers, trivial_defect, at }))
    }
}

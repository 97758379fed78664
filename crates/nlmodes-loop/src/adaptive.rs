use num_complex::Complex64;

use crate::MAX_HARMONICS;

/// Least mean squares estimate of the mean and of the leading harmonics of one signal.
///
/// ```text
/// ε   = y − Y_0 − Re Σ_n Y_n e^{inθ}
/// Y_n ← Y_n + 2 μ ε e^{−inθ} ,   Y_0 ← Y_0 + μ ε
/// ```
///
/// Each amplitude follows through a first-order low-pass with `μ = 1 − e^{−ω_c h}` a step; a signal that consists of
/// these harmonics leaves `ε = 0`, and so no ripple, neither from the double frequency nor from a mean value.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AdaptiveState {
    pub(crate) mean: f64,
    pub(crate) amplitudes: [Complex64; MAX_HARMONICS],
}

impl AdaptiveState {
    pub(crate) const ZERO: Self = Self { mean: 0.0, amplitudes: [Complex64::ZERO; MAX_HARMONICS] };

    /// `waves` are `e^{inθ}` for n = 1 … harmonics.
    pub(crate) fn step(mut self, signal: f64, waves: &[Complex64], rate: f64) -> Self {
        let harmonics = self.amplitudes.iter().zip(waves).map(|(y, e)| y.re * e.re - y.im * e.im);
        let error = signal - self.mean - harmonics.fold(0.0, |sum, part| sum + part);
        self.mean += rate * error;
        for (y, e) in self.amplitudes.iter_mut().zip(waves) {
            *y += e.conj() * (2.0 * rate * error);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_amplitudes_of_a_signal_of_these_harmonics_are_found_exactly() {
        for unit in [1.0, 1e-6] {
            let (mean, given) = (0.3 * unit, [(1.0, 0.4), (0.2, -1.1), (0.05, 2.0)]);
            let given = given.map(|(size, angle)| Complex64::from_polar(size * unit, angle));
            let mut state = AdaptiveState::ZERO;
            for k in 0..6000 {
                let waves = [1.0, 2.0, 3.0].map(|n| Complex64::cis(n * 0.07 * f64::from(k)));
                let signal = mean + given.iter().zip(&waves).map(|(y, e)| (y * e).re).sum::<f64>();
                state = state.step(signal, &waves, 0.01);
            }
            assert!((state.mean - mean).abs() < 1e-12 * unit, "{}", state.mean);
            for (found, given) in state.amplitudes.iter().zip(&given) {
                assert!((found - given).norm() < 1e-12 * unit, "{found} {given}");
            }
            assert!(state.amplitudes[3..].iter().all(|y| *y == Complex64::ZERO));
        }
    }

    #[test]
    fn the_estimate_follows_a_step_at_the_rate_of_its_low_pass() {
        // The averaged equation leaves (1 − μ)ᵏ of a step of the amplitude, but for ripple of the order of μ.
        let (rate, n) = (1e-3, 1000);
        let mut state = AdaptiveState::ZERO;
        for k in 0..n {
            let wave = [Complex64::cis(0.5 * f64::from(k))];
            state = state.step(wave[0].re, &wave, rate);
        }
        let left = 1.0 - state.amplitudes[0].re;
        assert!((left - (1.0_f64 - rate).powi(n)).abs() < 5.0 * rate, "{left}");
    }
}

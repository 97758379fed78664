use num_complex::Complex64;

use super::MAX_HARMONICS;

/// Least mean squares estimate of the mean and of the leading harmonics of one signal.
///
/// ```text
/// ε   = y − Y_0 − Re Σ_n Y_n e^{inθ}
/// Y_n ← Y_n + 2 μ ε e^{−inθ} ,   Y_0 ← Y_0 + μ ε
/// ```
///
/// Each amplitude follows through a first-order low-pass with `μ = 1 − e^{−ω_c h}` a step; a signal that consists of
/// these harmonics leaves `ε = 0`, and so no ripple, neither from the double frequency nor from a mean value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AdaptiveState {
    pub(super) mean: f64,
    pub(super) amplitudes: [Complex64; MAX_HARMONICS],
}

impl AdaptiveState {
    pub(super) const ZERO: Self = Self { mean: 0.0, amplitudes: [Complex64::ZERO; MAX_HARMONICS] };

    /// `waves` are `e^{inθ}` for n = 1 … harmonics.
    pub(super) fn step(mut self, signal: f64, waves: &[Complex64], rate: f64) -> Self {
        let harmonics = self.amplitudes.iter().zip(waves).map(|(y, e)| y.re * e.re - y.im * e.im);
        let error = signal - self.mean - harmonics.fold(0.0, |sum, part| sum + part);
        self.mean += rate * error;
        for (y, e) in self.amplitudes.iter_mut().zip(waves) {
            *y += e.conj() * (2.0 * rate * error);
        }
        self
    }
}

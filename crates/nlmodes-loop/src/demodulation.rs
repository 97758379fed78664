use num_complex::Complex64;

use crate::low_pass::SampledLowPass;

/// Synchronous demodulation of one signal: `2 y e^{−iθ}` through a low-pass.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DemodulationState {
    pub(crate) amplitude: Complex64,
    pub(crate) filter: [Complex64; 2],
}

impl DemodulationState {
    pub(crate) const ZERO: Self = Self { amplitude: Complex64::ZERO, filter: [Complex64::ZERO; 2] };

    /// `wave` is `e^{iθ}`.
    pub(crate) fn step(self, signal: f64, wave: Complex64, filter: &SampledLowPass) -> Self {
        let (amplitude, filter) = filter.step(self.filter, wave.conj() * (2.0 * signal));
        Self { amplitude, filter }
    }
}

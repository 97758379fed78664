use num_complex::Complex64;

use crate::adaptive::AdaptiveState;
use crate::demodulation::DemodulationState;
use crate::harmonics::powers;
use crate::low_pass::SampledLowPass;
use crate::math::cis;
use crate::{LowPass, MAX_HARMONICS, Order, PhaseLoopError};

/// How the complex amplitudes of force and response are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PhaseDetector {
    /// Adaptive least mean squares on the mean and the harmonics 1 to `harmonics`: no ripple from any of them.
    Adaptive {
        /// Number of harmonics, at most [`MAX_HARMONICS`].
        harmonics: usize,
    },
    /// Synchronous demodulation and low-pass, as in the paper: `2 y e^{−iθ}` has a part at twice the frequency (and,
    /// from a mean value, at the frequency itself) that the low-pass leaves as [ripple](Self::ripple).
    Demodulation {
        /// Order of the low-pass.
        order: Order,
    },
}

impl Default for PhaseDetector {
    /// Adaptive with five harmonics.
    fn default() -> Self {
        Self::Adaptive { harmonics: 5 }
    }
}

impl PhaseDetector {
    /// The low-pass through which the lag is seen; for the adaptive detector that of its averaged equations.
    pub fn low_pass(self, cut_off: f64) -> LowPass {
        match self {
            Self::Adaptive { .. } => LowPass { cut_off, order: Order::First },
            Self::Demodulation { order } => LowPass { cut_off, order },
        }
    }

    /// Amplitude, rad, with which the measured lag of two sinusoids oscillates at `2ω`.
    ///
    /// Demodulated, a sinusoid of amplitude `Y` reads `Y + H(−2iω) Ȳ e^{−2iθ}`, which turns the lag `ψ = arg F − arg X`
    /// by `2 |sin ψ| |H(2iω)|` to first order. The adaptive detector has none.
    pub fn ripple(self, cut_off: f64, omega: f64, lag: f64, step: f64) -> f64 {
        match self {
            Self::Adaptive { .. } => 0.0,
            Self::Demodulation { .. } => {
                2.0 * libm::sin(lag).abs() * self.low_pass(cut_off).sampled_gain(2.0 * omega, step)
            }
        }
    }

    pub(crate) fn highest_harmonic(self) -> usize {
        match self {
            Self::Adaptive { harmonics } => harmonics,
            Self::Demodulation { .. } => 1,
        }
    }

    pub(crate) fn prepare(self, cut_off: f64, step: f64) -> Result<PreparedDetector, PhaseLoopError> {
        match self {
            Self::Adaptive { harmonics } if harmonics == 0 || harmonics > MAX_HARMONICS => {
                Err(PhaseLoopError::Harmonics { harmonics, most: MAX_HARMONICS })
            }
            Self::Adaptive { harmonics } => {
                Ok(PreparedDetector::Adaptive { harmonics: harmonics as u32, rate: -libm::expm1(-cut_off * step) })
            }
            Self::Demodulation { .. } => Ok(PreparedDetector::Demodulation(self.low_pass(cut_off).sampled(step))),
        }
    }
}

/// A detector with its coefficients for one step.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum PreparedDetector {
    Adaptive { harmonics: u32, rate: f64 },
    Demodulation(SampledLowPass),
}

/// What a detector remembers of force and response.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum DetectorState {
    Adaptive { force: AdaptiveState, response: AdaptiveState },
    Demodulation { force: DemodulationState, response: DemodulationState },
}

impl PreparedDetector {
    pub(crate) fn start(&self) -> DetectorState {
        match self {
            Self::Adaptive { .. } => {
                DetectorState::Adaptive { force: AdaptiveState::ZERO, response: AdaptiveState::ZERO }
            }
            Self::Demodulation(_) => {
                DetectorState::Demodulation { force: DemodulationState::ZERO, response: DemodulationState::ZERO }
            }
        }
    }

    /// The state after one pair of samples at the phase `theta`.
    pub(crate) fn step(&self, state: &DetectorState, theta: f64, f: f64, x: f64) -> DetectorState {
        let wave = cis(theta);
        match (self, *state) {
            (&Self::Adaptive { harmonics, rate }, DetectorState::Adaptive { force, response }) => {
                let waves = powers(wave);
                let waves = waves.get(..harmonics as usize).unwrap_or(&waves);
                DetectorState::Adaptive { force: force.step(f, waves, rate), response: response.step(x, waves, rate) }
            }
            (Self::Demodulation(filter), DetectorState::Demodulation { force, response }) => {
                DetectorState::Demodulation {
                    force: force.step(f, wave, filter),
                    response: response.step(x, wave, filter),
                }
            }
            // The state belongs to another loop: restart with the detector of this one.
            (detector, _) => detector.step(&detector.start(), theta, f, x),
        }
    }
}

impl DetectorState {
    /// Complex amplitudes `F_1` and `X_1` in the frame of the drive.
    pub(crate) fn fundamentals(&self) -> [Complex64; 2] {
        match self {
            Self::Adaptive { force, response } => [force.amplitudes[0], response.amplitudes[0]],
            Self::Demodulation { force, response } => [force.amplitude, response.amplitude],
        }
    }
}

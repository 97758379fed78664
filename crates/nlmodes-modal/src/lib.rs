//! Harmonic motions and nonlinear modal quantities: the vocabulary that computation and experiment share.
//!
//! ```text
//! q(t) = Re Σ_{n=0}^{H} q_n e^{inωt}                                                       eqs. (7), (20)
//! q_n  = (2/N) Σ_j q(t_j) e^{−inωt_j} ,  half of that for n = 0                             eq. (14)
//! ```
//!
//! | symbol | meaning | unit | item |
//! | --- | --- | --- | --- |
//! | `q_n` | complex Fourier coefficients | that of the coordinate | [`HarmonicCoefficients`], [`HarmonicBasis`] |
//! | `ω̃` | nonlinear modal frequency | rad/s | [`ModalPoint::omega`] |
//! | `q̃` | nonlinear modal amplitude, eqs. (21), (22) | m·√kg | [`ModalPoint::modal_amplitude`] |
//! | `E_av` | averaged kinetic energy | J | [`ModalPoint::kinetic_energy`] |
//!
//! A [`ModalBranch`] is a nonlinear mode over energy, computed or measured; a [`TimeHistory`] looks closer at one of its points.
//!
//! Equation numbers: S. Peter, F. Schreyer, R. I. Leine, *A method for numerical and experimental nonlinear modal analysis of
//! nonsmooth systems*, Mechanical Systems and Signal Processing 120 (2019) 793-807.

mod basis;
mod branch;
mod coefficients;
mod error;
mod history;
mod resonance;

pub use basis::HarmonicBasis;
pub use branch::{BranchEnd, Coordinate, ModalBranch, ModalPoint};
pub use coefficients::HarmonicCoefficients;
pub use error::ModalError;
pub use history::{ContactInstant, TimeHistory};
pub use resonance::{InternalResonance, RESONANT_SHARE, Tongue, tongues};

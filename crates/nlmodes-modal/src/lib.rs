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
//! | `φ̃_n` | complex mode shape per harmonic, eqs. (21), (22) | 1/√kg | [`NonlinearModeShape`] |
//! | `Φ` | mass-normalised linear modes | 1/√kg | [`LinearModes`] |
//! | `v` | participation of the linear modes, eq. (30) | 1 | [`Participation`] |
//! | `δ̃` | nonlinear modal damping coefficient, eqs. (25)-(28) | 1 | [`damping_coefficient`], [`LinearDissipation`] |
//! | `e_N` | coefficient of restitution, eq. (29) | 1 | [`Restitution`] |
//! | `k_c` | contact stiffness, eq. (3) | N/m | [`ContactStiffness`] |
//! | `∫ λ dt` | share, force and impulse of a contact over a period | N·s | [`ContactPeriod`] |
//! | `E_av` | averaged kinetic energy | J | [`ModalPoint::kinetic_energy`] |
//!
//! A [`ModalBranch`] is a nonlinear mode over energy, computed or measured; a [`TimeHistory`] is the motion at one of
//! its points.
//!
//! Equation numbers: S. Peter, F. Schreyer, R. I. Leine, *A method for numerical and experimental nonlinear modal
//! analysis of nonsmooth systems*, Mechanical Systems and Signal Processing 120 (2019) 793-807.

mod basis;
mod branch;
mod branch_end;
mod coefficients;
mod contact_interval;
mod contact_period;
mod contact_stiffness;
mod damping;
mod error;
mod event;
mod gradient;
mod history;
mod linear_modes;
mod mode_shape;
mod monotone;
mod noise;
mod participation;
mod resonance;
mod restitution;
mod sliding;
mod stability;

pub use basis::HarmonicBasis;
pub use branch::{Coordinate, Driven, ModalBranch, ModalPoint, PeakStress};
pub use branch_end::{BranchEnd, EndReason};
pub use coefficients::HarmonicCoefficients;
pub use contact_interval::{ContactInterval, contact_intervals};
pub use contact_period::ContactPeriod;
pub use contact_stiffness::ContactStiffness;
pub use damping::{LinearDissipation, damping_coefficient};
pub use error::ModalError;
pub use event::Event;
pub use gradient::{Gradient, GradientOf};
pub use history::{ContactInstant, TimeHistory};
pub use linear_modes::LinearModes;
pub use mode_shape::{NonlinearModeShape, PhaseAnchor, shifted};
pub use monotone::{cubic, monotone_slopes};
pub use noise::noise_level;
pub use participation::Participation;
pub use resonance::{DETUNING, InternalResonance, RESONANT_SHARE, Tongue, tongues};
pub use restitution::{Impact, Restitution, RestitutionStatistics};
pub use sliding::{ClosedSpan, Sliding};
pub use stability::Stability;

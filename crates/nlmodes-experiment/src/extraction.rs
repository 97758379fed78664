//! Periods of a record to a point of a nonlinear mode: frequency, shape, damping, power-based mode indicator.
//!
//! ```text
//! frequency ω̃   →   an integer number of periods   →   q_n = least squares on all harmonics   →   modal quantities
//!                                                       (v, a divided by inω, (inω)²)               findings
//! ```
//!
//! The sampling rate is no multiple of the frequency, so a number of whole samples is never a whole number of periods.
//! The Fourier coefficients are therefore those of a least squares fit of all harmonics at once, which does not leak;
//! its matrix is known in closed form. Every figure is then evaluated again on each single period: their spread is its
//! uncertainty.
//!
//! [`extract`] does all of it.

mod balance;
mod blocks;
mod clipping;
mod consensus;
mod contact;
mod drift;
mod error;
mod extract;
mod finding;
mod folded;
mod force_balance;
mod force_law;
mod free_decay;
mod frequency;
mod guess;
mod harmonic_fit;
mod judgement;
mod layout;
mod loss;
mod measured;
mod missing;
mod phase_grid;
mod power;
mod quadrature;
mod quality;
mod repeated;
mod result;
mod scale;
mod settings;
mod skew;
mod steady;
mod values;
mod window;

pub use error::ExtractionError;
pub use extract::extract;
pub use finding::Finding;
pub use force_balance::BalanceFigures;
pub use free_decay::{DecayPoint, FreeDecay, free_decay};
pub use harmonic_fit::HarmonicFit;
pub use measured::Measured;
pub use power::ExcitationPower;
pub use result::{ContactFigures, ExcitationFigures, ModalFigures, RecordExtraction};
pub use settings::{ExtractionSettings, ModeErrors, Stop, Tolerances};
pub use steady::{Steadiness, steady_stretches};
pub use window::FEWEST_PERIODS;

//! Harmonic motions and nonlinear modal quantities: the vocabulary that computation and experiment share.
//!
//! ```text
//! q(t) = Re Σ_{n=0}^{H} q_n e^{inωt}                                                       eqs. (7), (20)
//! ```

mod basis;
mod branch;
mod coefficients;
mod error;
mod history;

pub use basis::HarmonicBasis;
pub use branch::{BranchEnd, Coordinate, ModalBranch, ModalPoint};
pub use coefficients::HarmonicCoefficients;
pub use error::ModalError;
pub use history::{ContactInstant, TimeHistory};

//! Mixed shooting-harmonic balance for structures with unilateral contact.

mod closed_set;
mod condensed;
mod energy;
mod error;
mod mixed_shooting;
mod motion;
mod series;
mod start;
mod sweep;
mod switching;
mod transfer;
mod trigonometric;

pub use condensed::{CondensedStructure, HeldMode};
pub use error::HbmError;
pub use mixed_shooting::{MAX_HARMONICS, MixedShooting, MixedShootingSettings, Scales};
pub use motion::ContactMotion;
pub use series::{RealSeries, Symmetry};
pub use start::{Grazing, grazing};
pub use sweep::{ContactInterval, Switching};

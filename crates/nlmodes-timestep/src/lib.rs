mod dynamics;
mod error;
mod floquet;
mod oscillation;
mod phase;
mod shooting;
mod trajectory;
mod verification;

pub use dynamics::{ContactDynamics, MAX_DOFS};
pub use error::TimestepError;
pub use floquet::{Floquet, UNIT_CIRCLE};
pub use shooting::{PeriodicMotion, Shooting, ShootingScales};
pub use trajectory::{ClosedInterval, ModalState, Snapshot, Trajectory};
pub use verification::Verification;

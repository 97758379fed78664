mod dynamics;
mod error;
mod floquet;
mod global_problem;
mod oscillation;
mod phase;
mod shooting;
mod trajectory;
mod verification;

pub use dynamics::{ContactDynamics, MAX_DOFS};
pub use error::TimestepError;
pub use floquet::{Floquet, UNIT_CIRCLE};
pub use global_problem::GlobalContactProblem;
pub use shooting::{PeriodicMotion, Shooting, ShootingScales};
pub use trajectory::{ClosedInterval, ModalState, Snapshot, Trajectory};
pub use verification::Verification;

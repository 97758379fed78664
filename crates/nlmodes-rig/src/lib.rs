//! Virtual test rig: a vibrating structure with a stop, a shaker, sensors and a level schedule.

mod bernstein;
mod drive;
mod error;
mod exciter;
mod finding;
mod functional;
mod hold;
mod matrix;
mod period;
mod propagator;
mod record;
mod rig;
mod sensor;
mod session;
mod state_space;
mod stop;
mod structure;
mod virtual_test;

pub use drive::Drive;
pub use error::RigError;
pub use exciter::{Exciter, Shaker};
pub use finding::Finding;
pub use hold::{Hold, Settling, SteadyState};
pub use record::{Record, RecordChannel};
pub use rig::{RigSetup, VirtualRig};
pub use sensor::{Motion, Place, Quantity, Sensor};
pub use session::Session;
pub use stop::{Stop, StopLaw, StopSide};
pub use structure::{DrivePoint, ModalStructure};
pub use virtual_test::{LevelOutcome, Schedule, VirtualTest};

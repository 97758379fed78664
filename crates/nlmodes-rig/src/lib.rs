//! Virtual test rig: a vibrating structure with a stop, a shaker, sensors and a level schedule.

mod bernstein;
mod drive;
mod error;
mod exciter;
mod functional;
mod matrix;
mod propagator;
mod rig;
mod sensor;
mod state_space;
mod stop;
mod structure;

pub use drive::Drive;
pub use error::RigError;
pub use exciter::{Exciter, Shaker};
pub use rig::{RigSetup, VirtualRig};
pub use sensor::{Motion, Place, Quantity, Sensor};
pub use stop::{Stop, StopLaw, StopSide};
pub use structure::{DrivePoint, ModalStructure};

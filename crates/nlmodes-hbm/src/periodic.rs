//! Damped, forced and conservative periodic motions of a structure in open modes, put together from a linear response, the contact
//! operator and closing conditions.

mod analysis;
mod block;
mod conditions;
mod contact_response;
mod damping;
mod directions;
mod doubling;
mod equations;
mod floquet;
mod load;
mod modal_response;
mod motion;
mod pieces;
mod refine;
mod rows;
mod start;
mod structure;
mod system;

pub use analysis::Coordinates;
pub use conditions::{ClosingConditions, Column, OperatingPoint, Source};
pub use damping::ModalDamping;
pub use equations::{ClosingEquation, EnergyGiven, Functional, Motion, PhaseAnchor, PhaseLag};
pub use floquet::{Floquet, Instability};
pub use load::{Load, LoadTerm};
pub use motion::{ContactMotion, PeriodicMotion};
pub use refine::Refined;
pub use start::{ModalGrazing, modal_grazing};
pub use structure::{DampedStop, ModalStructure, ResponseRow};
pub use system::{PeriodicSettings, PeriodicSystem};

//! Damped, forced and conservative periodic motions of a structure in open modes, put together from a linear response,
//! the contact operator and closing conditions.

mod adjoint;
mod analyses;
mod block;
mod change;
mod closing_equations;
mod contact_response;
mod damped_stop;
mod damping;
mod directions;
mod doubling;
mod floquet;
mod law;
mod load;
mod modal_response;
mod mode_sums;
mod motion;
mod of_open;
mod operating_point;
mod pieces;
mod refine;
mod rows;
mod sensitivity;
mod start;
mod structure;
mod system;
mod weights;

pub use adjoint::{MotionChange, MotionGradient, Watched};
pub use analyses::Coordinates;
pub use change::{Changes, ManyChanges, StructureChange, StructureState};
pub use closing_equations::{ClosingEquation, EnergyGiven, Functional, Motion, PhaseCondition, PhaseLag};
pub use damped_stop::DampedStop;
pub use damping::ModalDamping;
pub use floquet::Floquet;
pub use law::{
    Bilinear, Exponential, ForceLaw, HertzStop, LawAtRest, LawForce, ModeStart, PlacedLaw, Polynomial, PowerDamper,
    PowerSpring, TableLaw, UNIT_ENERGY, about_rest_of_law, law_length, laws_at_rest, modal_start, touch_spans,
};
pub use load::{Load, LoadTerm};
pub use motion::{ContactMotion, PeriodicMotion, largest_value};
pub use operating_point::{Closing, Column, OperatingPoint, Source};
pub use refine::Refined;
pub use sensitivity::Opening;
pub use start::{Grazing, ModeAtRest, modal_grazing, modal_grazing_opened, modal_lift_off_opened};
pub(crate) use start::{STRAINLESS, unless_touching};
pub use structure::{ModalStructure, ResponseRow};
pub use system::{MAX_HARMONICS, PeriodicSettings, PeriodicSystem, Scales};
pub use weights::{PartWeights, StructureWeights};

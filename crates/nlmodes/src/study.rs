//! Whole studies: from a model to a branch of modal points.

mod branch;
mod error;
mod events;
mod points;
mod settings;
mod start;

pub use branch::{ComputedBranch, compute_branch};
pub use error::StudyError;
pub use events::event_name;
pub use points::{figure_points, reference_points};
pub use settings::{BranchSettings, BranchStart};

//! Whole studies: from a model to a branch of modal points.

mod branch;
mod compute;
mod error;
mod events;
mod homotopy;
mod participation;
mod points;
mod prepare;
mod resonances;
mod settings;
mod skip;
mod start;
mod touching;
mod trace;

pub use branch::{BranchOrigin, BranchProgress, ComputedBranch};
pub use compute::{ComputedTree, compute_branch, compute_tree};
pub use error::StudyError;
pub use events::event_name;
pub use points::{figure_points, reference_points};
pub use settings::{BranchPointRule, BranchSettings, BranchStart, ResonanceRule};

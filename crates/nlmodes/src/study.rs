//! Whole studies: from a model to a branch of modal points.

mod accuracy;
mod adaptive;
mod beyond;
mod branch;
mod compute;
mod equal;
mod error;
mod events;
mod homotopy;
mod left;
mod participation;
mod periodic;
mod points;
mod prepare;
mod refuse;
mod resonances;
mod settings;
mod skip;
mod stability;
mod start;
mod touching;
mod trace;
mod watch;

pub use accuracy::{Accuracy, AccuracyReached};
pub use beyond::BeyondAccuracy;
pub use branch::{BranchOrigin, BranchProgress, ComputedBranch};
pub use compute::{ComputedTree, compute_branch, compute_tree, compute_tree_with_log};
pub use equal::PointBetween;
pub use error::StudyError;
pub use events::event_name;
pub use left::LeftMode;
pub use periodic::PeriodicError;
pub use points::{figure_points, reference_points};
pub use refuse::check_study;
pub use settings::{BranchMethod, BranchPointRule, BranchSettings, BranchStart, ResonanceRule, StabilityRule};
pub use watch::{Doing, Ended, Watch};

//! Whole branches: from a model to modal points along each half-branch.

mod accuracy;
mod adaptive;
mod beyond;
mod branch;
mod compute;
mod equal;
mod error;
mod events;
mod found;
mod guide;
mod histories;
pub(crate) mod homotopy;
mod left;
mod participation;
mod periodic;
mod points;
mod prepare;
mod refined;
mod refuse;
mod resonances;
mod returned;
mod settings;
mod skip;
mod stability;
mod start;
mod touching;
mod trace;
mod viewer;

/// What a computation reports to be doing while it finds points.
pub const FOLLOWING: &str = "following the branch";

pub use accuracy::{Accuracy, AccuracyReached};
pub use beyond::BeyondAccuracy;
pub use branch::{BranchOrigin, BranchProgress, ComputedBranch};
pub use compute::{ComputedTree, compute_branch, compute_tree, compute_tree_with_log};
pub use equal::PointBetween;
pub use error::BranchError;
pub use events::event_of;
pub use histories::Histories;
pub use left::LeftMode;
pub use nlmodes_continuation::{Ended, Watch};
pub use periodic::PeriodicError;
pub use points::{figure_points, reference_points, way_points};
pub use refuse::check_branch;
pub use settings::{
    BesideSettings, BranchMethod, BranchPointRule, BranchSettings, BranchStart, GrowthSettings, HeldModesSettings,
    ResonanceRule, SkipSettings, StabilityRule,
};

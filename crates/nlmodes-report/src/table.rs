//! Tables: what other programs read.

mod branch;
mod harmonics;
mod participation;
mod summary;

pub use branch::{BRANCH_COLUMNS, BranchWriter, write_branch};
pub use harmonics::write_harmonics;
pub use participation::write_participation;
pub use summary::write_summary;

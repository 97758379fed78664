//! Tables: what other programs read.

mod branch;
mod harmonics;
mod summary;

pub use branch::{BRANCH_COLUMNS, BranchWriter, write_branch};
pub use harmonics::write_harmonics;
pub use summary::write_summary;

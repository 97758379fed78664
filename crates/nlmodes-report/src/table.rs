//! Tables: what other programs read.

mod branch;
mod harmonics;
mod participation;
mod starts;
mod summary;

pub use branch::{BRANCH_COLUMNS, BranchWriter, write_branch};
pub use harmonics::write_harmonics;
pub use participation::write_participation;
pub use starts::write_starts;
pub use summary::write_summary;

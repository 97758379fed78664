//! Tables for other programs.

mod archive;
mod branch;
mod contacts;
mod harmonics;
mod hertz;
mod histories;
mod mat5;
mod matlab;
mod participation;
mod response;
mod starts;
mod summary;

pub use branch::{BRANCH_COLUMNS, BRANCH_MEANINGS, BranchWriter, write_branch};
pub use contacts::{CONTACT_COLUMNS, write_contacts};
pub use harmonics::{HARMONIC_ARRAYS, write_harmonics};
pub use hertz::hertz;
pub use histories::{HISTORY_ARRAYS, PointHistories, write_histories};
pub use matlab::{MATLAB_VARIABLES, write_matlab};
pub use participation::{PARTICIPATION_COLUMNS, write_participation};
pub use response::{APPROPRIATION_COLUMNS, RESPONSE_COLUMNS};
pub use starts::{START_ARRAYS, write_starts};
pub use summary::write_summary;

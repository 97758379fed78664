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
mod rows;
mod starts;
mod summary;
mod transient;

pub use branch::{BranchWriter, write_branch};
pub use contacts::write_contacts;
pub use harmonics::{HARMONIC_ARRAYS, write_harmonics};
pub use hertz::hertz;
pub use histories::{HISTORY_ARRAYS, PointHistories, write_histories};
pub use matlab::{MATLAB_VARIABLES, write_matlab};
pub use participation::write_participation;
pub use rows::{write_rows, write_rows_to};
pub use starts::{START_ARRAYS, write_starts};
pub use summary::write_summary;
pub use transient::{TRANSIENT_ARRAYS, TransientHistories, write_transient};

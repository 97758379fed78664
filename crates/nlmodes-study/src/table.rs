//! The table of a study: a row a case.

mod cells;
mod csv;
mod parquet;

pub use cells::{Cells, Column, Table};

/// Columns that every table has or may have.
pub const FIXED: [&str; 7] = ["case", "method", "harmonics", "points", "status", "reason", "id"];

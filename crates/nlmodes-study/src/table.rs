//! Columns of cells of any kind, and the files to which they are written. The columns of a study are in
//! `collect/table.rs`.

mod cells;
mod csv;
#[cfg(feature = "parquet")]
mod parquet;

pub use cells::{Cells, Column, Table};

/// Name of the column with the estimated error of interpolation.
pub fn error_column(quantity: &str) -> String {
    format!("{quantity}_error")
}

//! Columns of cells of any kind, and the files to which they are written. The columns of a study are in
//! `collect/table.rs`.

mod cells;
mod csv;
#[cfg(feature = "parquet")]
mod parquet;

pub use cells::{Cells, Column, Table};

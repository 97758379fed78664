//! Columns of cells, whatever they hold, and the files that they go to. Which columns a study has stands in
//! `collect/table.rs`.

mod cells;
mod csv;
mod parquet;

pub use cells::{Cells, Column, Table};

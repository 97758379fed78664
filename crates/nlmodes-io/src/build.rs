//! From a stream of entries to a compressed lower triangle.

mod columns;
mod entries;

pub(crate) use columns::{ColumnBuilder, Stored};
pub(crate) use entries::{EntryBuilder, Triangles};

use crate::error::{Problem, Result};

/// Most rows of a matrix: a row has to fit in 31 bits while the entries are sorted.
pub(crate) const MAX_ORDER: u64 = (1 << 31) - 1;

/// A pair of entries that do not belong in a symmetric matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Fault {
    /// The same entry a second time.
    Duplicate { row: usize, column: usize },
    /// An entry that differs from its mirror image.
    Asymmetric { row: usize, column: usize, value: f64, mirrored: f64 },
}

impl Fault {
    /// As a message, with rows named by `name`.
    pub(crate) fn problem(self, name: impl Fn(usize) -> String) -> Problem {
        match self {
            Self::Duplicate { row, column } => Problem::Duplicate { row: name(row), column: name(column) },
            Self::Asymmetric { row, column, value, mirrored } => {
                Problem::NotSymmetric { row: name(row), column: name(column), value, mirrored }
            }
        }
    }

    fn place(self) -> (usize, usize) {
        match self {
            Self::Duplicate { row, column } | Self::Asymmetric { row, column, .. } => (row, column),
        }
    }
}

/// Relative difference of mirror images that rounding explains, against `√|a_ii a_jj|` and against the entries
/// themselves.
const SYMMETRY: f64 = 1e-10;

fn mirrors(value: f64, mirrored: f64, diagonals: (f64, f64)) -> bool {
    let scale = (diagonals.0.abs().sqrt() * diagonals.1.abs().sqrt()).max(value.abs()).max(mirrored.abs());
    (value - mirrored).abs() <= SYMMETRY * scale
}

/// What one pass over a file gives.
pub(crate) enum Pass<M> {
    /// What is in it.
    Read(M),
    /// Entries that do not fit together, found when all were there.
    Faulty(Fault),
}

/// Reads a text file; if its entries are inconsistent, reads it again to find the line of the first inconsistent one.
pub(crate) fn with_lines_of_faults<M>(
    read: impl Fn(Option<Fault>) -> Result<Pass<M>>,
    unnamed: impl Fn(Fault) -> crate::ReadError,
) -> Result<M> {
    let fault = match read(None)? {
        Pass::Read(matrix) => return Ok(matrix),
        Pass::Faulty(fault) => fault,
    };
    match read(Some(fault))? {
        Pass::Read(matrix) => Ok(matrix),
        Pass::Faulty(fault) => Err(unnamed(fault)),
    }
}

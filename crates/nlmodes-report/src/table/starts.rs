use super::archive::{write_archive, write_array, write_numbers};
use crate::ReportError;
use crate::columns::Column;
use std::path::Path;

/// Arrays of `starts.npz`.
pub const START_ARRAYS: [Column; 2] = [
    Column::new("omega", "P, rad/s", "nonlinear modal frequency"),
    Column::new("displacement", "P × D, m or rad", "displacements at the instant at which all velocities are zero"),
];

/// Writes the initial states of exact motions that are even in time, as a NumPy archive.
///
/// | array | shape | type |
/// | --- | --- | --- |
/// | `omega` | points | float64, rad/s |
/// | `displacement` | points × coordinates | float64, m or rad; all velocities are zero |
///
/// # Errors
/// [`ReportError::Io`] if the file cannot be written.
pub fn write_starts(path: impl AsRef<Path>, omega: &[f64], displacement: &[Vec<f64>]) -> Result<(), ReportError> {
    write_archive(path.as_ref(), |archive| {
        write_numbers(archive, "omega", omega)?;
        let shape = [displacement.len(), displacement.first().map_or(0, Vec::len)];
        write_array(archive, "displacement", &shape, displacement.iter().flatten().copied())
    })
}

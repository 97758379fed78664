use super::archive::{write_array, write_numbers};
use crate::ReportError;
use crate::columns::Column;
use crate::output::replace_file;
use npyz::npz::NpzWriter;
use std::io;
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
    replace_file(path.as_ref(), |file| {
        let mut archive = NpzWriter::new(file);
        write_numbers(&mut archive, "omega", omega)?;
        let shape = [displacement.len(), displacement.first().map_or(0, Vec::len)];
        write_array(&mut archive, "displacement", &shape, displacement.iter().flatten().copied())?;
        archive.zip_writer().finish().map(drop).map_err(io::Error::from)
    })
}

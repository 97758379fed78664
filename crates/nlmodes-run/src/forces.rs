//! `appropriation.csv`: forces harmonic by harmonic, of computed appropriation and of tests with several controlled
//! harmonics.

use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::report::{APPROPRIATION_COLUMNS, write_file};
use num_complex::Complex64;

use crate::Failure;

/// Name of the table.
pub const FILE: &str = "appropriation.csv";

/// The forces of a drive point at a point.
pub struct Forces {
    /// Number of the point.
    pub point: usize,
    /// Angular frequency, rad/s.
    pub omega: f64,
    /// Number of the drive point.
    pub drive: usize,
    /// Complex amplitudes in the harmonics 1, 2 …, N.
    pub amplitudes: Vec<Complex64>,
}

/// Writes the table, if there are forces.
///
/// # Errors
/// If it cannot be written.
pub fn write(directory: &Path, rows: &[Forces]) -> Result<(), Failure> {
    if rows.is_empty() {
        return Ok(());
    }
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record(APPROPRIATION_COLUMNS.map(|column| column.name))?;
    for Forces { point, omega, drive, amplitudes } in rows {
        for (index, f) in amplitudes.iter().enumerate() {
            let numbers = [omega / TAU, f.norm(), f.arg().to_degrees()].map(|v| format!("{v:?}"));
            let [hertz, size, phase] = numbers;
            table.write_record([point.to_string(), hertz, drive.to_string(), (index + 1).to_string(), size, phase])?;
        }
    }
    let bytes = table.into_inner().map_err(|error| error.into_error())?;
    Ok(write_file(directory.join(FILE), &bytes)?)
}

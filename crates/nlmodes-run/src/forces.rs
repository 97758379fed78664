//! `appropriation.csv`: forces harmonic by harmonic, of computed appropriation and of tests with several controlled
//! harmonics.

use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::report::columns::{AppropriationRow, Row};
use nlmodes::report::write_rows;
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
    let row = |from: &Forces, (index, f): (usize, &Complex64)| AppropriationRow {
        point: from.point,
        frequency_hz: from.omega / TAU,
        drive: from.drive,
        harmonic: index + 1,
        force_n: f.norm(),
        phase_deg: f.arg().to_degrees(),
    };
    let rows = rows.iter().flat_map(|from| from.amplitudes.iter().enumerate().map(move |force| row(from, force)));
    Ok(write_rows(directory.join(FILE), &AppropriationRow::unknown(), rows)?)
}

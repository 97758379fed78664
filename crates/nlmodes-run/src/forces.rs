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

/// The forces of a drive point at a point of this angular frequency (rad/s): complex amplitudes in the harmonics 1,
/// 2 …, N.
pub fn rows(
    point: usize,
    omega: f64,
    drive: usize,
    amplitudes: &[Complex64],
) -> impl Iterator<Item = AppropriationRow> {
    amplitudes.iter().enumerate().map(move |(index, f)| AppropriationRow {
        point,
        frequency_hz: omega / TAU,
        drive,
        harmonic: index + 1,
        force_n: f.norm(),
        phase_deg: f.arg().to_degrees(),
    })
}

/// Writes the table, if there are forces.
///
/// # Errors
/// If it cannot be written.
pub fn write(directory: &Path, rows: Vec<AppropriationRow>) -> Result<(), Failure> {
    if rows.is_empty() {
        return Ok(());
    }
    Ok(write_rows(directory.join(FILE), &AppropriationRow::unknown(), rows)?)
}

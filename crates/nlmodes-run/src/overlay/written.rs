//! Differences as a file.

use std::io;
use std::path::Path;

use nlmodes::report::{ReportError, write_file};

use super::{Difference, Laid};

/// Writes the differences of all that is laid over, a row a point: `overlay`, `point`, `modal_amplitude`, `energy_j`, `frequency_hz`,
/// `branch_frequency_hz`, `relative_difference`, `peak_contact_force_n`, `branch_peak_contact_force_n`, `impulse_ns`, `branch_impulse_ns`, `motions`.
///
/// # Errors
/// [`ReportError::Io`] if the file cannot be written.
pub fn write(path: &Path, all: &[(Laid, Vec<Difference>)]) -> Result<(), ReportError> {
    let mut table = csv::Writer::from_writer(Vec::new());
    let failed = |source: csv::Error| ReportError::Io { path: path.to_path_buf(), source: source.into() };
    table.write_record(nlmodes::report::columns::DIFFERENCE_COLUMNS.map(|column| column.name)).map_err(failed)?;
    for (laid, found) in all {
        for difference in found {
            let number = |value: f64| format!("{value:?}");
            let values = [
                difference.amplitude,
                difference.energy,
                difference.frequency,
                difference.own_frequency,
                difference.relative(),
                difference.force,
                difference.own_force,
                difference.impulse,
                difference.own_impulse,
            ];
            let row = [laid.branch.label.clone(), difference.point.to_string()].into_iter().chain(values.map(number));
            let row = row.chain([difference.motions.to_string()]);
            table.write_record(row).map_err(failed)?;
        }
    }
    let bytes = table
        .into_inner()
        .map_err(|error| ReportError::Io { path: path.to_path_buf(), source: io::Error::other(error.to_string()) })?;
    write_file(path, &bytes)
}

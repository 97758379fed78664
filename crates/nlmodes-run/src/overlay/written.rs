//! Differences as files.

use std::io;
use std::path::Path;

use nlmodes::report::columns::{Column, DIFFERENCE_COLUMNS, STOP_DIFFERENCE_COLUMNS};
use nlmodes::report::{ReportError, write_file};

use super::said::relative;
use super::{Difference, Laid};

/// Writes the differences of all that is laid over, a row a point, with [`DIFFERENCE_COLUMNS`].
///
/// # Errors
/// [`ReportError::Io`] if the file cannot be written.
pub fn write<'a>(path: &Path, all: impl Iterator<Item = (&'a Laid, &'a [Difference])>) -> Result<(), ReportError> {
    let row = |laid: &Laid, difference: &Difference| {
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
        let first = [laid.branch.label.clone(), difference.point.to_string()];
        let row = first.into_iter().chain(values.map(|value| format!("{value:?}")));
        row.chain([difference.motions.to_string()]).collect()
    };
    let rows = all.flat_map(|(laid, found)| found.iter().map(move |difference| row(laid, difference)));
    table(path, &DIFFERENCE_COLUMNS, rows)
}

/// Writes the impulses of each stop where they are known, a row a point, stop and comparison, with
/// [`STOP_DIFFERENCE_COLUMNS`].
///
/// # Errors
/// [`ReportError::Io`] if the file cannot be written.
pub fn write_stops<'a>(
    path: &Path,
    all: impl Iterator<Item = (&'a Laid, &'a [Difference])>,
) -> Result<(), ReportError> {
    let row = |laid: &Laid, difference: &Difference, stop: usize| {
        let [impulse, own] = difference.stops[stop];
        let first = [laid.branch.label.clone(), difference.point.to_string(), stop.to_string()];
        let values = [difference.frequency, difference.own_frequency, impulse, own, 0.01 * relative(impulse, own)];
        let row = first.into_iter().chain([difference.equal.name().to_owned()]);
        let row = row.chain(values.map(|value| format!("{value:?}")));
        row.chain([difference.motions.to_string()]).collect()
    };
    let each = all.flat_map(|(laid, found)| found.iter().map(move |difference| (laid, difference)));
    let rows = each.flat_map(|(laid, difference)| (0..difference.stops.len()).map(move |k| row(laid, difference, k)));
    table(path, &STOP_DIFFERENCE_COLUMNS, rows)
}

fn table(path: &Path, columns: &[Column], rows: impl Iterator<Item = Vec<String>>) -> Result<(), ReportError> {
    let mut table = csv::Writer::from_writer(Vec::new());
    let failed = |source: csv::Error| ReportError::Io { path: path.to_path_buf(), source: source.into() };
    table.write_record(columns.iter().map(|column| column.name)).map_err(failed)?;
    for row in rows {
        table.write_record(row).map_err(failed)?;
    }
    let bytes = table
        .into_inner()
        .map_err(|error| ReportError::Io { path: path.to_path_buf(), source: io::Error::other(error.to_string()) })?;
    write_file(path, &bytes)
}

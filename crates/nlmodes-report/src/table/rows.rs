use std::io::{self, Write};
use std::path::Path;

use crate::ReportError;
use crate::columns::Cells;
use crate::output::replace_file;

/// Writes a table: the header of a row `like` those, which there need not be, and the rows. A file of that name is
/// replaced at once, never half.
///
/// # Errors
/// [`ReportError::Io`] if the file cannot be written.
pub fn write_rows<R: Cells>(
    path: impl AsRef<Path>,
    like: &R,
    rows: impl IntoIterator<Item = R>,
) -> Result<(), ReportError> {
    replace_file(path.as_ref(), |file| write_rows_to(file, like, rows))
}

/// The same to anything that takes bytes.
///
/// # Errors
/// What the latter reports.
pub fn write_rows_to<R: Cells>(to: impl Write, like: &R, rows: impl IntoIterator<Item = R>) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(to);
    table.write_record(like.header())?;
    rows.into_iter().try_for_each(|row| table.write_record(row.cells()))?;
    table.flush()
}

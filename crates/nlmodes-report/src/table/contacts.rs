use std::path::Path;

use super::rows::write_rows;
use crate::ReportError;
use crate::columns::{ContactRow, Row};
use nlmodes_modal::ModalBranch;

/// Writes what each contact does at each point as CSV, with the columns of [`ContactRow`].
///
/// # Errors
/// [`ReportError::Io`] if the file cannot be written.
pub fn write_contacts(path: impl AsRef<Path>, branch: &ModalBranch) -> Result<(), ReportError> {
    let rows = branch.points.iter().enumerate().flat_map(|(index, point)| ContactRow::of(index, point));
    write_rows(path, &ContactRow::unknown(), rows)
}

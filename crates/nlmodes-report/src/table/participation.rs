use std::path::Path;

use super::rows::write_rows;
use crate::ReportError;
use crate::columns::{Numbered, ParticipationRow, Row};
use nlmodes_modal::{ModalBranch, Participation};

/// Writes the participation of linear modes as CSV, a row a point, with the columns of [`ParticipationRow`].
///
/// # Errors
/// [`ReportError::SeriesLength`] if there are not as many as points, [`ReportError::Io`] if the file cannot be written.
pub fn write_participation(
    path: impl AsRef<Path>,
    branch: &ModalBranch,
    participation: &[Participation],
) -> Result<(), ReportError> {
    let (found, expected) = (participation.len(), branch.points.len());
    if found != expected {
        let label = branch.label.clone();
        return Err(ReportError::SeriesLength { label, series: "participation", found, expected });
    }
    let modes = participation.first().map_or(0, |p| p.factors.len());
    let none = || Numbered(vec![f64::NAN; modes]);
    let like = ParticipationRow {
        participation: none(),
        quadrature: none(),
        energy_share: none(),
        ..ParticipationRow::unknown()
    };
    let pairs = branch.points.iter().zip(participation).enumerate();
    write_rows(path, &like, pairs.map(|(index, (point, found))| ParticipationRow::of(index, point, found, modes)))
}

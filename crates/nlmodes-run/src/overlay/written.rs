//! Differences as files.

use std::path::Path;

use nlmodes::report::columns::{DifferenceRow, Row, StopDifferenceRow};
use nlmodes::report::{ReportError, write_rows};

use super::said::relative;
use super::{Difference, Laid};

/// Writes the differences of all that is laid over, a row a point, with the columns of [`DifferenceRow`].
///
/// # Errors
/// [`ReportError::Io`] if the file cannot be written.
pub fn write<'a>(path: &Path, all: impl Iterator<Item = (&'a Laid, &'a [Difference])>) -> Result<(), ReportError> {
    let row = |laid: &Laid, difference: &Difference| DifferenceRow {
        overlay: laid.branch.label.clone(),
        point: difference.point,
        modal_amplitude: difference.amplitude,
        energy_j: difference.energy,
        frequency_hz: difference.frequency,
        branch_frequency_hz: difference.own_frequency,
        relative_difference: difference.relative(),
        peak_contact_force_n: difference.force,
        branch_peak_contact_force_n: difference.own_force,
        impulse_ns: difference.impulse,
        branch_impulse_ns: difference.own_impulse,
        motions: difference.motions,
    };
    let rows = all.flat_map(|(laid, found)| found.iter().map(move |difference| row(laid, difference)));
    write_rows(path, &DifferenceRow::unknown(), rows)
}

/// Writes the impulses of each stop where they are known, a row a point, stop and comparison, with the columns of
/// [`StopDifferenceRow`].
///
/// # Errors
/// [`ReportError::Io`] if the file cannot be written.
pub fn write_stops<'a>(
    path: &Path,
    all: impl Iterator<Item = (&'a Laid, &'a [Difference])>,
) -> Result<(), ReportError> {
    let row = |laid: &Laid, difference: &Difference, (contact, [impulse, own]): (usize, [f64; 2])| StopDifferenceRow {
        overlay: laid.branch.label.clone(),
        point: difference.point,
        contact,
        equal: difference.equal.name().to_owned(),
        frequency_hz: difference.frequency,
        branch_frequency_hz: difference.own_frequency,
        impulse_ns: impulse,
        branch_impulse_ns: own,
        relative_difference: 0.01 * relative(impulse, own),
        motions: difference.motions,
    };
    let each = all.flat_map(|(laid, found)| found.iter().map(move |difference| (laid, difference)));
    let rows = each.flat_map(|(laid, difference)| {
        difference.stops.iter().copied().enumerate().map(move |stop| row(laid, difference, stop))
    });
    write_rows(path, &StopDifferenceRow::unknown(), rows)
}

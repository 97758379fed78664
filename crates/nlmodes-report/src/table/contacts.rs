use std::path::Path;

use super::hertz;
use crate::ReportError;
use crate::columns::Column;
use crate::output::replace_file;
use nlmodes_modal::{ContactPeriod, ModalBranch};

/// Columns of `contacts.csv`, in their order.
pub const CONTACT_COLUMNS: [Column; 9] = [
    Column::new("point", "", "number of the point, that of `branch.csv`"),
    Column::new("contact", "", "number of the stop, from 0 in the order of the scene"),
    Column::new("contact_fraction", "", "share of the period in which the contact is closed, 0 to 1"),
    Column::new(
        "peak_force_n",
        "N",
        "largest force, positive away from the stop; of short blows it need not converge with harmonics",
    ),
    Column::new("mean_force_n", "N", "force averaged over the period"),
    Column::new("impulse_ns", "N·s", "integral of the force over the period, which converges with harmonics"),
    Column::new("touches", "", "closed intervals a period"),
    Column::new(
        "approach_velocity_m_s",
        "m/s",
        "largest speed at which the gap closes as it is touched; 0 without a touch",
    ),
    Column::new(
        "frequency_hz",
        "Hz",
        "frequency of the motion, that of `branch.csv`; of one with twice the period of its load half of it",
    ),
];

/// Writes the quantities of each contact at each point as CSV: a header with the columns of `columns::FILES` and one
/// row per point and contact.
///
/// Numbers are the shortest that read back as the same double, frequencies have 15 digits. An existing file is replaced
/// atomically.
///
/// # Errors
/// [`ReportError::Io`] if the file cannot be written.
pub fn write_contacts(path: impl AsRef<Path>, branch: &ModalBranch) -> Result<(), ReportError> {
    replace_file(path.as_ref(), |file| {
        let mut table = csv::Writer::from_writer(file);
        table.write_record(CONTACT_COLUMNS.map(|column| column.name))?;
        for (index, point) in branch.points.iter().enumerate() {
            for (number, contact) in point.contacts.iter().enumerate() {
                table.write_record(row(index, number, contact, hertz(point.omega)))?;
            }
        }
        table.flush()
    })
}

fn row(point: usize, number: usize, contact: &ContactPeriod, frequency: f64) -> [String; CONTACT_COLUMNS.len()] {
    let text = |value: f64| format!("{value:?}");
    [
        point.to_string(),
        number.to_string(),
        text(contact.closed_share),
        text(contact.peak_force),
        text(contact.mean_force),
        text(contact.impulse),
        contact.touches.to_string(),
        text(contact.approach_velocity),
        text(frequency),
    ]
}

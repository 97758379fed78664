use std::path::Path;

use super::archive::{write_archive, write_array, write_integers, write_numbers};
use crate::ReportError;
use crate::columns::Column;
use nlmodes_modal::TimeHistory;

/// Arrays of `histories.npz`.
pub const HISTORY_ARRAYS: [Column; 7] = [
    Column::new("point", "P", "numbers of the points"),
    Column::new("stop_m", "C, m", "signed position of each stop along its direction"),
    Column::new(
        "time_s",
        "P × T, s",
        "instants of one period, ascending, both ends among them; where a contact closes or opens stand two, a \
            rounding apart, just before and just after",
    ),
    Column::new("displacement_m", "P × C × T, m", "displacement of the contact along its direction"),
    Column::new("velocity_m_s", "P × C × T, m/s", "its rate, which may jump where a contact closes or opens"),
    Column::new("acceleration_m_s2", "P × C × T, m/s²", "the rate of that between these instants"),
    Column::new("force_n", "P × C × T, N", "contact force, positive away from the stop, zero while it is open"),
];

/// Motion and force of all contacts over a period at some points of a branch, each with its number.
///
/// All histories have as many instants, and all points as many contacts.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PointHistories {
    /// Numbers of the points.
    pub points: Vec<usize>,
    /// The contacts of each.
    pub motions: Vec<Vec<TimeHistory>>,
}

/// One series of a history.
type Series = fn(&TimeHistory) -> &[f64];

/// Names of the arrays with points × contacts × instants.
pub(super) const SERIES: [(&str, Series); 4] = [
    ("displacement_m", |h| &h.displacement),
    ("velocity_m_s", |h| &h.velocity),
    ("acceleration_m_s2", |h| &h.acceleration),
    ("force_n", |h| &h.force),
];

impl PointHistories {
    /// Contacts and instants.
    ///
    /// # Errors
    /// [`ReportError::SeriesLength`] if a series has another length than the others.
    pub(super) fn shape(&self) -> Result<[usize; 2], ReportError> {
        let first = self.motions.first();
        let contacts = first.map_or(0, Vec::len);
        let instants = first.and_then(|motion| motion.first()).map_or(0, |history| history.time.len());
        for history in self.motions.iter().flatten() {
            let lengths = SERIES.iter().map(|(name, values)| (*name, values(history).len()));
            for (series, found) in lengths.chain([("time_s", history.time.len())]) {
                if found != instants {
                    let label = history.label.clone();
                    return Err(ReportError::SeriesLength { label, series, found, expected: instants });
                }
            }
        }
        if let Some(motion) = self.motions.iter().find(|motion| motion.len() != contacts) {
            let (series, found) = ("contacts", motion.len());
            return Err(ReportError::SeriesLength { label: "motion".into(), series, found, expected: contacts });
        }
        Ok([contacts, instants])
    }

    /// The instants of each point, one after the other.
    pub(super) fn times(&self) -> impl Iterator<Item = f64> {
        self.motions.iter().filter_map(|motion| motion.first()).flat_map(|history| history.time.iter().copied())
    }

    /// Positions of the stops.
    pub(super) fn stops(&self) -> Vec<f64> {
        self.motions.first().map_or_else(Vec::new, |motion| motion.iter().map(|history| history.stop).collect())
    }

    /// A series of each point and contact, one after the other.
    pub(super) fn series(&self, values: Series) -> impl Iterator<Item = f64> {
        self.motions.iter().flatten().flat_map(move |history| values(history).iter().copied())
    }
}

/// Writes histories of contacts as a NumPy archive with the arrays of `columns::FILES`.
///
/// # Errors
/// [`ReportError::SeriesLength`] if a history has another number of instants than the others, [`ReportError::Io`] if
/// the file cannot be written.
pub fn write_histories(path: impl AsRef<Path>, histories: &PointHistories) -> Result<(), ReportError> {
    let [contacts, instants] = histories.shape()?;
    let points = histories.points.len();
    write_archive(path.as_ref(), |archive| {
        write_integers(archive, "point", &histories.points)?;
        write_numbers(archive, "stop_m", &histories.stops())?;
        write_array(archive, "time_s", &[points, instants], histories.times())?;
        for (name, values) in SERIES {
            write_array(archive, name, &[points, contacts, instants], histories.series(values))?;
        }
        Ok(())
    })
}

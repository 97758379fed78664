use super::hertz;
use crate::ReportError;
use crate::columns::Column;
use crate::output::{replace_file, temporary_name};
use nlmodes_modal::{Event, ModalBranch, ModalPoint};
use std::fs::{self, File};
use std::io::{self, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Columns of `branch.csv`, in their order, with their meaning.
pub const BRANCH_MEANINGS: [Column; 19] = [
    Column::new("point", "", "number of the point, from 0"),
    Column::new("frequency_hz", "Hz", "nonlinear modal frequency, ω/2π"),
    Column::new("energy_j", "J", "averaged kinetic energy over a period, the path parameter"),
    Column::new("total_energy_j", "J", "kinetic and strain energy"),
    Column::new(
        "modal_amplitude",
        "m √kg",
        "nonlinear modal amplitude: norm of the fundamental, weighted by the mass matrix",
    ),
    Column::new("fundamental_m", "m", "real amplitude of the fundamental at stop 0, signed against its phase anchor"),
    Column::new(
        "peak_m",
        "m",
        "largest displacement at stop 0 toward it; of a stop that stands still while the base shakes, in space",
    ),
    Column::new("contact_fraction", "", "share of the period in which stop 0 is touched, 0 to 1"),
    Column::new("contact_intervals", "", "closed intervals a period, all stops together"),
    Column::new(
        "peak_contact_force_n",
        "N",
        "largest contact force of all stops; of short blows it need not converge with harmonics, `impulse_ns` does",
    ),
    Column::new("residual", "", "norm of the scaled residual"),
    Column::new(
        "event",
        "",
        "what happened here, names separated by spaces: grazing, start, fold, frequency-fold, branch-point, kink, contact-change, stability-change, period-doubling, neimark-sacker, tongue-foot, resumed, other-mode, harmonics, harmonics-unproven, harmonics-no-help, accuracy-limit",
    ),
    Column::new(
        "resonance",
        "",
        "internal resonance in which the motion takes part, `n:mode k`: harmonic n drives linear mode k",
    ),
    Column::new("stable", "", "whether small disturbances stay small; empty where it was not found out"),
    Column::new(
        "largest_multiplier",
        "",
        "magnitude of the largest Floquet multiplier; empty where it was not found out",
    ),
    Column::new("multiplier_angle_deg", "°", "its angle, 0 to 180; empty where the motion is stable"),
    Column::new("harmonics", "", "number of harmonics of this point"),
    Column::new(
        "error_estimate",
        "",
        "estimated relative error of the frequency at the same energy, where `method.accuracy` asks for one",
    ),
    Column::new("impulse_ns", "N·s", "integral of all contact forces over the period, which converges with harmonics"),
];

/// Names of the columns of `branch.csv`, in their order.
pub const BRANCH_COLUMNS: [&str; BRANCH_MEANINGS.len()] = {
    let mut names = [""; BRANCH_MEANINGS.len()];
    let mut k = 0;
    while k < names.len() {
        names[k] = BRANCH_MEANINGS[k].name;
        k += 1;
    }
    names
};

/// Writes a branch as CSV: a header with [`BRANCH_COLUMNS`] and one row per point.
///
/// Numbers are the shortest that read back as the same double, frequencies have 15 digits; events are joined by spaces.
/// The stability is empty if it was not computed, the angle of the multiplier if the motion is stable. An existing file
/// is replaced atomically.
///
/// # Errors
/// [`ReportError::Io`] if the file cannot be written.
pub fn write_branch(path: impl AsRef<Path>, branch: &ModalBranch) -> Result<(), ReportError> {
    replace_file(path.as_ref(), |file| {
        let mut table = csv::Writer::from_writer(file);
        table.write_record(BRANCH_COLUMNS)?;
        for (index, point) in branch.points.iter().enumerate() {
            table.write_record(row(index, point))?;
        }
        table.flush()
    })
}

/// Writes a branch as CSV while it is being computed, so that an interrupted run keeps its rows.
///
/// The file is that of [`write_branch`] after every [`BranchWriter::append`].
#[derive(Debug)]
pub struct BranchWriter {
    path: PathBuf,
    /// Temporary name of the file until it is shown.
    hidden: Option<PathBuf>,
    table: csv::Writer<File>,
    /// Length of the file before each point, and now.
    lengths: Vec<u64>,
}

impl BranchWriter {
    /// Creates the file, or empties it, and writes the header.
    ///
    /// # Errors
    /// [`ReportError::Io`] if the file cannot be written.
    pub fn create(path: impl AsRef<Path>) -> Result<Self, ReportError> {
        let path = path.as_ref();
        let file = File::create(path).map_err(ReportError::io(path))?;
        Self::new(path, None, file)
    }

    /// As [`create`](Self::create), under a temporary name: an existing file is kept until [`show`](Self::show).
    ///
    /// # Errors
    /// [`ReportError::Io`] if the file cannot be written.
    pub fn create_hidden(path: impl AsRef<Path>) -> Result<Self, ReportError> {
        let path = path.as_ref();
        let hidden = temporary_name(path);
        let file = File::create(&hidden).map_err(ReportError::io(path))?;
        Self::new(path, Some(hidden), file)
    }

    fn new(path: &Path, hidden: Option<PathBuf>, file: File) -> Result<Self, ReportError> {
        let table = csv::Writer::from_writer(file);
        let mut writer = Self { path: path.to_path_buf(), hidden, table, lengths: Vec::new() };
        writer.write(BRANCH_COLUMNS)?;
        Ok(writer)
    }

    /// Renames a hidden file to its final name.
    ///
    /// # Errors
    /// [`ReportError::Io`] if it cannot be renamed.
    pub fn show(&mut self) -> Result<(), ReportError> {
        let Some(hidden) = self.hidden.take() else { return Ok(()) };
        fs::rename(hidden, &self.path).map_err(ReportError::io(&self.path))
    }

    /// Appends a point, numbered by its index, and passes the row to the operating system.
    ///
    /// # Errors
    /// [`ReportError::Io`] if the file cannot be written.
    pub fn append(&mut self, point: &ModalPoint) -> Result<(), ReportError> {
        self.write(row(self.n_points(), point))
    }

    /// Keeps the first `count` points, and continues after them.
    ///
    /// # Errors
    /// [`ReportError::Io`] if the file cannot be shortened.
    pub fn truncate(&mut self, count: usize) -> Result<(), ReportError> {
        if count >= self.n_points() {
            return Ok(());
        }
        self.lengths.truncate(count + 1);
        let (length, mut file) = (self.lengths[count], self.table.get_ref());
        let cut = file.set_len(length).and_then(|()| file.seek(SeekFrom::Start(length)).map(drop));
        cut.map_err(ReportError::io(&self.path))
    }

    /// Number of points written so far.
    pub fn n_points(&self) -> usize {
        self.lengths.len().saturating_sub(1)
    }

    fn write<T: AsRef<[u8]>>(&mut self, record: impl IntoIterator<Item = T>) -> Result<(), ReportError> {
        let written = self.table.write_record(record).map_err(io::Error::from);
        let length = written
            .and_then(|()| self.table.flush())
            .and_then(|()| {
                let mut file = self.table.get_ref();
                file.stream_position()
            })
            .map_err(|error| {
                // An incomplete row does not count.
                let _ = self.table.get_ref().set_len(self.lengths.last().copied().unwrap_or(0));
                ReportError::io(&self.path)(error)
            })?;
        self.lengths.push(length);
        Ok(())
    }
}

fn row(index: usize, point: &ModalPoint) -> [String; BRANCH_COLUMNS.len()] {
    [
        index.to_string(),
        number(hertz(point.omega)),
        number(point.kinetic_energy),
        number(point.total_energy),
        number(point.modal_amplitude),
        number(point.fundamental),
        number(point.peak),
        number(point.contact_fraction),
        point.contact_intervals.to_string(),
        number(point.peak_contact_force),
        number(point.residual),
        Event::names(&point.events),
        point.resonance.map_or_else(String::new, |resonance| resonance.to_string()),
        point.stability.map_or_else(String::new, |s| s.stable.to_string()),
        point.stability.map_or_else(String::new, |s| number(s.magnitude())),
        point.stability.filter(|s| !s.stable).map_or_else(String::new, |s| number(s.angle_deg())),
        point.coefficients.n_harmonics().to_string(),
        point.error_estimate.map_or_else(String::new, number),
        point.impulse().map_or_else(String::new, number),
    ]
}

/// Shortest decimal that reads back as the same double, with an exponent where it is shorter (`1e-12`).
fn number(value: f64) -> String {
    format!("{value:?}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hidden_table_replaces_the_old_one_when_it_is_shown() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("branch.csv");
        fs::write(&path, "old").unwrap();
        let mut writer = BranchWriter::create_hidden(&path).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        writer.show().unwrap();
        writer.show().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), BRANCH_COLUMNS.join(",") + "\n");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}

use crate::ReportError;
use crate::output::replace_file;
use nlmodes_modal::{ModalBranch, ModalPoint};
use std::f64::consts::TAU;
use std::fs::File;
use std::io::{self, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Columns of `branch.csv`, in their order.
pub const BRANCH_COLUMNS: [&str; 18] = [
    "point",
    "frequency_hz",
    "energy_j",
    "total_energy_j",
    "modal_amplitude",
    "fundamental_m",
    "peak_m",
    "contact_fraction",
    "contact_intervals",
    "peak_contact_force_n",
    "residual",
    "event",
    "resonance",
    "stable",
    "largest_multiplier",
    "multiplier_angle_deg",
    "harmonics",
    "error_estimate",
];

/// Writes a branch as CSV: a header with [`BRANCH_COLUMNS`] and a row a point.
///
/// Numbers are the shortest that read back as the same double; events are joined by spaces. The stability is empty where it was not
/// found out, the angle of the multiplier where the motion is stable. A file of that name is
/// replaced at once, never half.
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

/// Writes a branch as CSV while it is being computed, so that a run which is cut off keeps its rows.
///
/// The file is that of [`write_branch`] after every [`BranchWriter::append`].
#[derive(Debug)]
pub struct BranchWriter {
    path: PathBuf,
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
        let mut writer = Self { path: path.to_path_buf(), table: csv::Writer::from_writer(file), lengths: Vec::new() };
        writer.write(BRANCH_COLUMNS)?;
        Ok(writer)
    }

    /// Appends a point, numbered by its place, and hands the row to the operating system.
    ///
    /// # Errors
    /// [`ReportError::Io`] if the file cannot be written.
    pub fn append(&mut self, point: &ModalPoint) -> Result<(), ReportError> {
        self.write(row(self.n_points(), point))
    }

    /// Keeps the first `count` points, and goes on behind them.
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
            .map_err(ReportError::io(&self.path))?;
        self.lengths.push(length);
        Ok(())
    }
}

fn row(index: usize, point: &ModalPoint) -> [String; BRANCH_COLUMNS.len()] {
    [
        index.to_string(),
        number(point.omega / TAU),
        number(point.kinetic_energy),
        number(point.total_energy),
        number(point.modal_amplitude),
        number(point.fundamental),
        number(point.peak),
        number(point.contact_fraction),
        point.contact_intervals.to_string(),
        number(point.peak_contact_force),
        number(point.residual),
        point.events.join(" "),
        point.resonance.map_or_else(String::new, |resonance| resonance.to_string()),
        point.stability.map_or_else(String::new, |s| s.stable.to_string()),
        point.stability.map_or_else(String::new, |s| number(s.magnitude())),
        point.stability.filter(|s| !s.stable).map_or_else(String::new, |s| number(s.angle_deg())),
        point.coefficients.n_harmonics().to_string(),
        point.error_estimate.map_or_else(String::new, number),
    ]
}

/// Shortest decimal that reads back as the same double, with an exponent where it is shorter (`1e-12`).
fn number(value: f64) -> String {
    format!("{value:?}")
}

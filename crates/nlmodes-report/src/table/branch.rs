use super::rows::write_rows;
use crate::ReportError;
use crate::columns::{BranchRow, Cells, GradientColumns, Row};
use crate::output::temporary_name;
use nlmodes_modal::{ModalBranch, ModalPoint};
use std::fs::{self, File};
use std::io::{self, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Writes a branch as CSV: a header with the columns of [`BranchRow`], and of [`GradientColumns`] where its points have
/// derivatives, and a row a point.
///
/// A file of that name is replaced at once, never half.
///
/// # Errors
/// [`ReportError::Io`] if the file cannot be written.
pub fn write_branch(path: impl AsRef<Path>, branch: &ModalBranch) -> Result<(), ReportError> {
    let gradients = GradientColumns::of(branch.points.iter());
    let rows = branch.points.iter().enumerate();
    let rows = rows.map(|(index, point)| (BranchRow::of(index, point), gradients.cells(point)));
    write_rows(path, &(BranchRow::unknown(), gradients.cells(&ModalPoint::default())), rows)
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
        writer.write(&BranchRow::unknown().header())?;
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
        self.write(&BranchRow::of(self.n_points(), point).cells())
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

    fn write(&mut self, record: &[String]) -> Result<(), ReportError> {
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
        assert_eq!(fs::read_to_string(&path).unwrap(), BranchRow::unknown().header().join(",") + "\n");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}

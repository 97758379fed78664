use std::fs::File;
use std::io::{BufReader, BufWriter, ErrorKind, Write};
use std::path::Path;

use crate::records::{
    ByteOrder, Channel, Record, RecordError, RecordTable, Storage, read_csv, read_npy, read_tdms, read_uff, read_wav,
    write_csv, write_npy, write_uff, write_wav,
};

/// Data of a recording in addition to its files.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recording {
    /// Channels to take from each file.
    pub channels: Vec<Channel>,
    /// Declared sampling rate, Hz.
    pub sample_rate: Option<f64>,
    /// Name of the time column of text tables.
    pub time_column: Option<String>,
}

impl Recording {
    /// Reads a record; the file extension determines the format: `.csv`, `.uff` or `.unv`, `.wav`, `.npy`, `.tdms`.
    ///
    /// # Errors
    /// [`RecordError`].
    pub fn read(&self, path: &Path) -> Result<Record, RecordError> {
        self.read_flagged(path, &[])
    }

    /// The same with columns that tell while a level is held, see [`RecordTable::into_flagged_record`].
    ///
    /// # Errors
    /// [`RecordError`].
    pub fn read_flagged(&self, path: &Path, flags: &[&str]) -> Result<Record, RecordError> {
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        self.read_table(path)?.into_flagged_record(&name, &self.channels, flags, self.sample_rate)
    }

    /// Whether there is such a file, of a kind that can be read; it is not read.
    ///
    /// # Errors
    /// [`RecordError::Extension`], [`RecordError::Io`].
    pub fn find(path: &Path) -> Result<(), RecordError> {
        Self::open(path).map(drop)
    }

    fn open(path: &Path) -> Result<File, RecordError> {
        let extension = extension(path);
        if !["csv", "uff", "unv", "wav", "npy", "tdms"].contains(&extension.as_str()) {
            return Err(RecordError::Extension { extension });
        }
        let io = |source| RecordError::Io { path: path.to_path_buf(), source };
        let file = File::open(path).map_err(io)?;
        // A directory can be opened on some systems, and not be read.
        if file.metadata().map_err(io)?.is_dir() { Err(io(ErrorKind::IsADirectory.into())) } else { Ok(file) }
    }

    fn read_table(&self, path: &Path) -> Result<RecordTable, RecordError> {
        let extension = extension(path);
        let io = |source| RecordError::Io { path: path.to_path_buf(), source };
        let file = BufReader::new(Self::open(path)?);
        let table = match extension.as_str() {
            "csv" => read_csv(file, self.time_column.as_deref()),
            "wav" => read_wav(file),
            "npy" => read_npy(file),
            "tdms" => read_tdms(file),
            _ => read_uff(file),
        };
        table.map_err(|error| match error {
            RecordError::Stream(source) => io(source),
            other => other,
        })
    }
}

/// Writes a record in SI units; the file extension determines the format. Universal Files are binary.
///
/// # Errors
/// [`RecordError`].
pub fn write_record(path: &Path, record: &Record) -> Result<(), RecordError> {
    let io = |source| RecordError::Io { path: path.to_path_buf(), source };
    let extension = extension(path);
    if !["csv", "uff", "unv", "wav", "npy"].contains(&extension.as_str()) {
        return Err(RecordError::Extension { extension });
    }
    let mut file = BufWriter::new(File::create(path).map_err(io)?);
    match extension.as_str() {
        "csv" => write_csv(&mut file, record, None),
        "wav" => write_wav(&mut file, record),
        "npy" => write_npy(&mut file, record),
        _ => write_uff(&mut file, record, Storage::Binary(ByteOrder::Little)),
    }?;
    file.flush().map_err(io)
}

fn extension(path: &Path) -> String {
    path.extension().map_or_else(String::new, |extension| extension.to_string_lossy().to_lowercase())
}

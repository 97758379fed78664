//! Why a study does not go on.

use std::io;
use std::path::{Path, PathBuf};

use nlmodes_run::RunError;
use thiserror::Error;

/// Why a study does not go on. What was computed until then stays.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why not.
        #[source]
        source: io::Error,
    },
    /// A case cannot be written: the next one could not either.
    #[error("{}: {source}", directory.display())]
    Case {
        /// Its directory.
        directory: PathBuf,
        /// Why not.
        #[source]
        source: Box<RunError>,
    },
    /// No case of the study is a scene.
    #[error("none of the {cases} cases is a sound scene: {reason}")]
    NoCase {
        /// How many there are.
        cases: usize,
        /// What is wrong with the first one.
        reason: String,
    },
    /// The table cannot be written as Parquet.
    #[error("{}: {source}", path.display())]
    Parquet {
        /// The file.
        path: PathBuf,
        /// Why not.
        #[source]
        source: parquet::errors::ParquetError,
    },
}

impl StudyError {
    /// An error of a file.
    pub(crate) fn io(path: &Path) -> impl FnOnce(io::Error) -> Self + use<> {
        let path = path.to_path_buf();
        move |source| Self::Io { path, source }
    }
}

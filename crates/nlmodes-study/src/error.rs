//! Why a study cannot continue.

use std::io;
use std::path::{Path, PathBuf};

use nlmodes_run::RunError;
use thiserror::Error;

/// Why a study cannot continue. Results computed so far remain.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The reason.
        #[source]
        source: io::Error,
    },
    /// A case cannot be written, nor could the next one.
    #[error("{}: {source}", directory.display())]
    Case {
        /// Its directory.
        directory: PathBuf,
        /// The reason.
        #[source]
        source: Box<RunError>,
    },
    /// No case of the study is a valid scene.
    #[error("none of the {cases} cases is a sound scene: {reason}")]
    NoCase {
        /// Number of cases.
        cases: usize,
        /// The error of the first one.
        reason: String,
    },
    /// The table cannot be written as Parquet.
    #[cfg(feature = "parquet")]
    #[error("{}: {source}", path.display())]
    Parquet {
        /// The file.
        path: PathBuf,
        /// The reason.
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

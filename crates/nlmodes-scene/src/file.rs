//! The text of a scene file.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use thiserror::Error;

use crate::Diagnostic;

/// Most bytes that a scene file may have.
const MAX_BYTES: u64 = 1 << 20;

/// Why there is no text to read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FileError {
    /// It is not there, or must not be read.
    #[error("the scene cannot be read: {0}")]
    Io(#[from] io::Error),
    /// It is a directory.
    #[error("the scene cannot be read: this is a directory, not a file")]
    Directory,
    /// It is not text.
    #[error("the scene is not UTF-8 text: line {line} has the byte 0x{byte:02X}")]
    NotText {
        /// Line, from 1.
        line: usize,
        /// The first byte that does not belong.
        byte: u8,
    },
    /// It is too long to be a scene.
    #[error("the scene is longer than {} bytes; is this the right file?", MAX_BYTES)]
    TooLong,
}

impl FileError {
    /// As a diagnostic of the scene of this name.
    pub fn diagnostic(&self, name: &str) -> Diagnostic {
        let diagnostic = Diagnostic::error(self.to_string());
        let with_ending = format!("{name}.toml");
        match self {
            Self::Io(_) | Self::Directory if Path::new(&with_ending).is_file() => {
                diagnostic.help(format!("`{with_ending}` is there"))
            }
            Self::Io(error) if error.kind() == io::ErrorKind::NotFound => {
                diagnostic.help("a path is taken from the directory where the program is started")
            }
            Self::NotText { .. } => diagnostic.help("save it as UTF-8 in the editor"),
            _ => diagnostic,
        }
    }
}

/// The text of the file.
///
/// # Errors
/// [`FileError`] if there is none.
pub fn read(path: &Path) -> Result<String, FileError> {
    if path.is_dir() {
        return Err(FileError::Directory);
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(FileError::TooLong);
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..at].iter().filter(|byte| **byte == b'\n').count();
        FileError::NotText { line, byte: error.as_bytes()[at] }
    })
}

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// A file that cannot be read as required: which one, where, and why.
#[derive(Debug, Error)]
#[error("{}{place}: {problem}", path.display())]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// Where in it.
    pub place: Place,
    /// What is wrong there.
    #[source]
    pub problem: Box<Problem>,
}

impl ReadError {
    pub(crate) fn new(path: &Path, place: Place, problem: Problem) -> Self {
        Self { path: path.to_owned(), place, problem: Box::new(problem) }
    }

    /// Something about the file as a whole.
    pub(crate) fn whole(path: &Path, problem: Problem) -> Self {
        Self::new(path, Place::File, problem)
    }
}

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of a text file, counted from 1.
    Line(u64),
    /// An entry of an array of a binary file, counted from 0.
    Entry {
        /// Name of the array.
        array: String,
        /// Index within it.
        index: u64,
    },
    /// A named part of a binary file.
    Part(String),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(f, ":{line}"),
            Self::Entry { array, index } => write!(f, ", entry {index} of `{array}`"),
            Self::Part(name) => write!(f, ", `{name}`"),
        }
    }
}

/// What is wrong with a file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Problem {
    /// It cannot be opened or read on.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// It does not exist, and has to be requested from the program.
    #[error("cannot be read: {error}; {writer}")]
    NotWritten {
        /// Message of the system.
        error: io::Error,
        /// Which program writes such files, and when.
        writer: &'static str,
    },
    /// Unexpected contents.
    #[error("found {found}; expected {expected}")]
    Expected {
        /// What belongs there.
        expected: String,
        /// What is there.
        found: String,
    },
    /// The file ends too early.
    #[error("the file ends here; expected {expected} (is it cut off?)")]
    Ended {
        /// What should have come.
        expected: String,
    },
    /// A number that is not finite, or too large for a floating-point number.
    #[error("the {what} `{found}` is not a finite number; expected a finite one")]
    NotFinite {
        /// The quantity.
        what: &'static str,
        /// As in the file.
        found: String,
    },
    /// One entry of a matrix is given twice.
    #[error(
        "entry ({row}, {column}) is there a second time; expected each entry once, those beside the diagonal as the \
            file's triangle has them"
    )]
    Duplicate {
        /// Its row, as the file counts or names rows.
        row: String,
        /// Its column.
        column: String,
    },
    /// A matrix that is stored in full is not symmetric.
    #[error(
        "entry ({row}, {column}) is {value:e} and ({column}, {row}) is {mirrored:e}; expected a symmetric matrix, both \
            triangles stored"
    )]
    NotSymmetric {
        /// Row of the entry.
        row: String,
        /// Column of the entry.
        column: String,
        /// The entry.
        value: f64,
        /// The entry with row and column exchanged.
        mirrored: f64,
    },
    /// Two numbers that have to agree do not.
    #[error("{what}: found {found}, expected {expected}")]
    Size {
        /// The quantity.
        what: String,
        /// What it should be.
        expected: u64,
        /// What it is.
        found: u64,
    },
    /// Larger than anything that is read.
    #[error("{what}: found {found}, expected at most {limit}")]
    TooLarge {
        /// The quantity.
        what: &'static str,
        /// Value in the file.
        found: u64,
        /// Most that is read.
        limit: u64,
    },
    /// A requested matrix, set or node does not exist.
    #[error("there is no {what} `{name}`; expected one of {}", list(known))]
    Missing {
        /// The kind of thing.
        what: &'static str,
        /// Its name.
        name: String,
        /// The names that are there.
        known: Vec<String>,
    },
    /// An ambiguous reference.
    #[error("found several {what}: {}; expected the name of one behind the file's, as in `{example}`", list(known))]
    Ambiguous {
        /// The kind of things.
        what: &'static str,
        /// Their names.
        known: Vec<String>,
        /// How one is named.
        example: String,
    },
    /// A row of the stiffness matrix that no structure has.
    #[error(
        "the stiffness of {dof} is {value:e}; expected a positive value on the diagonal (is the file cut off, or a \
            support missing?)"
    )]
    Diagonal {
        /// The degree of freedom.
        dof: String,
        /// The diagonal entry.
        value: f64,
    },
    /// Well-formed, but not what can be computed with.
    #[error("found {found}; expected {expected}: {reason}")]
    Refused {
        /// What is there.
        found: String,
        /// What would be read.
        expected: &'static str,
        /// Why.
        reason: &'static str,
    },
}

/// The first names of a list, quoted.
fn list(names: &[String]) -> String {
    const MOST: usize = 12;
    if names.is_empty() {
        return "none".into();
    }
    let mut text = names.iter().take(MOST).map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ");
    if names.len() > MOST {
        text.push_str(&format!(" and {} more", names.len() - MOST));
    }
    text
}

/// What a reader returns.
pub type Result<T> = std::result::Result<T, ReadError>;

/// Bytes of a file as they can be shown in a message.
pub(crate) fn shown(bytes: &[u8]) -> String {
    const MOST: usize = 60;
    if bytes.is_empty() {
        return "nothing".into();
    }
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(MOST)]);
    let text: String = text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    format!("`{text}{}`", if bytes.len() > MOST { "…" } else { "" })
}

//! Why nothing can be verified.

use std::error::Error;
use std::io;
use std::path::PathBuf;

use nlmodes::timestep::TimestepError;
use thiserror::Error as ThisError;

use crate::chain;
use crate::lcp::ProblemError;
use crate::sheet::SheetError;

/// Why there is nothing to verify or to follow, or it cannot be done.
#[derive(Debug, ThisError)]
#[non_exhaustive]
pub enum VerifyError {
    /// There is no such directory.
    #[error("there is no such directory")]
    NoDirectory,
    /// It is a file.
    #[error("this is a file; expected the directory that `nlmodes-cli run` has written")]
    File,
    /// Something that is needed is not there.
    #[error("there is no {name} here; expected a directory that `nlmodes-cli run` has written to its end")]
    Missing {
        /// Its name.
        name: &'static str,
    },
    /// The run has several branches, each in a folder.
    #[error("this run has several branches; give the folder of one, as {}", listed(folders))]
    SeveralBranches {
        /// Their folders.
        folders: Vec<PathBuf>,
    },
    /// The results are forced or damped motions, which are not kept up without load and damping.
    #[error("these are responses, whose points are verified by `verify_response`")]
    Responses,
    /// A file cannot be read.
    #[error("{} cannot be read", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: io::Error,
    },
    /// `summary.json` is none of this program.
    #[error("{} is not a summary of `nlmodes-cli run`", path.display())]
    NotASummary {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: serde_json::Error,
    },
    /// `harmonics.npz` lacks an array.
    #[error("harmonics.npz has no array `{name}`; expected the file that `nlmodes-cli run` writes")]
    NoArray {
        /// Its name.
        name: &'static str,
    },
    /// `harmonics.npz` cannot be read.
    #[error("harmonics.npz")]
    Archive(#[from] ProblemError),
    /// The files do not belong together.
    #[error("harmonics.npz does not belong to summary.json: {what} {found}, expected {expected}")]
    Foreign {
        /// What does not fit.
        what: &'static str,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// The branch has no such point.
    #[error("there is no point {point}: the branch has {}", count(*points))]
    NoSuchPoint {
        /// The requested number.
        point: usize,
        /// How many there are.
        points: usize,
    },
    /// A table cannot be read.
    #[error(transparent)]
    Table(#[from] SheetError),
    /// The results are of free motions.
    #[error(
        "these are nonlinear modes, without load and damping: nothing settles. Expected a directory of responses, \
        [response] with kind = \"frequency\", \"force\" or \"phase-resonance\""
    )]
    NoResponses,
    /// A point of another kind of curve.
    #[error(
        "point {point} is one of kind \"{kind}\", expected one of a response: \"frequency\", \"force\" or \
        \"phase-resonance\""
    )]
    NotForced {
        /// The point.
        point: usize,
        /// Its kind.
        kind: String,
    },
    /// A table has no such point.
    #[error("{}: there is no point {point}: the table has {points}", path.display())]
    NoSuchRow {
        /// The table.
        path: PathBuf,
        /// The point.
        point: usize,
        /// Rows of the table.
        points: usize,
    },
    /// A setting that is not a positive number.
    #[error("the {what}: {value}, expected a positive number")]
    NotPositive {
        /// The setting.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The structure of the summary cannot be built.
    #[error("the structure of summary.json cannot be built: {reason}")]
    Structure {
        /// Why.
        reason: String,
    },
    /// The motion cannot be integrated.
    #[error(transparent)]
    Integration(#[from] TimestepError),
}

impl VerifyError {
    /// That the structure cannot be built again, for this reason.
    pub(crate) fn structure(error: &(dyn Error + 'static)) -> Self {
        Self::Structure { reason: chain(error) }
    }
}

fn listed(folders: &[PathBuf]) -> String {
    folders.iter().map(|folder| folder.display().to_string()).collect::<Vec<_>>().join(", ")
}

fn count(points: usize) -> String {
    match points {
        0 => "no points".to_owned(),
        n => format!("the points 0 to {}", n - 1),
    }
}

use std::io;
use std::path::PathBuf;

use nlmodes::timestep::TimestepError;
use thiserror::Error;

use crate::lcp::error::ProblemError;

/// Why there is nothing to verify, or it cannot be done.
#[derive(Debug, Error)]
pub enum VerifyError {
    #[error("there is no such directory")]
    NoDirectory,
    #[error("there is no {name} here; expected a directory that `nlmodes-cli run` has written to its end")]
    Missing { name: &'static str },
    #[error("this run has several branches; give the folder of one, as {}", listed(folders))]
    SeveralBranches { folders: Vec<PathBuf> },
    #[error("{} cannot be read", path.display())]
    Read {
        path: PathBuf,
        #[source]
        source: io::Error,
    },
    #[error("{} is not a summary of `nlmodes-cli run`", path.display())]
    NotASummary {
        path: PathBuf,
        #[source]
        source: serde_json::Error,
    },
    #[error("harmonics.npz has no array `{name}`; expected the file that `nlmodes-cli run` writes")]
    NoArray { name: &'static str },
    #[error("harmonics.npz")]
    Archive(#[from] ProblemError),
    #[error("harmonics.npz does not belong to summary.json: {what} {found}, expected {expected}")]
    Foreign { what: &'static str, found: String, expected: String },
    #[error("there is no point {point}: the branch has {}", count(*points))]
    NoSuchPoint { point: usize, points: usize },
    #[error("the structure of summary.json cannot be built: {reason}")]
    Structure { reason: String },
    #[error(transparent)]
    Integration(#[from] TimestepError),
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

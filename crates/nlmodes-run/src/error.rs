//! Why there are no results.

use std::error::Error;
use std::path::PathBuf;

use nlmodes::report::ReportError;
use nlmodes_scene::SceneError;
use thiserror::Error as ThisError;

/// Any error, which may go to another thread.
pub type Failure = Box<dyn Error + Send + Sync>;

/// Why a run gives no results, or not all of them.
#[derive(Debug, ThisError)]
#[non_exhaustive]
pub enum RunError {
    /// The scene cannot be computed, at the key that it is about.
    #[error("{0}")]
    Scene(SceneError),
    /// The computation failed, at the key that it is about; another value may do, but the scene is not wrong.
    #[error("{0}")]
    Failed(SceneError),
    /// The end was requested before the first point.
    #[error("ended before any point was found: there are no results")]
    Ended,
    /// There is no scene to run.
    #[error("there is no scene to run")]
    NoScene,
    /// Another run is at work in the directory.
    #[error("another run is writing to {}", directory.display())]
    InUse {
        /// The output directory.
        directory: PathBuf,
    },
    /// The directory has the results of another or an unknown scene.
    #[error("{reason}")]
    Foreign {
        /// What is there, and how it differs.
        reason: String,
    },
    /// A result would be written through a symbolic link.
    #[error("{} is a symbolic link to {target}: results are not written through links", link.display())]
    Link {
        /// The link.
        link: PathBuf,
        /// Where it leads.
        target: String,
    },
    /// The results cannot be written.
    #[error("{}", chain(source))]
    Unwritable {
        /// The output directory.
        directory: PathBuf,
        /// Why not.
        #[source]
        source: ReportError,
        /// Whether the results found so far exist.
        kept: bool,
    },
    /// The record of a level, or its row, cannot be written.
    #[error("{reason}")]
    NotRecorded {
        /// The output directory, with the records so far.
        directory: PathBuf,
        /// Why not.
        reason: String,
    },
    /// Figures or summary cannot be created from the results.
    #[error("{}", chain(.0.as_ref()))]
    Files(Failure),
}

impl RunError {
    /// Whether scene or call are to be changed; the computation, disk or machine failed otherwise.
    pub fn is_of_the_call(&self) -> bool {
        match self {
            Self::Scene(_) | Self::NoScene => true,
            Self::InUse { .. } | Self::Foreign { .. } | Self::Link { .. } => true,
            Self::Ended | Self::Failed(_) | Self::Unwritable { .. } | Self::NotRecorded { .. } | Self::Files(_) => {
                false
            }
        }
    }
}

impl From<SceneError> for RunError {
    fn from(error: SceneError) -> Self {
        Self::Scene(error)
    }
}

/// The message of an error and of all its causes.
pub fn chain(error: &(dyn Error + 'static)) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(inner) = cause {
        // Some messages name their cause themselves.
        let said = inner.to_string();
        if !text.ends_with(&said) {
            text = format!("{text}: {said}");
        }
        cause = inner.source();
    }
    text
}

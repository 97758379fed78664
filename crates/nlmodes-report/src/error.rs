use std::io;
use std::path::{Path, PathBuf};

/// Why a table or a figure could not be created.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A file could not be written.
    #[error("cannot write {}: {source}", path.display())]
    Io {
        /// The file that was to be written.
        path: PathBuf,
        /// Message of the operating system.
        source: io::Error,
    },
    /// A summary could not be turned into JSON.
    #[error("cannot express {} as JSON: {source}", path.display())]
    Json {
        /// The file that was to be written.
        path: PathBuf,
        /// Message of the serialiser.
        source: serde_json::Error,
    },
    /// Contents of a page cannot be serialised.
    #[error("cannot show `{title}` on a page: {source}")]
    Unshowable {
        /// Its title.
        title: String,
        /// Message of the serialiser.
        source: serde_json::Error,
    },
    /// The coefficients of a point have a shape different from the others.
    #[error(
        "point {point} has coefficients of shape {} x {}, the branch needs {} x {} (coordinates x harmonics + 1)",
        found.0, found.1, expected.0, expected.1
    )]
    CoefficientShape {
        /// Index of the point.
        point: usize,
        /// Its coordinates and its harmonics + 1.
        found: (usize, usize),
        /// Coordinates of the branch and harmonics + 1 of its first point.
        expected: (usize, usize),
    },
    /// A requested point does not exist.
    #[error("there is no point {point}: the branch `{branch}` has {n_points}")]
    NoSuchPoint {
        /// Requested index.
        point: usize,
        /// Label of the branch.
        branch: String,
        /// Number of its points.
        n_points: usize,
    },
    /// There is no finite value that the axes of a figure could show.
    #[error("nothing to draw in the figure `{figure}`: {reason}")]
    NothingToDraw {
        /// The figure.
        figure: &'static str,
        /// What is missing.
        reason: &'static str,
    },
    /// A surface needs two positions along the structure.
    #[error("a surface needs two positions along the structure, found {found} of kind `{kind}`")]
    TooFewPositions {
        /// Kind of the coordinates.
        kind: String,
        /// Number of different positions, clamped ones included.
        found: usize,
    },
    /// A series of a time history is longer or shorter than its time.
    #[error("`{label}`: the {series} has {found} values, the time has {expected}")]
    SeriesLength {
        /// Label of the history.
        label: String,
        /// Name of the series.
        series: &'static str,
        /// Its length.
        found: usize,
        /// Length of the time.
        expected: usize,
    },
}

impl ReportError {
    /// Turns an input/output error into one that names the file.
    pub(crate) fn io(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_path_buf();
        move |source| Self::Io { path, source }
    }
}

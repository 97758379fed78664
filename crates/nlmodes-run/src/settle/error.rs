use std::path::PathBuf;

use nlmodes::timestep::TimestepError;
use thiserror::Error;

use crate::sheet::SheetError;
use crate::verify::VerifyError;

/// Why there is nothing to follow.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SettleError {
    /// The results cannot be read.
    #[error(transparent)]
    Results(#[from] VerifyError),
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
    /// There is no such point.
    #[error("{}: there is no point {point}: the table has {points}", path.display())]
    NoSuchPoint {
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
    /// The structure cannot be built again.
    #[error("the structure of summary.json cannot be built: {reason}")]
    Structure {
        /// Why.
        reason: String,
    },
    /// The motion cannot be integrated.
    #[error(transparent)]
    Integration(#[from] TimestepError),
}

use thiserror::Error;

use crate::CorrectionFailure;

/// Why there is no branch at all.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ContinuationError<E: std::error::Error + 'static> {
    /// Start, tangent or bound do not fit the system.
    #[error("{what} has {found} entries where {expected} were expected")]
    Dimension {
        /// The quantity.
        what: &'static str,
        /// Entries expected.
        expected: usize,
        /// Entries found.
        found: usize,
    },
    /// A setting cannot be used.
    #[error("{what} is {value}; {expected} was expected")]
    Setting {
        /// The setting.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What is permitted.
        expected: &'static str,
    },
    /// Newton's method did not reach the curve from the starting point.
    #[error("the starting point could not be corrected: {0}")]
    Start(CorrectionFailure),
    /// The starting point lies outside of the window within which the branch is wanted.
    #[error("coordinate {coordinate} of the starting point is {value}, outside of its bounds {min} to {max}")]
    OutsideBound {
        /// Index in `z`; n is the parameter.
        coordinate: usize,
        /// Where it starts.
        value: f64,
        /// Lower bound.
        min: f64,
        /// Upper bound.
        max: f64,
    },
    /// The residual cannot be evaluated at the starting point.
    #[error("the system cannot be evaluated at the starting point")]
    System(#[source] E),
}

use thiserror::Error;

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
    #[error("the starting point could not be corrected: {why} (residual {residual:e}, {iterations} iterations)")]
    Start {
        /// Residual reached.
        residual: f64,
        /// Iterations taken.
        iterations: usize,
        /// Why Newton's method was given up.
        why: &'static str,
    },
    /// The residual cannot be evaluated at the starting point.
    #[error("the system cannot be evaluated at the starting point")]
    System(#[source] E),
}

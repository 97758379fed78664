use thiserror::Error;

/// Errors of factorisations and eigenproblems.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum LinalgError {
    /// The number of rows, columns or right-hand sides is wrong.
    #[error("{what}: {found} where {expected} was expected")]
    Dimension {
        /// The quantity whose size is wrong.
        what: &'static str,
        /// The required size.
        expected: usize,
        /// The actual size.
        found: usize,
    },
    /// An entry is NaN or infinite.
    #[error("{what} contains a value that is not finite")]
    NotFinite {
        /// The matrix or vector.
        what: &'static str,
    },
    /// A pivot vanished: the matrix is singular to working precision.
    #[error("the {what} is singular: pivot {pivot:e} in column {column}")]
    Singular {
        /// The matrix.
        what: &'static str,
        /// The column at which the factorisation stopped.
        column: usize,
        /// The pivot found there.
        pivot: f64,
    },
    /// A Cholesky factorisation met a pivot that is not positive.
    #[error("the {what} is not positive definite (found at column {column})")]
    NotPositiveDefinite {
        /// The matrix.
        what: &'static str,
        /// The column at which the factorisation stopped.
        column: usize,
    },
    /// A matrix that must be symmetric is not.
    #[error("the {what} is not symmetric: {value:e} at ({row}, {column}), {mirrored:e} at ({column}, {row})")]
    NotSymmetric {
        /// The matrix.
        what: &'static str,
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The entry.
        value: f64,
        /// The entry with row and column exchanged.
        mirrored: f64,
    },
    /// A pencil of which both matrices vanish in some motions: no shift makes it definite.
    #[error("neither the stiffness nor the mass matrix feels {motions} motions")]
    NeitherStiffnessNorMass {
        /// Number of these motions.
        motions: usize,
    },
    /// The memory for a matrix or a factorisation could not be allocated.
    #[error("not enough memory for the {what}")]
    OutOfMemory {
        /// The matrix.
        what: &'static str,
    },
    /// The iteration for the lowest modes ended before all were found.
    #[error("{converged} of {wanted} modes converged after {iterations} iterations")]
    ModesNotConverged {
        /// Modes requested.
        wanted: usize,
        /// Modes found.
        converged: usize,
        /// Lanczos vectors made.
        iterations: usize,
    },
}

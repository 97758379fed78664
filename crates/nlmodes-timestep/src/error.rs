use nlmodes_contact::LcpError;
use nlmodes_linalg::LinalgError;
use nlmodes_model::ModelError;
use nlmodes_reduction::ReductionError;
use thiserror::Error;

/// Why a motion cannot be integrated or a periodic one not be found.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum TimestepError {
    /// More degrees of freedom than dense matrices are sensible for.
    #[error(
        "{found} degrees of freedom: exact integration keeps all modes of each set of closed contacts and takes at most {most}"
    )]
    TooLarge {
        /// Degrees of freedom of the structure.
        found: usize,
        /// Most that are accepted.
        most: usize,
    },
    /// More modes than shooting is sensible for.
    #[error(
        "shooting with {found} modes: at most {most} are sensible, since a point costs their number to the third power"
    )]
    TooManyModes {
        /// Modes kept.
        found: usize,
        /// Most that are accepted.
        most: usize,
    },
    /// A vector does not belong to this structure.
    #[error("{what}: {found} where {expected} was expected")]
    Dimension {
        /// The quantity whose size is wrong.
        what: &'static str,
        /// The size that it should have.
        expected: usize,
        /// The size that it has.
        found: usize,
    },
    /// A state or a coefficient is NaN or infinite.
    #[error("the {what} contains a value that is not finite")]
    NotFinite {
        /// The quantity.
        what: &'static str,
    },
    /// More changes of contact than a trajectory may have.
    #[error("more than {most} changes of contact up to {time:e} s")]
    TooManyContacts {
        /// When, s.
        time: f64,
        /// Most that are kept.
        most: usize,
    },
    /// A period, frequency or energy is not a positive number.
    #[error("{what} is {value:e}; a positive number was expected")]
    NotPositive {
        /// The quantity, with its unit.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The linear mode does not lead to a first touch.
    #[error("linear mode {mode} has no amplitude of first touch: {why}")]
    NoGrazing {
        /// The mode, from 1.
        mode: usize,
        /// The reason.
        why: &'static str,
    },
    /// Contacts switch without time going on.
    #[error("the contacts switch {switches} times at {time:e} s without time going on")]
    Chatter {
        /// When, s.
        time: f64,
        /// How often.
        switches: usize,
    },
    /// Whoever was asked did not want it to go on.
    #[error("it was asked to end")]
    Ended,
    /// Newton's method found no periodic motion.
    #[error("no periodic motion was found: residual {residual:.1e} after {iterations} iterations")]
    NotConverged {
        /// Largest entry of the scaled residual.
        residual: f64,
        /// Newton iterations.
        iterations: usize,
    },
    /// The samples of a period cannot carry the harmonics.
    #[error("{harmonics} harmonics need at least {needed} samples a period, not {samples}")]
    Samples {
        /// Harmonics asked for.
        harmonics: usize,
        /// Samples asked for.
        samples: usize,
        /// Fewest samples.
        needed: usize,
    },
    /// The structure or its modes.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The contact problem.
    #[error("contact problem")]
    Contact(#[from] LcpError),
    /// The reduction to few modes.
    #[error("the reduction to few modes")]
    Reduction(#[source] ReductionError),
    /// A factorisation or an eigenproblem.
    #[error("{what}")]
    Linalg {
        /// What it was for.
        what: &'static str,
        /// The reason.
        #[source]
        source: LinalgError,
    },
}

impl TimestepError {
    /// An error of the linear algebra, with what it was for.
    pub(crate) fn during(what: &'static str) -> impl Fn(LinalgError) -> Self {
        move |source| Self::Linalg { what, source }
    }
}

impl From<ReductionError> for TimestepError {
    fn from(error: ReductionError) -> Self {
        match error {
            ReductionError::Model(error) => Self::Model(error),
            ReductionError::Linalg { what, source } => Self::Linalg { what, source },
            other => Self::Reduction(other),
        }
    }
}

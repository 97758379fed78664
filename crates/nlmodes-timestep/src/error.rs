use nlmodes_contact::LcpError;
use nlmodes_linalg::LinalgError;
use nlmodes_model::ModelError;
use nlmodes_model::reduction::ReductionError;
use thiserror::Error;

/// Why a motion cannot be integrated or a periodic one cannot be found.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum TimestepError {
    /// Too many degrees of freedom for dense matrices.
    #[error(
        "{found} degrees of freedom: exact integration keeps all modes of each set of closed contacts and takes at \
         most {most}"
    )]
    TooLarge {
        /// Degrees of freedom of the structure.
        found: usize,
        /// Maximum.
        most: usize,
    },
    /// Too many modes for shooting.
    #[error(
        "shooting with {found} modes: at most {most} are sensible, since a point costs their number to the third power"
    )]
    TooManyModes {
        /// Number of modes kept.
        found: usize,
        /// Maximum.
        most: usize,
    },
    /// A vector does not fit this structure.
    #[error("{what}: {found} where {expected} was expected")]
    Dimension {
        /// The quantity whose size is wrong.
        what: &'static str,
        /// The required size.
        expected: usize,
        /// The actual size.
        found: usize,
    },
    /// A state or a coefficient is NaN or infinite.
    #[error("the {what} contains a value that is not finite")]
    NotFinite {
        /// The quantity.
        what: &'static str,
    },
    /// A law of force that is not fulfilled within a step, however short.
    #[error(
        "the forces of the laws are not found at {time:e} s with steps of {step:e} s: a law jumps there, or falls too \
        fast"
    )]
    LawStep {
        /// Time, s.
        time: f64,
        /// Length of the step, s.
        step: f64,
    },
    /// Too many contact changes for a trajectory.
    #[error("more than {most} changes of contact up to {time:e} s")]
    TooManyContacts {
        /// Time, s.
        time: f64,
        /// Maximum.
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
    /// The linear mode does not graze.
    #[error("linear mode {mode} has no amplitude of first touch: {why}")]
    NoGrazing {
        /// The mode, from 1.
        mode: usize,
        /// The reason.
        why: &'static str,
    },
    /// A contact touches at rest without force: no amplitude is linear.
    #[error("a stop touches at rest: no amplitude of the linear mode at {omega:e} rad/s leaves it alone")]
    TouchesAtRest {
        /// Angular frequency of the linear mode, rad/s.
        omega: f64,
    },
    /// Contacts switch without progress in time.
    #[error("the contacts switch {switches} times at {time:e} s without time going on")]
    Chatter {
        /// Time, s.
        time: f64,
        /// Number of times.
        switches: usize,
    },
    /// The computation was cancelled.
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
        /// Its purpose.
        what: &'static str,
        /// The reason.
        #[source]
        source: LinalgError,
    },
}

impl TimestepError {
    /// An error of linear algebra, with the purpose of the computation.
    pub(crate) fn during(what: &'static str) -> impl Fn(LinalgError) -> Self {
        move |source| Self::Linalg { what, source }
    }
}

/// That there are as many of something as expected.
pub(crate) fn agrees(what: &'static str, expected: usize, found: usize) -> Result<(), TimestepError> {
    if found == expected { Ok(()) } else { Err(TimestepError::Dimension { what, expected, found }) }
}

/// That there are as many values as expected, all finite.
pub(crate) fn fits(what: &'static str, expected: usize, values: &[f64]) -> Result<(), TimestepError> {
    agrees(what, expected, values.len())?;
    if values.iter().all(|v| v.is_finite()) { Ok(()) } else { Err(TimestepError::NotFinite { what }) }
}

/// A number that has to be positive.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<f64, TimestepError> {
    if value.is_finite() && value > 0.0 { Ok(value) } else { Err(TimestepError::NotPositive { what, value }) }
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

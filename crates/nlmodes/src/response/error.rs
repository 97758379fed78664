use nlmodes_continuation::ContinuationError;
use nlmodes_hbm::HbmError;
use nlmodes_linalg::rounded;
use nlmodes_model::reduction::ReductionError;
use nlmodes_timestep::TimestepError;
use thiserror::Error;

/// Why a response cannot be computed at all; a curve that ends early is not an error.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ResponseError {
    /// A setting makes no sense.
    #[error("{what} is {value}; expected {expected}")]
    Setting {
        /// The setting.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What is expected.
        expected: &'static str,
    },
    /// Entries of matrices beside something that depends on them in another way than the structure does.
    #[error("by entries of stiffness and mass nothing is differentiated beside {what}")]
    DirectionBeside {
        /// What it is.
        what: &'static str,
    },
    /// A degree of freedom does not exist.
    #[error("there is no degree of freedom {found}: the structure has {available}")]
    NoSuchDof {
        /// The number.
        found: usize,
        /// How many there are.
        available: usize,
    },
    /// There is nothing that drives the structure.
    #[error("a forced response needs a force or a base motion that moves the structure")]
    NoLoad,
    /// Phase resonance needs a drive point.
    #[error("phase resonance needs a drive point")]
    NoDrive,
    /// No frequency near the mode has the lag.
    #[error("the drive point lags the load by {lag_deg} degrees nowhere near the mode at {} Hz", hz(omega))]
    NoPhaseResonance {
        /// The lag, degrees.
        lag_deg: f64,
        /// Frequency of the mode, rad/s.
        omega: f64,
    },
    /// The curve begins outside of the window of frequencies.
    #[error(
        "the curve begins at {} Hz, outside of the window {} to {} Hz; expected a window that holds its beginning",
        hz(omega), hz(&window[0]), hz(&window[1])
    )]
    OutsideWindow {
        /// Frequency of the load, or of the mode, at which it begins, rad/s.
        omega: f64,
        /// The window, rad/s.
        window: [f64; 2],
    },
    /// The level could not be reached at the end of the window from rest.
    #[error(
        "at {} Hz the level {level} could not be reached from rest: the curve over the level ends at {reached:.3e} \
         ({why})",
        hz(omega)
    )]
    NoStart {
        /// Frequency of the load, rad/s.
        omega: f64,
        /// Level.
        level: f64,
        /// Level reached.
        reached: f64,
        /// Why it went no further.
        why: String,
    },
    /// A response before contacts that touch at rest is not reached as gaps are closed.
    #[error(
        "at {} Hz and level {}: with the contacts that touch at rest set back there is a response, but as they \
        are closed the way to it ends at a gap of {} m: {why}",
        hz(omega), rounded(*level, 6), rounded(*left, 3)
    )]
    NoStartTouching {
        /// Frequency of the load, rad/s.
        omega: f64,
        /// Level.
        level: f64,
        /// Gap that was left, m.
        left: f64,
        /// Why it went no further.
        why: String,
    },
    /// A mode or phase resonance before contacts that touch at rest is not reached as gaps are closed.
    #[error(
        "the mode begins before the contacts that touch at rest set back, but as they are closed the way to it ends at \
        a gap of {} m: {why}. Contacts that are elastic, or that are set back a little, lead on",
        rounded(*left, 3)
    )]
    NoModeTouching {
        /// Gap that was left, m.
        left: f64,
        /// Why it went no further.
        why: String,
    },
    /// With a parameter the retained modes become others.
    #[error(
        "within the step of the gradient the retained modes become others (they have {share:.2} in common); expected \
         another `reduction.modes`, one that ends between two frequencies that stay apart"
    )]
    OtherModes {
        /// Least cosine between the spaces of both.
        share: f64,
    },
    /// The structure at another value of a parameter has another number of modes.
    #[error("at another value of the parameter the structure has {found} modes in place of {expected}")]
    ModesOfGradient {
        /// Those of the structure.
        expected: usize,
        /// Those beside it.
        found: usize,
    },
    /// The structure at another value of a parameter has other degrees of freedom.
    #[error("at another value of the parameter the mesh is another one: a node is put beside one that stays")]
    MeshOfGradient,
    /// The structure at a value of a parameter.
    #[error("with the parameter at {}: {why}", rounded(*value, 9))]
    AtValue {
        /// The value.
        value: f64,
        /// Why it is not there.
        why: String,
    },
    /// The curve over a parameter.
    #[error("the curve over the parameter: {why}")]
    OverParameter {
        /// Why there is none.
        why: String,
    },
    /// The end was requested before the first point.
    #[error("it was asked to end before there was a point")]
    Stopped,
    /// The periodic problem.
    #[error("the periodic problem")]
    Problem(#[from] HbmError),
    /// The reduction.
    #[error("the reduced structure")]
    Reduction(#[from] ReductionError),
    /// The structure in time.
    #[error("the structure in time")]
    Integration(#[from] TimestepError),
    /// The continuation.
    #[error("the curve")]
    Continuation(#[from] ContinuationError<HbmError>),
}

/// That a setting is a finite number for which something holds.
pub(crate) fn holds(
    what: &'static str,
    value: f64,
    expected: &'static str,
    is_fine: impl FnOnce(f64) -> bool,
) -> Result<(), ResponseError> {
    let is_fine = value.is_finite() && is_fine(value);
    if is_fine { Ok(()) } else { Err(ResponseError::Setting { what, value, expected }) }
}

/// That it is positive.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<(), ResponseError> {
    holds(what, value, "a positive number", |value| value > 0.0)
}

/// A frequency in Hz, to nine digits.
fn hz(omega: &f64) -> f64 {
    rounded(omega / std::f64::consts::TAU, 9)
}

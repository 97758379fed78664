use nlmodes_contact::LcpError;
use nlmodes_continuation::ContinuationError;
use nlmodes_hbm::HbmError;
use nlmodes_timestep::TimestepError;
use thiserror::Error;

use super::{Ended, PeriodicError};

/// Why there is no branch.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum BranchError {
    /// The contact solver.
    #[error("the contact solver")]
    Contact(#[from] LcpError),
    /// The periodic problem.
    #[error(transparent)]
    Hbm(#[from] HbmError),
    /// Exact integration.
    #[error(transparent)]
    Timestep(#[from] TimestepError),
    /// The continuation.
    #[error(transparent)]
    Continuation(#[from] ContinuationError<PeriodicError>),
    /// It was asked to end before there was any point.
    #[error("no point was found before the computation was asked to end")]
    Ended(#[from] Ended),
    /// Shooting was asked for with a setting that it does not have.
    #[error("shooting finds motions that are even in time; others need harmonic balance")]
    NotEven,
    /// What was asked for exists for harmonic balance only.
    #[error(
        "the unknowns of this branch are not harmonics of its contacts: it is by shooting, or in free-interface modes"
    )]
    NotHarmonic,
    /// The backbone does not lead to the starting frequency.
    #[error("no point of the backbone was found at {hz:.6} Hz: {reason}")]
    NoStart {
        /// The frequency asked for, Hz.
        hz: f64,
        /// How far it leads.
        reason: String,
    },
    /// The backbone does not lead to the starting energy.
    #[error("no point of the backbone was found at {ratio} times the energy at grazing: {reason}")]
    NoStartAtEnergy {
        /// The energy asked for, over that at grazing.
        ratio: f64,
        /// How far it leads.
        reason: String,
    },
    /// The way to motions before contacts that touch at rest is lost.
    #[error("contacts touch at rest, and no motion before them was found: {reason}")]
    NoStartTouching {
        /// Where the way ends.
        reason: String,
    },
    /// The branch would begin outside of the frequency window.
    #[error("the branch starts at {start_hz:.6} Hz, outside of the frequency window {low_hz} to {high_hz} Hz")]
    StartOutsideWindow {
        /// Frequency of the linear mode, Hz.
        start_hz: f64,
        /// Lower end of the window, Hz.
        low_hz: f64,
        /// Upper end of the window, Hz.
        high_hz: f64,
    },
}

impl From<PeriodicError> for BranchError {
    fn from(error: PeriodicError) -> Self {
        match error {
            PeriodicError::Harmonics(error) => Self::Hbm(error),
            PeriodicError::Exact(error) => Self::Timestep(error),
            PeriodicError::Ended(ended) => Self::Ended(ended),
        }
    }
}

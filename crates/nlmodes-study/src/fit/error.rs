//! Why variables cannot be fitted.

use nlmodes::linalg::LinalgError;
use thiserror::Error;

use crate::error::StudyError;
use crate::study::Study;

/// Why variables cannot be fitted.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FitError {
    /// The study has no measured points.
    #[error("the study has no table [fit] with measured points")]
    NothingMeasured,
    /// There are fewer numbers than variables.
    #[error("{parameters} variables cannot be found from {points} measured numbers")]
    Few {
        /// Numbers.
        points: usize,
        /// Variables.
        parameters: usize,
    },
    /// The curve of the start does not have a measured point, or there is none.
    #[error("the curve with the values at the start cannot be compared: {reason}")]
    Start {
        /// Why not.
        reason: String,
    },
    /// Different values give the same points.
    #[error("the points cannot tell the variables apart: they stay as they are where {change}")]
    Indistinct {
        /// The change of the variables.
        change: String,
    },
    /// No step brings the curve closer.
    #[error(
        "after {iterations} steps no further one brings the curve closer, though one of {step:.1e} of the start is left"
    )]
    NotConverged {
        /// Steps taken.
        iterations: usize,
        /// Largest change of a variable that is left, over its value at the start.
        step: f64,
    },
    /// The end was requested.
    #[error("the fit was ended; the same call goes on from the cases that are there")]
    Ended,
    /// The linear algebra.
    #[error("the normal equations")]
    Linalg(#[source] LinalgError),
    /// A case cannot be written.
    #[error(transparent)]
    Study(#[from] StudyError),
}

impl FitError {
    /// Of a change of the variables, over their values at the start, that changes nothing.
    pub(super) fn indistinct(study: &Study, along: &[f64]) -> Self {
        let largest = along.iter().fold(0.0_f64, |most, share| most.max(share.abs()));
        let named = study.variables.iter().zip(along).filter(|(_, share)| share.abs() > 0.05 * largest);
        let change: Vec<String> =
            named.map(|(variable, share)| format!("{} changes by {:+.2} %", variable.name, share / largest)).collect();
        Self::Indistinct { change: change.join(" and ") }
    }
}

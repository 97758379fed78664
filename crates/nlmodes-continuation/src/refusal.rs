use thiserror::Error;

/// Why Newton's method was given up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum NewtonFailure {
    /// The system cannot be evaluated there.
    #[error("the system has no residual")]
    NoResidual,
    /// An entry of the residual is infinite or not a number.
    #[error("the residual is not finite")]
    NotFinite,
    /// The Jacobian with the row of the surface below it has no inverse.
    #[error("the bordered Jacobian is singular")]
    Singular,
    /// No share of the Newton step that was tried lowers the residual.
    #[error("Newton's method does not lower the residual")]
    NoDescent,
    /// The point still moves after the last iteration that is permitted.
    #[error("Newton's method took too many iterations")]
    TooManyIterations,
}

/// A correction that was given up, and how far it came.
#[derive(Debug, Clone, PartialEq, Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[error(
    "{reason} (residual {residual:.1e} after {iterations} iterations; tolerance {tolerance:.1e}, \
     rounding {rounding:.1e}{})",
    unsettled(*residual, *tolerance, *moves)
)]
#[non_exhaustive]
pub struct CorrectionFailure {
    /// Why it was given up.
    pub reason: NewtonFailure,
    /// Largest entry of the residual that was reached.
    #[cfg_attr(feature = "serde", serde(with = "crate::record::any_number"))]
    pub residual: f64,
    /// Residual that was asked for.
    pub tolerance: f64,
    /// Rounding of the residual, as far as it is known.
    pub rounding: f64,
    /// Newton steps taken.
    pub iterations: usize,
    /// Length of the Newton step that is left, over the sizes of the unknowns; infinite where there was none.
    #[cfg_attr(feature = "serde", serde(default = "unknown", with = "crate::record::any_number"))]
    pub moves: f64,
}

/// Why a residual within the tolerance is not enough.
fn unsettled(residual: f64, tolerance: f64, moves: f64) -> String {
    if residual <= tolerance && moves.is_finite() {
        format!(
            "; within the tolerance, but the next Newton step is one of {moves:.1e}: \
             the curve bends more sharply than that"
        )
    } else {
        String::new()
    }
}

#[cfg(feature = "serde")]
fn unknown() -> f64 {
    f64::INFINITY
}

/// Why a step is not shown to stay on the branch.
#[derive(Debug, Clone, PartialEq, Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Refusal {
    /// Its end was not found.
    #[error("{0}")]
    End(CorrectionFailure),
    /// The point at half the step, which is to confirm it, was not found.
    #[error("at half the step, {0}")]
    Middle(CorrectionFailure),
    /// The corrected point is far from the predicted one.
    #[error("the corrected point lies {steps:.2} steps from the predicted one")]
    FarFromPrediction {
        /// Distance over the length of the step.
        steps: f64,
    },
    /// The tangent turns too much.
    #[error("the tangent turns by {:.0} degrees", radians.to_degrees())]
    Turn {
        /// Turn, rad.
        radians: f64,
    },
    /// The point at half the step is not between the ends.
    #[error("the point at half the step lies {steps:.2} steps off the curve through both ends")]
    MiddleOff {
        /// Distance over the length of the step.
        steps: f64,
    },
    /// `det [J; tᵀ]` has changed its sign and no other half-branch leaves the point where it does.
    #[error("the step ends on another half-branch of the curve")]
    OtherArm,
    /// The Jacobian becomes singular more than once within the step.
    #[error("the Jacobian becomes singular {count} times within the step")]
    SeveralCrossings {
        /// How often, as far as its change is even.
        count: usize,
        /// A step that is likely to tell them apart.
        next: f64,
    },
    /// A branch point within the step was seen but not located.
    #[error("the crossing that the step passes could not be located")]
    CrossingNotLocated,
    /// Other curves are near.
    #[error("other curves are closer to the step than it is long")]
    CloseCurves,
    /// The step passes a bound, and the point of the branch on that was not found.
    #[error(
        "the step passes {value} of coordinate {coordinate}, where the branch is to end, \
         and the point there was not found"
    )]
    BoundNotLocated {
        /// Index in `z`; n is the parameter.
        coordinate: usize,
        /// The bound.
        value: f64,
    },
    /// The step passes the start of the branch, and the branch was not found there.
    #[error("the step passes the start of the branch, but the branch was not found there")]
    StartNotLocated,
}

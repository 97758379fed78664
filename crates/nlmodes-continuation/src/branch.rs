use crate::record::{is_direction, is_vector};
use crate::{Crossing, Refusal, Scaling};

/// What a branch passes at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum EventKind {
    /// The parameter turns.
    ParameterFold,
    /// A watched unknown turns.
    UnknownFold {
        /// Its index.
        index: usize,
    },
    /// More than two half-branches of the solution set meet.
    BranchPoint,
    /// The system passes from one smooth piece to another.
    PatternChange {
        /// Piece before.
        from: u64,
        /// Piece after.
        to: u64,
    },
    /// The tangent turns within a step too short to resolve.
    Kink,
}

/// A point of a branch.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct BranchPoint {
    /// Unknowns, n.
    pub x: Vec<f64>,
    /// Parameter.
    pub p: f64,
    /// Unit tangent, n + 1, in the direction of travel.
    pub tangent: Vec<f64>,
    /// Largest entry of the residual in magnitude, over the size of its equation.
    #[cfg_attr(feature = "serde", serde(with = "crate::record::any_number"))]
    pub residual: f64,
    /// Newton iterations of the last correction.
    pub iterations: usize,
    /// The smooth piece, [`crate::ParametricSystem::pattern`].
    pub pattern: u64,
    /// What happens here.
    pub events: Vec<EventKind>,
}

impl BranchPoint {
    /// A place near which a point is sought, with the direction of the branch there.
    pub fn guess(x: Vec<f64>, p: f64, tangent: Vec<f64>) -> Self {
        Self { x, p, tangent, residual: f64::NAN, iterations: 0, pattern: 0, events: Vec::new() }
    }

    /// Unknowns and parameter as one vector `z`, n + 1.
    pub fn z(&self) -> Vec<f64> {
        let mut z = self.x.clone();
        z.push(self.p);
        z
    }

    /// Whether this can be a point of a system with n unknowns.
    pub(crate) fn is_of(&self, n: usize) -> bool {
        let index = |event: &EventKind| if let EventKind::UnknownFold { index } = event { *index < n } else { true };
        is_vector(&self.x, n)
            && self.p.is_finite()
            && is_direction(&self.tangent, n + 1)
            && !self.residual.is_nan()
            && self.events.iter().all(index)
    }
}

/// Why a branch has no further points.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum StopReason {
    /// A coordinate reached its bound; the last point lies on it.
    Bound {
        /// Index in `z`; n is the parameter.
        coordinate: usize,
        /// The bound.
        value: f64,
    },
    /// The number of points asked for is reached.
    MaxPoints,
    /// The branch came back to where it began; the last point is the first again.
    Closed,
    /// The observer asked to stop.
    Stopped,
    /// The branch came to a branch point whose way on another branch of the tree, or this one, had passed before.
    Joined,
    /// No step, however short, could be shown to stay on the branch.
    StepTooSmall {
        /// The last step tried, over the sizes of the unknowns.
        step: f64,
        /// Why it was refused.
        refusal: Refusal,
    },
}

impl StopReason {
    /// Whether the branch could go on: it ended because it was asked to, or has as many points as were asked for.
    pub fn is_asked_for(&self) -> bool {
        matches!(self, Self::Stopped | Self::MaxPoints)
    }

    /// Whether a branch of a system with n unknowns can end so.
    pub(crate) fn is_of(&self, n: usize) -> bool {
        match self {
            Self::Bound { coordinate, value } => *coordinate <= n && value.is_finite(),
            _ => true,
        }
    }
}

/// A branch: always returned, with the reason why it ended.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Branch {
    /// The points, in order.
    pub points: Vec<BranchPoint>,
    /// Where more than two half-branches meet, in the order in which the branch came to them.
    pub crossings: Vec<Crossing>,
    /// Why there are no more.
    pub stop: StopReason,
    /// Sizes of unknowns and equations beside which steps and tolerances were taken.
    pub scales: Scaling,
    /// Evaluations of residual and Jacobian.
    pub evaluations: usize,
    /// Steps that were tried and refused.
    pub refused_steps: usize,
}

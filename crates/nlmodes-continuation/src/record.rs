use std::ops::ControlFlow;

use crate::vectors::dot;
use crate::{BranchPoint, Choice, Correction, StopReason};

/// What a step brought: with those before it, all that is needed to go on behind it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct StepRecord {
    /// Points found, in order; the branch goes on from the last one. The first step of a run is its start.
    pub points: Vec<BranchPoint>,
    /// Sign of `det [J; tᵀ]` at the last point.
    pub orientation: f64,
    /// How far the Jacobian is from being singular at the last point, the ratio of the pivots.
    #[cfg_attr(feature = "serde", serde(with = "any_number"))]
    pub regularity: f64,
    /// How well points are known in spite of rounding there; zero where that does not matter.
    #[cfg_attr(feature = "serde", serde(default))]
    pub blur: f64,
    /// Rounding of the entries of the residual, as large as it was found so far; empty in a log that does not know it.
    #[cfg_attr(feature = "serde", serde(default))]
    pub rounding: Vec<f64>,
    /// The regularity at the point from which the step was taken, and the distance of that; `None` behind a kink.
    pub before: Option<(f64, f64)>,
    /// Sense in which the coordinates whose turning points are events moved last.
    pub senses: Vec<f64>,
    /// The branch point that was passed, and its half-branches.
    pub crossing: Option<Choice>,
    /// Length of the next step.
    pub next: f64,
    /// Evaluations of residual and Jacobian since the run began.
    pub evaluations: usize,
    /// Steps refused since the run began.
    pub refused_steps: usize,
    /// Why there is no next step. Where this [was asked for](StopReason::is_asked_for) the step may not be complete.
    pub stop: Option<StopReason>,
}

/// More evaluations than any run makes; sums of such numbers are far from overflowing.
const MOST: usize = 1 << 40;

impl StepRecord {
    /// Whether this can be a step of a run with n unknowns, as far as can be told without the equations: vectors of the
    /// right lengths, finite numbers, a way on or a reason why there is none. Steps that are read back from a file that
    /// somebody has altered need not be.
    pub(crate) fn is_of(&self, n: usize) -> bool {
        let numbers =
            [self.orientation, self.next, self.blur].iter().chain(&self.senses).all(|number| number.is_finite());
        let before = self.before.is_none_or(|(regularity, distance)| !regularity.is_nan() && distance > 0.0);
        let ends = self.stop.as_ref().map_or(self.next > 0.0 && !self.points.is_empty(), |stop| stop.is_of(n));
        numbers
            && before
            && ends
            && self.points.iter().all(|point| point.is_of(n))
            && self.crossing.as_ref().is_none_or(|choice| choice.is_of(n))
            && self.blur >= 0.0
            && (self.rounding.is_empty() || is_vector(&self.rounding, n))
            && self.evaluations < MOST
            && self.refused_steps < MOST
    }
}

/// Whether this can be a unit vector of n entries.
pub(crate) fn is_direction(vector: &[f64], n: usize) -> bool {
    is_vector(vector, n) && (dot(vector, vector) - 1.0).abs() < 1e-6
}

/// Whether a vector has this length and finite entries.
pub(crate) fn is_vector(vector: &[f64], n: usize) -> bool {
    vector.len() == n && vector.iter().all(|entry| entry.is_finite())
}

/// Keeps the steps of runs, so that a run that was cut off can go on.
///
/// A computation of several runs has one log, and makes the runs in the same order when it is repeated. A log that
/// keeps nothing is `()`.
pub trait RunLog {
    /// A run begins at `start`: the steps that an earlier one from there took; none where there was no such run.
    ///
    /// A step that was [asked to end](StopReason::is_asked_for) can only be the last of them. The run repeats them up
    /// to the first that is not one of its own: whose points have the wrong number of unknowns, say, or do not solve
    /// its equations.
    fn begin(&mut self, start: &Correction) -> Vec<StepRecord>;

    /// The run has repeated so many steps and from here on computes: it takes those behind them anew. It stops if the
    /// log says so.
    fn computing(&mut self, repeated: usize) -> ControlFlow<()> {
        let _ = repeated;
        ControlFlow::Continue(())
    }

    /// The run took a step. It stops if the log says so.
    fn record(&mut self, step: &StepRecord) -> ControlFlow<()>;
}

impl RunLog for () {
    fn begin(&mut self, _: &Correction) -> Vec<StepRecord> {
        Vec::new()
    }

    fn record(&mut self, _: &StepRecord) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Numbers that may be infinite, which JSON has no word for.
#[cfg(feature = "serde")]
pub(crate) mod any_number {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
        value.is_finite().then_some(*value).serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        Ok(Option::<f64>::deserialize(from)?.unwrap_or(f64::INFINITY))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_have_their_length_and_finite_entries_and_directions_length_one() {
        assert!(is_vector(&[3.0, -2.0], 2) && is_vector(&[], 0));
        assert!(!is_vector(&[3.0], 2) && !is_vector(&[3.0, f64::NAN], 2) && !is_vector(&[f64::INFINITY, 0.0], 2));
        assert!(is_direction(&[0.6, -0.8], 2));
        assert!(!is_direction(&[0.6, -0.7], 2) && !is_direction(&[0.6, -0.8], 3));
    }
}

//! How many harmonics and held modes an accuracy takes.

use std::f64::consts::TAU;

use nlmodes_hbm::CondensedStructure;
use nlmodes_model::MasslessContactModel;

use super::{BranchError, BranchSettings, GrowthSettings};

/// An accuracy that is asked for, by which harmonics are chosen along the branch, and held modes before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// Largest relative error of the frequency at the same energy that harmonics and held modes left out may cause;
    /// [`TruncationError::frequency`](nlmodes_hbm::TruncationError).
    pub error: f64,
    /// Most harmonics. Where they do not suffice the branch goes on with them, and says so.
    pub max_harmonics: usize,
}

/// What became of an [`Accuracy`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct AccuracyReached {
    /// Largest estimate over all points, [`TruncationError::frequency`](nlmodes_hbm::TruncationError).
    pub largest_estimate: f64,
    /// The largest share of the held modes in an estimate.
    pub largest_held_modes_estimate: f64,
    /// Points whose estimate is larger than what was asked for.
    pub points_beyond: usize,
    /// Changes of the number of harmonics along the branch.
    pub changes: usize,
    /// Smallest and largest number of harmonics of a point.
    pub harmonics: [usize; 2],
}

/// The number of harmonics with which a branch begins.
pub(super) fn first_harmonics(accuracy: Accuracy, growth: &GrowthSettings, fewest: usize) -> usize {
    let (harmonics, error) = growth.known;
    let guess = harmonics * (error / (growth.aim * accuracy.error)).powf(1.0 / growth.order);
    (guess.ceil() as usize).clamp(fewest, accuracy.max_harmonics.max(fewest))
}

/// The structure with as many held modes as the accuracy takes by a guess for the motion's higher harmonics, and at
/// least these.
pub(super) fn condense(
    model: MasslessContactModel,
    settings: &BranchSettings,
    accuracy: Accuracy,
    at_least: usize,
) -> Result<CondensedStructure, BranchError> {
    let size = model.linear_dofs().len();
    if let Some(count) = settings.held_modes {
        return Ok(CondensedStructure::new(model, count)?);
    }
    let mut count = at_least.max(2 * settings.harmonics);
    loop {
        let structure = CondensedStructure::new(model.clone(), count.min(size))?;
        if count >= size {
            return Ok(structure);
        }
        let start = super::prepare::linear_start(&structure, settings)?;
        let omega = settings.frequency_hz.map_or(1.2 * start.omega, |w| (w[1] * TAU).min(1.5 * start.omega));
        let error = structure.held_modes_error(&start, omega, settings.harmonics);
        if error <= (1.0 - settings.growth.share) * accuracy.error {
            return Ok(structure);
        }
        count += count.div_ceil(3);
    }
}

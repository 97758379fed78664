//! What is refused before a branch is computed.

use std::sync::Arc;

use nlmodes_model::MasslessContactModel;

use super::accuracy::first_harmonics;
use super::compute::begin;
use super::prepare::{check_window, condense, shooting_modes};
use super::trace::Tracer;
use super::{BranchError, BranchMethod, BranchSettings};

/// Whether [`compute_tree`](super::compute_tree) would begin with this model and these settings: linear modes and the
/// start of the nonlinear mode are computed, no point of it.
///
/// # Errors
/// The [`BranchError`] with which it would refuse to. Starts that have to be sought can fail later.
pub fn check_branch(model: &MasslessContactModel, settings: &BranchSettings) -> Result<(), BranchError> {
    let (mut settings, fewest) = (settings.clone(), settings.harmonics);
    if let Some(accuracy) = settings.accuracy {
        settings.harmonics = first_harmonics(accuracy, &settings.growth, fewest);
    }
    if settings.method == BranchMethod::Shooting {
        shooting_modes(model, &settings)?;
    }
    let structure = Arc::new(condense(model.clone(), &settings, 0)?);
    let start = begin(&structure, &settings)?;
    check_window(&settings, &start)?;
    Tracer::new(&structure, &start, &settings, fewest, &mut ())?;
    Ok(())
}

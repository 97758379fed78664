//! The structure of a scene as the exact integration has it.

use nlmodes::hbm::ResponseRow;
use nlmodes::response::{Weights, exact_structure};
use nlmodes::timestep::ForcedStructure;
use nlmodes_scene::SceneFile;

use super::Model;
use crate::{RunError, refusal};

/// The structure of a model as the exact integration has it: modes, residual flexibility, stops.
///
/// # Errors
/// [`RunError`] at the contacts.
pub fn structure(file: &SceneFile, model: &Model) -> Result<ForcedStructure, RunError> {
    exact_structure(model.response().structure()).map_err(|error| refusal::here(file, "contact", &error))
}

/// Adds the laws of a model behind the loads of a structure; `moved` tells how far a unit of each of these moves a
/// place beyond the modes, m.
///
/// # Errors
/// [`RunError`].
pub fn push_laws(
    file: &SceneFile,
    model: &Model,
    structure: &mut ForcedStructure,
    moved: &dyn Fn(&Weights, &ResponseRow) -> Vec<f64>,
) -> Result<(), RunError> {
    let response = model.response();
    let places: Vec<Weights> =
        (0..response.structure().laws().len()).filter_map(|l| response.law_weights(l).cloned()).collect();
    let rows = response.rows(&places).map_err(|error| refusal::here(file, "spring", &error))?;
    let by_inputs = |l: usize| moved(&places[l], &rows[l]);
    nlmodes::response::push_laws(response.structure(), structure, &by_inputs, &|_| Vec::new())
        .map_err(|error| refusal::here(file, "spring", &error))
}

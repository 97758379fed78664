//! The structure of a scene as the exact integration has it.

use std::sync::Arc;

use nlmodes::hbm::{ForceLaw, ResponseRow};
use nlmodes::response::{Weights, exact_structure};
use nlmodes::timestep::{ForcedStructure, TimeLaw};
use nlmodes_scene::SceneFile;

use super::model::Model;
use crate::{RunError, chain};

/// The structure of a model as the exact integration has it: modes, residual flexibility, stops.
///
/// # Errors
/// [`RunError`] at the contacts.
pub fn structure(file: &SceneFile, model: &Model) -> Result<ForcedStructure, RunError> {
    exact_structure(model.response().structure())
        .map_err(|error| file.error_at("contact", &chain(&error), "here", &[]).into())
}

/// A law of force in time.
#[derive(Debug)]
struct InTime(Arc<dyn ForceLaw>);

impl TimeLaw for InTime {
    fn at(&self, v: f64, rate: f64) -> [f64; 3] {
        let at = self.0.at(v, rate);
        [at.force, at.stiffness, at.damping]
    }

    fn stop_gap(&self) -> Option<f64> {
        self.0.stop_gap()
    }
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
    let (response, laws) = (model.response(), model.response().structure().laws());
    let failed = |error: &(dyn std::error::Error + 'static)| -> RunError {
        file.error_at("spring", &chain(error), "here", &[]).into()
    };
    let places: Vec<Weights> = (0..laws.len()).filter_map(|l| response.law_weights(l).cloned()).collect();
    let rows = response.rows(&places).map_err(|error| failed(&error))?;
    let (m, c) = (structure.n_modes(), structure.n_contacts());
    for (l, (placed, (place, row))) in laws.iter().zip(places.iter().zip(&rows)).enumerate() {
        let mut by_inputs = moved(place, row);
        by_inputs.extend(&placed.laws[..=l]);
        let law = Arc::new(InTime(placed.law.clone()));
        structure
            .push_law(law, &placed.modes[..m], &placed.contacts[..c], &by_inputs)
            .map_err(|error| failed(&error))?;
    }
    Ok(())
}

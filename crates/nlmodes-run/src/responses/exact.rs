//! The structure of a scene as the exact integration has it.

use nlmodes::linalg::Mat;
use nlmodes::timestep::ForcedStructure;
use nlmodes_scene::SceneFile;

use super::model::Model;
use crate::{RunError, chain};

/// The structure of a model as the exact integration has it: modes, residual flexibility, stops.
///
/// # Errors
/// [`RunError`] at the contacts.
pub fn structure(file: &SceneFile, model: &Model) -> Result<ForcedStructure, RunError> {
    let (open, of) = (model.open_modes(), model.response().structure());
    let (m, c) = (open.n_modes(), open.n_contacts());
    let failed = |error: &(dyn std::error::Error + 'static)| -> RunError {
        file.error_at("contact", &chain(error), "here", &[]).into()
    };
    let damping = Mat::from_fn(m, m, |i, j| of.damping().entry(i, j));
    let rows = Mat::from_fn(c, m, |i, k| of.rows()[(i, k)]);
    let damped = |contact: usize| model.stop_dampers.iter().find(|(own, _)| *own == contact);
    let own = |i: usize| if damped(i).is_some() { 0.0 } else { open.stop_compliance()[i] };
    let compliance = Mat::from_fn(c, c, |i, j| open.flexibility()[(i, j)] + if i == j { own(i) } else { 0.0 });
    let mut structure = ForcedStructure::new(&of.omega_squared()[..m], &damping, &rows, &compliance, of.gaps())
        .map_err(|error| failed(&error))?;
    for &(contact, damper) in &model.stop_dampers {
        let stiffness = 1.0 / open.stop_compliance()[contact];
        structure.push_damped_stop(contact, stiffness, damper).map_err(|error| failed(&error))?;
    }
    if !of.steady_force().is_empty() {
        structure.set_steady_force(&of.steady_force()[..m]).map_err(|error| failed(&error))?;
    }
    Ok(structure)
}

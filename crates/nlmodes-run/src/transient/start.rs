//! The state with which a motion begins.

use std::path::Path;

use nlmodes_scene::SceneFile;
use nlmodes_scene::scene::TransientStart;

use crate::model::Model;
use crate::motion::{Motion, state_of};
use crate::verify::results::scene_of;
use crate::{RunError, chain};

/// Modal coordinates, their rates, and displacements of the dissipative stops at the beginning.
///
/// # Errors
/// [`RunError`] at `transient.from`.
pub fn state(file: &SceneFile, from: &TransientStart, model: &Model) -> Result<Vec<f64>, RunError> {
    let open = model.open_modes();
    let still = |mut eta: Vec<f64>| {
        let m = eta.len();
        eta.resize(2 * m + model.stop_dampers.len(), 0.0);
        eta
    };
    let eta = match from {
        TransientStart::Point { results, point } => return on_motion(file, results, *point, model),
        // The drawing, as seen from the place under static loads.
        TransientStart::Rest => model.state.as_ref().map(|state| state.modal.iter().map(|eta| -eta).collect()),
        TransientStart::Static => model.state.as_ref().map(|state| state.rest.eta.clone()),
    };
    Ok(still(eta.unwrap_or_else(|| vec![0.0; open.n_modes()])))
}

fn on_motion(file: &SceneFile, results: &Path, point: usize, model: &Model) -> Result<Vec<f64>, RunError> {
    let failed = |title: &str| -> RunError {
        let expected = "expected results of this structure, and a point of their branch.csv";
        file.error_at("transient.from", title, expected, &[]).into()
    };
    let told = |error: &dyn std::fmt::Display| failed(&format!("{}: {error}", results.display()));
    let scene = scene_of(results).map_err(|error| told(&chain(&error)))?;
    if scene.structure != file.scene.structure {
        return Err(told(&"these are results of another structure"));
    }
    let motion = Motion::read(results, point).map_err(|error| told(&chain(&error)))?;
    state_of(&motion, model, 0.0).map_err(|why| told(&why))
}

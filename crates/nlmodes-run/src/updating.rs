//! `[updating]`: parameters of the structure from linear frequencies, before anything else is computed.

use std::f64::consts::TAU;

use nlmodes::model::linear_modes;
use nlmodes::updating::{FrequencyTarget, UpdatingError, update_parameters};
use thiserror::Error as ThisError;

use crate::{Failure, RunError, chain};
use nlmodes_scene::SceneFile;
use nlmodes_scene::assemble::{element_model, redistribution};
use nlmodes_scene::scene::{Scene, UpdatedParameter, Updating, UpdatingDone};

/// A model with trial values that cannot be made or has no modes.
#[derive(Debug, ThisError)]
#[error(transparent)]
struct Trial(#[from] Failure);

/// The scene with its parameters updated and what was done on record; the same scene if it requests none.
///
/// # Errors
/// [`RunError`] if no parameters give the frequencies.
pub fn updated(mut file: SceneFile) -> Result<SceneFile, RunError> {
    let Some(updating) = file.scene.updating.clone() else { return Ok(file) };
    match update(&file.scene, &updating) {
        Ok(scene) => {
            file.scene = scene;
            Ok(file)
        }
        Err(error) => {
            let path = match error {
                UpdatingError::NoSuchMode { .. } => "updating.modes",
                UpdatingError::Indistinct => "updating.parameters",
                _ => "updating",
            };
            let said = file.error_at(path, &chain(&error), "", &[]);
            let failed = matches!(error, UpdatingError::NotConverged { .. } | UpdatingError::Linalg(_));
            Err(if failed { RunError::Failed(said) } else { said.into() })
        }
    }
}

fn update(scene: &Scene, updating: &Updating) -> Result<Scene, UpdatingError<Trial>> {
    let start: Vec<f64> = updating.parameters.iter().map(|p| value(scene, *p)).collect();
    let targets = updating.modes.iter().zip(&updating.frequencies_hz);
    let targets: Vec<_> = targets.map(|(&mode, &frequency)| FrequencyTarget { mode, frequency }).collect();
    let count = updating.modes.iter().copied().max().unwrap_or(1);
    let frequencies = |values: &[f64]| frequencies(&with(scene, updating, values), count).map_err(Trial);
    let found = update_parameters(&start, &targets, frequencies)?;
    let mut updated = with(scene, updating, &found.values);
    let done = UpdatingDone { from: start, to: found.values, from_hz: found.before, to_hz: found.after };
    updated.updating = Some(Updating { done: Some(done), ..updating.clone() });
    Ok(updated)
}

/// Lowest linear frequencies of the scene, Hz, with the contact mass as its method has it.
fn frequencies(scene: &Scene, count: usize) -> Result<Vec<f64>, Failure> {
    // Imposed frequencies would not change with the parameters.
    let Some(structure) = scene.structure.straight() else { return Ok(Vec::new()) };
    let model = element_model(structure, &scene.contacts)?;
    let redistributed = match redistribution(scene).filter(|_| !model.contacts().is_empty()) {
        Some(rule) => Some(rule.redistribute(&model)?),
        None => None,
    };
    let mass = redistributed.as_ref().unwrap_or(model.mass());
    Ok(linear_modes(mass, model.stiffness(), count)?.omega.iter().map(|omega| omega / TAU).collect())
}

fn value(scene: &Scene, parameter: UpdatedParameter) -> f64 {
    // Structures from files have no parameters.
    scene.structure.straight().map_or(0.0, |structure| match parameter {
        UpdatedParameter::YoungsModulus => structure.youngs_modulus,
        UpdatedParameter::Density => structure.density,
        UpdatedParameter::Length => structure.length,
    })
}

/// The scene with these values; with the length its contacts keep their nodes.
fn with(scene: &Scene, updating: &Updating, values: &[f64]) -> Scene {
    let mut scene = scene.clone();
    let Some(structure) = scene.structure.straight_mut() else { return scene };
    for (parameter, &value) in updating.parameters.iter().zip(values) {
        match parameter {
            UpdatedParameter::YoungsModulus => structure.youngs_modulus = value,
            UpdatedParameter::Density => structure.density = value,
            UpdatedParameter::Length => {
                let ratio = value / structure.length;
                scene.contacts.iter_mut().for_each(|contact| contact.at *= ratio);
                structure.length = value;
            }
        }
    }
    scene
}

/// What was done, in a line for each parameter and each frequency; nothing where nothing was done yet.
pub fn in_words(updating: &Updating) -> Option<String> {
    let done = updating.done.as_ref()?;
    let parameters = updating.parameters.iter().zip(done.from.iter().zip(&done.to));
    let parameters = parameters.map(|(p, (from, to))| format!("updated {}: {from:.6e} became {to:.6e}", p.name()));
    let frequencies = updating.modes.iter().zip(&updating.frequencies_hz).zip(done.from_hz.iter().zip(&done.to_hz));
    let frequencies = frequencies.map(|((mode, given), (from, to))| {
        format!("  mode {mode}: {from:.6} Hz became {to:.6} Hz, given {given} Hz ({:+.1e})", to / given - 1.0)
    });
    Some(parameters.chain(frequencies).collect::<Vec<_>>().join("\n"))
}

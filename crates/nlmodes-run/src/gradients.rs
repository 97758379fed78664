//! Derivatives of the points of curves by the parameters of a scene, `[[sensitivity]]`.

use std::f64::consts::TAU;
use std::sync::Arc;

use nlmodes::branches::{ComputedBranch, Watch};
use nlmodes::hbm::{Changes, MotionChange, StructureChange};
use nlmodes::linalg::triplets;
use nlmodes::modal::Gradient;
use nlmodes::model::reduction::{MatrixDirection, OpenModes};
use nlmodes::response::{
    AtValue, Damping, Gradients, ParameterState, ResponseModel, ResponseSettings, Weights, mode_gradients,
};
use nlmodes_scene::SceneFile;
use nlmodes_scene::assemble::{Assembly, OpenStructure, Structures};
use nlmodes_scene::scene::{Reduction, Scene, SceneState, SceneStructure, Sensitivity};

use crate::settings::branch_settings;
use crate::{Failure, RunError};

/// The derivatives of a point by the parameter with this key and value, from those of its motion, of which
/// `subharmonic` periods of the load are one; `moved` is that of what static loads move the first contact toward its
/// stop.
pub fn gradient((key, value): (&Arc<str>, f64), found: &MotionChange, subharmonic: usize, moved: f64) -> Gradient {
    let known = |value: f64| Some(value).filter(|value| value.is_finite());
    Gradient {
        parameter: key.clone(),
        value,
        by: [
            known(found.omega * subharmonic as f64 / TAU),
            known(found.amplitude),
            known(found.peak + moved),
            known(found.peak_force),
            known(found.impulse),
            known(found.level),
            known(found.damping_ratio),
        ],
    }
}

/// The same scene with so many free-interface modes, whatever its harmonics.
pub fn with_modes(scene: &Scene, modes: usize) -> Scene {
    let reduction = Reduction { modes: Some(modes), up_to_hz: None, ..scene.reduction.unwrap_or_default() };
    Scene { reduction: Some(reduction), ..scene.clone() }
}

/// Differentiates the points of conservative modes, whose coefficients begin with modal coordinates; how many of them
/// have no derivatives, since they are not found again at their energy.
///
/// # Errors
/// If the structure at another value of a parameter cannot be made.
pub fn of_branches(
    scene: &Scene,
    open: Option<&OpenStructure>,
    (structures, watch): (&Structures, Watch),
    branches: &mut [ComputedBranch],
) -> Result<usize, Failure> {
    let (Some(open), false) = (open, scene.sensitivities.is_empty()) else { return Ok(0) };
    let own = branch_settings(scene);
    let settings = settings(scene, own.harmonics, watch);
    let base = model(&open.modes)?;
    let first = toward_first(&open.modes);
    let directions = scene.sensitivities.iter().filter(|own| !own.entries.is_empty());
    let directions = directions.map(|own| direction(scene, open, own)).collect::<Result<Vec<_>, _>>()?;
    let many = base.changes_along(&directions, Some(&first))?;
    let (mut changes, mut moved) = (Vec::new(), Vec::new());
    for sensitivity in &scene.sensitivities {
        let (change, toward) = match sensitivity.entries.is_empty() {
            true => change(open, (&base, sensitivity), structures, &settings).map(|(of, moved)| (Some(of), moved))?,
            false => (None, 0.0),
        };
        changes.push(change);
        moved.push(toward);
    }
    let watched = base.watched(&first, &settings)?;
    let settings = settings.with_gradients(Gradients { watched, changes: Changes::new(changes, many) });
    let parameters = scene.sensitivities.iter().map(|own| (Arc::from(own.key.as_str()), own.value));
    let parameters: Vec<(Arc<str>, f64)> = parameters.collect();
    let mut without = 0;
    for computed in branches {
        let all = mode_gradients(&base, &settings, own.symmetry, &computed.branch.points)?;
        for (point, found) in computed.branch.points.iter_mut().zip(all) {
            let Some(found) = found else {
                without += 1;
                continue;
            };
            // What unfolds the phase of a conservative motion is no damping.
            let conservative = |found: &MotionChange| {
                let mut found = *found;
                found.damping_ratio = f64::NAN;
                found
            };
            let each = parameters.iter().zip(&found).zip(&moved);
            let each =
                each.map(|(((key, value), found), moved)| gradient((key, *value), &conservative(found), 1, *moved));
            point.gradients = each.collect();
        }
    }
    Ok(without)
}

/// How motions of a mode are solved again.
pub fn settings(scene: &Scene, harmonics: usize, watch: Watch) -> ResponseSettings {
    let own = branch_settings(scene);
    ResponseSettings {
        harmonics,
        switching: own.switching,
        contact_solver: own.contact_solver,
        mode: own.mode,
        max_points: own.max_points,
        watch,
        ..ResponseSettings::new([1.0, 2.0])
    }
}

/// Refuses parameters that change entries which the matrices do not have.
///
/// # Errors
/// [`RunError`] that names the entry.
pub fn check(file: &SceneFile, open: Option<&OpenStructure>) -> Result<(), RunError> {
    let Some(open) = open else { return Ok(()) };
    let mut all = file.scene.sensitivities.iter().filter(|own| !own.entries.is_empty());
    all.try_for_each(|own| {
        let found = direction(&file.scene, open, own).map(drop);
        found.map_err(|why| file.error_at("sensitivity", &why, "expected rows of the matrices", &[]).into())
    })
}

/// What a parameter does to the matrices of a structure from files.
///
/// # Errors
/// Words about an entry that these do not have.
pub fn direction(scene: &Scene, open: &OpenStructure, own: &Sensitivity) -> Result<MatrixDirection, String> {
    match (&scene.structure, &open.files) {
        (SceneStructure::Matrices(matrices), Some((model, _))) => own.direction(model, &matrices.files.units),
        _ => Err("only a structure from files has entries of stiffness and mass".to_owned()),
    }
}

/// What a parameter does to the structure, and of what static loads move the first contact toward its stop.
fn change(
    open: &OpenStructure,
    (base, sensitivity): (&ResponseModel, &Sensitivity),
    structures: &Structures,
    settings: &ResponseSettings,
) -> Result<(StructureChange, f64), Failure> {
    let state = |SceneState { scene: other, weight }: &SceneState| -> Result<(ParameterState, f64), Failure> {
        let other = Assembly::sharing(&with_modes(other, open.modes.n_modes()), structures)?;
        let other = other.open.ok_or("gradients are of free-interface modes")?;
        let toward = other.state.as_ref().map_or(0.0, |state| state.toward(0));
        let (model, watched) = (model(&other.modes)?, Some(toward_first(&other.modes)));
        Ok((ParameterState { model, level: 0.0, watched, weight: *weight }, weight * toward))
    };
    let states = sensitivity.states.iter().map(state).collect::<Result<Vec<_>, _>>()?;
    let moved = states.iter().map(|(_, moved)| moved).sum();
    let states: Vec<ParameterState> = states.into_iter().map(|(state, _)| state).collect();
    Ok((base.change(&states, settings)?, moved))
}

/// The structure of a scene without load, with what the parameter with this number does to it.
///
/// # Errors
/// If the structure, or that at another value of the parameter, cannot be made.
pub fn at_value(
    scene: &Scene,
    number: usize,
    structures: &Structures,
    settings: &ResponseSettings,
) -> Result<AtValue, Failure> {
    let open = Assembly::sharing(scene, structures)?.open.ok_or("gradients are of free-interface modes")?;
    let sensitivity = scene.sensitivities.get(number).ok_or("there is no such parameter")?;
    let base = model(&open.modes)?;
    let (change, _) = change(&open, (&base, sensitivity), structures, settings)?;
    let watched = base.watched(&toward_first(&open.modes), settings)?;
    Ok(AtValue { model: base, level: 0.0, change, watched })
}

fn model(modes: &OpenModes) -> Result<ResponseModel, Failure> {
    Ok(ResponseModel::new(modes.clone(), &Damping::Ratios(Vec::new()))?)
}

/// Displacement of the first contact toward its stop.
fn toward_first(modes: &OpenModes) -> Weights {
    let of_first = triplets(modes.directions()).filter(|(_, contact, _)| *contact == 0);
    of_first.map(|(dof, _, w)| (dof, -w)).collect()
}

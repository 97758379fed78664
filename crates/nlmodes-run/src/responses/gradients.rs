//! The parameters by which the points of a response are differentiated.

use nlmodes::hbm::{Changes, StructureChange, Watched};
use nlmodes::response::{Gradients, ParameterState, ResponseError, ResponseModel, ResponseSettings, Weights};
use nlmodes_scene::scene::Scene;

use crate::model::{Model, Parameter};

/// What the parameters of the scene do to the structure and the load of a response, at one of its levels where its
/// motions are at that; along others the level is no value of the scene.
///
/// # Errors
/// [`ResponseError`] where the modes at another value of a parameter are others.
pub fn gradients(
    model: &Model,
    at: (&Scene, usize, Option<f64>),
    settings: &ResponseSettings,
    system: &ResponseModel,
) -> Result<Gradients, ResponseError> {
    let watched = watched(model, settings, system)?;
    let directions: Vec<_> = model.parameters.iter().filter_map(|parameter| parameter.direction.clone()).collect();
    let many = system.changes_along(&directions, first(model).as_ref())?;
    let own = model.parameters.iter().map(|parameter| match parameter.direction {
        Some(_) => Ok(None),
        None => change(parameter, at, settings, system).map(Some),
    });
    Ok(Gradients { watched, changes: Changes::new(own.collect::<Result<_, _>>()?, many) })
}

/// The displacement whose amplitude is followed.
///
/// # Errors
/// [`ResponseError`] where its rows cannot be made.
pub fn watched(
    model: &Model,
    settings: &ResponseSettings,
    system: &ResponseModel,
) -> Result<Option<Watched>, ResponseError> {
    Ok(first(model).map(|weights| system.watched(&weights, settings)).transpose()?.flatten())
}

/// What a parameter of the scene does, of the response with this number at this level.
///
/// # Errors
/// As [`gradients`].
pub fn change(
    parameter: &Parameter,
    (scene, response, level): (&Scene, usize, Option<f64>),
    settings: &ResponseSettings,
    system: &ResponseModel,
) -> Result<StructureChange, ResponseError> {
    let levels = |scene: &Scene| scene.responses.get(response).map(|own| own.levels.clone());
    let number = level.and_then(|level| levels(scene)?.iter().position(|l| *l == level));
    let level_of = |scene: &Scene| number.and_then(|k| levels(scene)?.get(k).copied()).unwrap_or(0.0);
    let state = |(model, scene, weight): &(Model, Scene, f64)| {
        let (model, watched) = (model.with_drive(response)?, first(model));
        Ok(ParameterState { model, level: level_of(scene), watched, weight: *weight })
    };
    let states = parameter.states.iter().map(state).collect::<Result<Vec<_>, ResponseError>>()?;
    system.change(&states, settings)
}

/// Displacement of the first contact toward its stop or, without one, of the first spring.
fn first(model: &Model) -> Option<Weights> {
    model.contacts.iter().chain(&model.springs).next().cloned()
}

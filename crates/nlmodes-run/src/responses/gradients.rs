//! The parameters by which the points of a response are differentiated.

use nlmodes::hbm::{StructureChange, Watched};
use nlmodes::response::{ParameterState, ResponseError, ResponseModel, ResponseSettings, Weights};
use nlmodes_scene::scene::Scene;

use crate::model::{Model, Parameter};

/// What the parameters of the scene do to the structure and the load of a response, at one of its levels where its
/// motions are at that; along others the level is no value of the scene. The displacement whose amplitude is followed
/// comes first.
///
/// # Errors
/// [`ResponseError`] where the modes at another value of a parameter are others.
pub fn changes(
    model: &Model,
    scene: &Scene,
    (response, level): (usize, Option<f64>),
    settings: &ResponseSettings,
    system: &ResponseModel,
) -> Result<(Option<Watched>, Vec<StructureChange>), ResponseError> {
    let watched = first(model).map(|weights| system.watched(&weights, settings)).transpose()?.flatten();
    if model.parameters.is_empty() {
        return Ok((watched, Vec::new()));
    }
    let levels = |scene: &Scene| scene.responses.get(response).map(|own| own.levels.clone());
    let number = level.and_then(|level| levels(scene)?.iter().position(|l| *l == level));
    let level_of = |scene: &Scene| number.and_then(|k| levels(scene)?.get(k).copied()).unwrap_or(0.0);
    let directions: Vec<_> = model.parameters.iter().filter_map(|parameter| parameter.direction.clone()).collect();
    let mut along = system.changes_along(&directions, first(model).as_ref(), settings)?.into_iter();
    let change = |parameter: &Parameter| {
        if let Some(change) = parameter.direction.as_ref().and_then(|_| along.next()) {
            return Ok(change);
        }
        let state = |(model, scene, weight): &(Model, Scene, f64)| {
            let (model, watched) = (model.with_drive(response)?, first(model));
            Ok(ParameterState { model, level: level_of(scene), watched, weight: *weight })
        };
        let states = parameter.states.iter().map(state).collect::<Result<Vec<_>, ResponseError>>()?;
        system.change(&states, settings)
    };
    let changes = model.parameters.iter().map(change).collect::<Result<_, _>>()?;
    Ok((watched, changes))
}

/// Displacement of the first contact toward its stop or, without one, of the first spring.
fn first(model: &Model) -> Option<Weights> {
    model.contacts.iter().chain(&model.springs).next().cloned()
}

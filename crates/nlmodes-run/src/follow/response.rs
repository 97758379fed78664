//! Folds, first touches and phase resonances over a parameter.

use std::f64::consts::TAU;

use nlmodes::branches::Watch;
use nlmodes::modal::Event;
use nlmodes::response::{AtValue, OverParameter, ResponsePoint};
use nlmodes_scene::assemble::Structures;
use nlmodes_scene::number;
use nlmodes_scene::scene::{ResponseKind, Scene};

use super::family::Texts;
use super::{FollowError, FollowSettings, Followed, Wanted};
use crate::chain;
use crate::gradients::with_modes;
use crate::model::Model;
use crate::responses::{change, curves_at, resonances_to, watched};

/// Follows each fold, or first touch, of the response at the level, or its phase resonance.
pub fn follow(
    texts: &Texts,
    settings: &FollowSettings,
    (structures, watch): (&Structures, &Watch),
) -> Result<Vec<Followed>, FollowError> {
    let scene = &texts.base.scene;
    let (kind, level) = match settings.wanted {
        Wanted::Folds { level } | Wanted::Touches { level } => (ResponseKind::Frequency, level),
        Wanted::Resonance { level } => (ResponseKind::PhaseResonance, level),
        Wanted::Mode { .. } => return Ok(Vec::new()),
    };
    let place = place(scene, kind, level)?;
    let model = Model::sharing(&texts.base, structures)?;
    let modes = model.response().open_modes().n_modes();
    let own_level = scene.responses[place.0].levels[place.1];
    let (response, curves) = match kind {
        ResponseKind::PhaseResonance => {
            let (response, curve) = resonances_to(&model, scene, (place.0, own_level), watch.clone())?;
            (response, vec![curve])
        }
        _ => curves_at(&model, scene, (place.0, own_level), watch.clone())?,
    };
    let mut family = |value: f64| -> Result<AtValue, String> {
        let mut there = texts.at(value)?;
        there.scene = with_modes(&there.scene, modes);
        let model = Model::sharing(&there, structures).map_err(|error| chain(&error))?;
        let level = there.scene.responses.get(place.0).and_then(|own| own.levels.get(place.1)).copied();
        let level = level.ok_or("there is no such level")?;
        let system = model.with_drive(place.0).map_err(|error| chain(&error))?;
        let at = (&there.scene, place.0, Some(level));
        let changed = |parameter| change(parameter, at, &response, &system);
        let parts = watched(&model, &response, &system)
            .and_then(|watched| Ok((watched, model.parameters.get(texts.number).map(changed).transpose()?)));
        let (watched, change) = parts.map_err(|error| chain(&error))?;
        let change = change.ok_or("there is no such parameter")?;
        Ok(AtValue { model: system, level, change, watched })
    };
    let points = |event: Event| {
        let of = move |point: &&ResponsePoint| point.events.contains(&event);
        curves.iter().flat_map(move |curve| curve.points.iter().filter(of)).collect::<Vec<_>>()
    };
    let subharmonic = response.subharmonic;
    let is_fold = matches!(settings.wanted, Wanted::Folds { .. });
    let what = if is_fold { "fold" } else { "first touch" };
    let mut all = Vec::new();
    let mut over =
        OverParameter { family: &mut family, value: texts.value(), window: settings.window, settings: &response };
    match settings.wanted {
        Wanted::Resonance { .. } => {
            let is_there = |point: &&ResponsePoint| (point.motion.at.level / own_level - 1.0).abs() < SAME_LEVEL;
            let last = curves.first().and_then(|curve| curve.points.last());
            let Some(point) = last.filter(is_there) else {
                let why = curves.first().map_or("", |curve| curve.end.message.as_str());
                let level = number(own_level);
                return Err(FollowError::NoCurve(format!("the phase resonance never has the level {level}: {why}")));
            };
            let curve = over.resonance(point)?;
            let name = format!("phase resonance at level {}", number(own_level));
            all.push(Followed::new(name, &curve, subharmonic));
        }
        _ => {
            for point in points(if is_fold { Event::Fold } else { Event::ContactChange }) {
                if all.iter().any(|known: &Followed| known.passes(texts.value(), point.omega / TAU)) {
                    continue;
                }
                let curve = if is_fold { Some(over.fold(point)?) } else { over.touch(point)? };
                let name = format!("{what} at {} Hz", hertz(point));
                all.extend(curve.map(|curve| Followed::new(name, &curve, subharmonic)));
            }
        }
    }
    if all.is_empty() {
        let why = format!("the response at level {} has no {what} in its window", number(own_level));
        return Err(FollowError::NoCurve(why));
    }
    Ok(all)
}

/// Relative difference of levels that are the same.
const SAME_LEVEL: f64 = 1e-6;

fn hertz(point: &ResponsePoint) -> String {
    number(nlmodes_scene::rounded(point.omega / TAU, 8))
}

/// Number of the response of this kind and of the level in its list.
fn place(scene: &Scene, kind: ResponseKind, level: Option<f64>) -> Result<(usize, usize), FollowError> {
    let over = scene.responses.iter().enumerate().filter(|(_, own)| own.kind == kind);
    let all: Vec<(usize, usize, f64)> =
        over.flat_map(|(k, own)| own.levels.iter().enumerate().map(move |(l, level)| (k, l, *level))).collect();
    let levels = || all.iter().map(|own| number(own.2)).collect::<Vec<_>>().join(", ");
    let found = match (level, all.as_slice()) {
        (_, []) => {
            let why = match kind {
                ResponseKind::PhaseResonance => "no phase resonance, [response] kind = \"phase-resonance\"",
                _ => "no response over the frequency, [response] kind = \"frequency\"",
            };
            return Err(FollowError::NoCurve(format!("the scene has {why}")));
        }
        (None, [only]) => Some(only),
        (None, _) => {
            return Err(FollowError::NoCurve(format!(
                "the scene has several levels: expected --level, one of {}",
                levels()
            )));
        }
        (Some(level), all) => all.iter().find(|own| (own.2 - level).abs() <= 1e-9 * level.abs()),
    };
    let level = level.unwrap_or_default();
    found.map(|own| (own.0, own.1)).ok_or_else(|| {
        FollowError::NoCurve(format!("the scene has no level {}; its levels: {}", number(level), levels()))
    })
}

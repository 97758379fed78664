//! What a scene with responses would compute.

use super::{Row, list, row};
use crate::number;
use crate::scene::{
    BaseDirection, Damping, Dashpot, ModeDamping, Place, Response, ResponseKind, Scene, StopOfBase, Structure,
};

/// Rows about damping, loads and responses; none for a scene without responses.
pub fn rows(scene: &Scene) -> Vec<Row> {
    if scene.responses.is_empty() {
        return Vec::new();
    }
    let mut rows = Vec::new();
    let several = scene.structure.bodies().len() > 1;
    rows.extend(dampings(scene));
    for (i, force) in scene.forces.iter().enumerate() {
        let mut text = format!("{}, {} N", place(&force.place, several), number(force.amplitude));
        if force.harmonic > 1 {
            text += &format!(", in harmonic {}", force.harmonic);
        }
        if force.phase_deg != 0.0 {
            text += &format!(", {}° ahead", number(force.phase_deg));
        }
        rows.push(row(format!("force {i}"), text));
    }
    if let Some(base) = scene.base_motion {
        let stop =
            if base.stop == StopOfBase::Moves { "the stops move with it" } else { "the stops are fixed in space" };
        let direction = match base.direction {
            BaseDirection::Along(direction) => format!("in {} direction", direction.name()),
            BaseDirection::Vector([x, y, z]) => format!("along [{}, {}, {}]", number(x), number(y), number(z)),
        };
        rows.push(row("base", format!("shakes {direction}; {stop}")));
    }
    let unit = match scene.base_motion {
        Some(base) if base.is_acceleration => "m/s²",
        Some(_) => "m",
        None => "N",
    };
    for (i, found) in scene.responses.iter().enumerate() {
        rows.push(row(format!("response {i}"), response(found, unit)));
    }
    rows
}

/// Damping of the scene and of each of several structures.
pub fn dampings(scene: &Scene) -> Vec<Row> {
    let several = scene.structure.bodies().len() > 1;
    let of_scene = scene.damping.as_ref().map(|found| row("damping", damping(found, several)));
    let own = |(i, structure): (usize, &Structure)| {
        structure.damping.as_ref().map(|own| row(format!("damping {}", i + 1), of_modes(own)))
    };
    of_scene.into_iter().chain(scene.structure.bodies().iter().enumerate().filter_map(own)).collect()
}

fn of_modes(damping: &ModeDamping) -> String {
    match damping {
        ModeDamping::Ratios(ratios) if ratios.iter().all(|ratio| *ratio == 0.0) => "none of the modes".to_owned(),
        ModeDamping::Ratios(ratios) => format!("ratios {} with open contacts, the last one goes on", list(ratios)),
        ModeDamping::Rayleigh { mass, stiffness } => {
            format!("{} 1/s of the mass and {} s of the stiffness", number(*mass), number(*stiffness))
        }
    }
}

fn damping(damping: &Damping, several: bool) -> String {
    let one = |dashpot: &Dashpot| {
        format!("; dashpot of {} N s/m at {}", number(dashpot.damping), place(&dashpot.place, several))
    };
    of_modes(&damping.modes) + &damping.dashpots.iter().map(one).collect::<String>()
}

/// A place in words; `several` structures are distinguished.
pub fn place(place: &Place, several: bool) -> String {
    match place {
        Place::Along { at, direction, structure } => {
            let of = if several { format!(" of structure {}", structure + 1) } else { String::new() };
            format!("{} m{of}, {}", number(*at), direction.name())
        }
        Place::Node { node, direction } => format!("node {node} along [{}]", list(direction)),
        Place::Row { row } => format!("row {row}"),
    }
}

fn response(response: &Response, unit: &str) -> String {
    let levels = list(&response.levels);
    let window = match response.frequency_hz[..] {
        [low, high] => format!(" from {} to {} Hz", number(low), number(high)),
        [hz] => format!(" at {} Hz", number(hz)),
        _ => String::new(),
    };
    let text = match response.kind {
        ResponseKind::Frequency => format!("over the frequency{window}, at {levels} {unit}"),
        ResponseKind::Force => format!("over the level{window}, up to {levels} {unit}"),
        ResponseKind::PhaseResonance => {
            format!("at a lag of {}°{window}, up to {levels} {unit}", number(response.lag_deg))
        }
        ResponseKind::DampedMode => format!("damped nonlinear mode{window}"),
        ResponseKind::Mode => format!("conservative nonlinear mode{window}"),
        ResponseKind::Appropriation => {
            format!("force in {} harmonics that appropriates the mode{window}", response.controlled_harmonics)
        }
    };
    let periods = response.subharmonic;
    if periods > 1 { format!("{text}; motions of {periods} periods of the load") } else { text }
}

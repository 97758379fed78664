//! Linear modes of a structure at the sensors.

use nlmodes::experiment::records::Channel;
use nlmodes::modal::LinearModes;
use nlmodes::model::linear_modes;

use crate::Failure;
use nlmodes_scene::assemble::{Elements, imposed};
use nlmodes_scene::scene::Structure;

/// Most modes that are taken.
const MAX_MODES: usize = 6;
/// A sensor with less than this fraction of the largest component of a mode is at rest.
const STILL: f64 = 1e-6;
/// Positions count as the same within this share of the length.
const SAME_PLACE: f64 = 1e-3;

/// The lowest modes of the structure, with open contacts and all mass, at the positions of its motion sensors: as many
/// as there are positions, six at most, but `mode` at least. Modes that move none of the sensors, as the axial ones of
/// a beam, do not count. Frequencies are those of `[structure.modes]` where it gives them, and so are damping ratios,
/// which are unknown and zero elsewhere.
///
/// # Errors
/// Errors of the structure or the eigenproblem; positions outside the structure, or that do not distinguish the modes.
pub fn at_sensors(structure: &Structure, channels: &[Channel], mode: usize) -> Result<LinearModes, Failure> {
    let positions = positions(channels, SAME_PLACE * structure.length);
    let wanted = positions.len().min(MAX_MODES).max(mode);
    let elements = Elements::new(structure)?;
    let model = elements.assemble(&[])?;
    let imposed = imposed(structure, &model, None)?;
    let given = imposed.as_ref().map_or(&[] as &[usize], |imposed| &imposed.numbers).to_vec();
    let model = imposed.map_or(model, |imposed| imposed.model);
    let modes = linear_modes(model.mass(), model.stiffness(), 2 * wanted)?;
    let mut sensors = Vec::new();
    for position in &positions {
        // A sensor at an end is not left out for the last digit of its position.
        let end = if *position > 0.5 * structure.length { structure.length } else { 0.0 };
        let near = (position - end).abs() <= SAME_PLACE * structure.length;
        sensors.push(elements.displacement_at(&model, if near { end } else { *position })?);
    }
    let shape = |sensor: &[(usize, f64)], k: usize| -> f64 {
        sensor.iter().map(|(i, weight)| weight * modes.shapes[(*i, k)]).sum()
    };
    let moves = |k: &usize| {
        let largest = (0..model.dofs().len()).map(|i| modes.shapes[(i, *k)].abs()).fold(0.0, f64::max);
        sensors.iter().any(|sensor| shape(sensor, *k).abs() > STILL * largest)
    };
    let kept: Vec<usize> = (0..modes.omega.len()).filter(moves).take(wanted).collect();
    let shapes: Vec<Vec<f64>> = sensors.iter().map(|sensor| kept.iter().map(|k| shape(sensor, *k)).collect()).collect();
    let omegas: Vec<f64> = kept.iter().map(|k| modes.omega[*k]).collect();
    Ok(LinearModes::new(&positions, &omegas, &damping(structure, &given, &kept), &shapes)?)
}

/// Damping ratios of the modes `kept`, where frequencies are imposed on the modes `given`.
fn damping(structure: &Structure, given: &[usize], kept: &[usize]) -> Vec<f64> {
    let ratios = structure.modes.as_ref().and_then(|modes| modes.damping_ratios.as_ref());
    let of = |k: &usize| given.iter().position(|g| g == k).and_then(|i| ratios.and_then(|ratios| ratios.get(i)));
    kept.iter().map(|k| of(k).copied().unwrap_or(0.0)).collect()
}

/// Positions of the motion sensors, each once, ascending.
fn positions(channels: &[Channel], same: f64) -> Vec<f64> {
    let moving = channels.iter().filter(|channel| channel.quantity.time_derivative().is_some());
    let mut positions: Vec<f64> = moving.filter_map(|channel| channel.position).collect();
    positions.sort_by(f64::total_cmp);
    positions.dedup_by(|a, b| (*a - *b).abs() <= same);
    positions
}

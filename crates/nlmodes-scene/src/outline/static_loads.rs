//! Static loads, and where the structure rests under them.

use super::responses::place;
use super::{Row, list, row};
use crate::assemble::StaticState;
use crate::rule::counted;
use crate::scene::{BaseDirection, Direction, ForcePlace, Gravity, Scene, StaticForce, StructureKind, Thermal};
use crate::{number, short};
use nlmodes_io::ContactNodes;

/// Stops that are listed one by one.
const LISTED: usize = 12;

/// The rows of the loads and of the state at rest.
pub fn rows(scene: &Scene, state: Option<&StaticState>) -> Vec<Row> {
    let (loads, several) = (&scene.static_loads, scene.structure.bodies().len() > 1);
    let mut rows = Vec::new();
    let bends = scene.structure.bodies().iter().any(|body| body.kind() == StructureKind::Beam);
    rows.extend(loads.gravity.map(|of| row("gravity", gravity(of, bends))));
    let forces = loads.forces.iter().enumerate();
    rows.extend(forces.map(|(i, of)| row(format!("static {i}"), force(of, several))));
    rows.extend(loads.thermal.as_ref().map(|of| row("thermal", thermal(of))));
    rows.extend(loads.displacement.as_ref().map(|path| row("displaced", path.display().to_string())));
    rows.extend(state.into_iter().flat_map(|state| at_rest(state, !loads.is_empty())));
    rows
}

fn gravity(of: Gravity, bends: bool) -> String {
    match of.direction {
        BaseDirection::Along(direction) => {
            let side = if of.acceleration < 0.0 { "negative" } else { "positive" };
            let axial = match direction {
                Direction::Axial if bends => "; that it stiffens or softens bending is left out",
                _ => "",
            };
            let size = number(of.acceleration.abs());
            format!("{size} m/s², {}, to the {side} side{axial}", direction.name())
        }
        BaseDirection::Vector(direction) => format!("{} m/s² along [{}]", number(of.acceleration), list(&direction)),
    }
}

fn force(of: &StaticForce, several: bool) -> String {
    let at = match &of.at {
        ForcePlace::One(at) => place(at, several),
        ForcePlace::Nodes { nodes, direction } => {
            let nodes = match nodes {
                ContactNodes::Set(name) => format!("the nodes of `{name}`"),
                ContactNodes::Numbers(numbers) => counted(numbers.len(), "node"),
                ContactNodes::OfPairs => "pairs".to_owned(),
            };
            format!("{nodes} together along [{}]", list(direction))
        }
    };
    format!("{at}, {} N", number(of.force))
}

fn thermal(of: &Thermal) -> String {
    match of {
        Thermal::Strain { expansion, temperature } => {
            format!("{} K warmer, {} 1/K", number(*temperature), number(*expansion))
        }
        Thermal::Forces(path) => format!("forces of {}", path.display()),
    }
}

/// The free gap of each stop, and its force at rest if it is closed there.
fn at_rest(state: &StaticState, is_loaded: bool) -> Vec<Row> {
    let rest = &state.rest;
    let closed = rest.closed.iter().filter(|closed| **closed).count();
    let said = match closed {
        0 => "all stops are open".to_owned(),
        n if state.is_carried() => {
            format!("{} of {} closed, which carry the structure", n, counted(state.free_gaps.len(), "stop"))
        }
        n => format!("{} of {} closed", n, counted(state.free_gaps.len(), "stop")),
    };
    let stop = |(i, gap): (usize, &f64)| {
        // What contacts alone carry has no place under the loads without them.
        let (gap, where_) = match is_loaded && !state.is_carried() {
            true => (*gap, "under the loads with open stops"),
            false => (gap + state.toward(i), "in the drawing"),
        };
        let text = match (rest.closed.get(i), rest.forces.get(i)) {
            (Some(true), Some(force)) => format!("closed, {} N", short(*force)),
            (Some(false), _) => format!("open by {} m", short(rest.gaps[i])),
            _ => "not known, since the structure floats".to_owned(),
        };
        row("", format!("stop {i}: gap {} m {where_}; {text}", short(gap)))
    };
    let each = state.free_gaps.iter().enumerate().take(LISTED).map(stop);
    std::iter::once(row("at rest", said)).chain(each).collect()
}

//! What the files of a structure hold, so that wrong units and missing supports show.

use std::f64::consts::TAU;

use super::{Row, law, row};
use crate::assemble::OpenStructure;
use crate::memory::Effort;
use crate::number;
use crate::scene::{Matrices, Scene};
use nlmodes_io::{FeModel, NodeContact};

/// Frequencies that are said.
const FIRST: usize = 6;
/// Contacts that are said one by one.
const LISTED: usize = 12;

/// The rows of the structure and of its contacts.
pub fn rows(scene: &Scene, open: Option<&OpenStructure>) -> Vec<Row> {
    let (Some(matrices), Some(open)) = (scene.structure.matrices(), open) else { return Vec::new() };
    let Some((model, found)) = &open.files else { return Vec::new() };
    let mut lines = structure(matrices, model);
    lines.push(row("frequencies", frequencies(open)));
    lines.extend(contacts(found));
    let effort = Effort::of_reduction(model.n_dofs(), found.len(), open.modes.n_modes());
    lines.push(row("effort", format!("the reduction takes {}", effort.text())));
    lines
}

/// The row of the reduction.
pub fn reduction(scene: &Scene, open: &OpenStructure) -> Row {
    let (modes, highest) = (open.modes.n_modes(), number(rounded(open.highest_hz())));
    if open.modes.has_all_modes() {
        return row("reduction", format!("all {modes} open modes, up to {highest} Hz"));
    }
    let error = open.truncation_error(scene.method.mode, 0);
    let error = error.map_or_else(String::new, |error| {
        format!("; the first contact closed, half as many modes change the frequency by {error:.1e}")
    });
    row("reduction", format!("{modes} open modes up to {highest} Hz and the static flexibility of all others{error}"))
}

/// To six digits.
fn rounded(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

fn structure(matrices: &Matrices, model: &FeModel) -> Vec<Row> {
    let files = &matrices.files;
    let (inner, nodes) = (model.nodes_without_place().len(), model.nodes().len());
    let within =
        if inner == 0 { String::new() } else { format!(", {inner} of them without a place (within elements)") };
    let [x, y, z] = model.mass_along_axes().map(|mass| number(rounded(mass)));
    let mut lines = vec![
        row("stiffness", format!("{}, {} entries in a triangle", files.stiffness, model.stiffness.n_entries())),
        row("mass", format!("{}, {} entries in a triangle", files.mass, model.mass.n_entries())),
        row("units", format!("{} in the files, SI from here on", files.units)),
        row("unknowns", format!("{} degrees of freedom of {nodes} nodes{within}", model.n_dofs())),
        row("fixed", format!("{} degrees of freedom, by `fixed` or the files", model.fixed.len())),
        row("free mass", format!("{x} kg along x, {y} kg along y, {z} kg along z")),
    ];
    lines.extend(model.mesh.as_ref().map(|mesh| {
        let side = |axis: usize| {
            let values = || mesh.places.iter().map(|place| place[axis]);
            number(rounded(values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)))
        };
        let size = format!("{} × {} × {} m", side(0), side(1), side(2));
        row("mesh", format!("{} nodes, {} elements, {size}", mesh.numbers.len(), mesh.elements.len()))
    }));
    lines
}

/// The first frequencies; those at zero are rigid-body motions.
fn frequencies(open: &OpenStructure) -> String {
    let squares = open.modes.omega_squared();
    let hz: Vec<f64> = squares.iter().take(FIRST).map(|square| square.max(0.0).sqrt() / TAU).collect();
    let list: Vec<String> = hz.iter().map(|hz| number(rounded(*hz))).collect();
    let highest = open.highest_hz();
    let rigid = hz.iter().filter(|hz| **hz < 1e-4 * highest).count();
    let floating = format!("; the first {rigid} are rigid-body motions: nothing holds the structure there");
    let floats = open.modes.floats() && rigid > 0;
    format!("{} Hz, contacts open{}", list.join(", "), if floats { floating.as_str() } else { "" })
}

fn contacts(contacts: &[NodeContact]) -> Vec<Row> {
    let gaps = || contacts.iter().map(|contact| contact.gap);
    let (low, high) = (gaps().fold(f64::MAX, f64::min), gaps().fold(f64::MIN, f64::max));
    let [low, high] = [low, high].map(|gap| number(rounded(gap)));
    let mut lines = vec![row("contacts", format!("{}, gaps from {low} to {high} m", contacts.len()))];
    lines.extend(contacts.iter().take(LISTED).map(contact));
    if contacts.len() > LISTED {
        lines.push(row("", format!("and {} more", contacts.len() - LISTED)));
    }
    lines
}

fn contact(contact: &NodeContact) -> Row {
    let [x, y, z] = contact.normal.map(|n| number(rounded(n)));
    let against = contact.against.map_or_else(|| "a wall".to_owned(), |node| format!("node {node}"));
    let law = law(contact.stiffness);
    let gap = number(rounded(contact.gap));
    row("", format!("node {} before {against}, normal [{x}, {y}, {z}], gap {gap} m, {law}", contact.node))
}

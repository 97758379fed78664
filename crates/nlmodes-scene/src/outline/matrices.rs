//! What the files of a structure hold, so that wrong units and missing supports show.

mod stops;

use std::collections::HashSet;
use std::f64::consts::TAU;

use super::structure::hertz;
use super::{Row, law, row};
use crate::assemble::OpenStructure;
use crate::doubts::unplaced_unknowns;
use crate::memory::Effort;
use crate::rule::counted;
use crate::rule::percent;
use crate::scene::{Matrices, Scene};
use crate::short;
use nlmodes_io::{ContactChoice, ContactNodes, FeModel, Mesh, NodeContact, Partner};

/// Frequencies that are reported.
pub(super) const FIRST: usize = 6;
/// Share of a frequency below which nobody asks what digits leave open of it.
const NOTHING: f64 = 1e-6;
/// Contacts that are listed one by one.
pub(super) const LISTED: usize = 12;

/// The rows of the structure and of its contacts.
pub fn rows(scene: &Scene, open: Option<&OpenStructure>) -> Vec<Row> {
    let (Some(matrices), Some(open)) = (scene.structure.matrices(), open) else { return Vec::new() };
    let Some((model, found)) = &open.files else { return Vec::new() };
    let mut lines = structure(matrices, model);
    lines.push(row("frequencies", frequencies(scene, open)));
    lines.extend(left_open(scene, open, model));
    lines.extend(contacts(matrices, model, found));
    let effort = Effort::of_reduction(model.n_dofs(), found.len(), open.modes.n_modes());
    lines.push(row("effort", format!("the reduction takes {}", effort.text())));
    lines
}

/// The row of the reduction.
pub fn reduction(scene: &Scene, open: &OpenStructure) -> Row {
    let (modes, highest) = (open.modes.n_modes(), short(open.highest_hz()));
    if open.modes.has_all_modes() {
        return row("reduction", format!("all {modes} open modes, up to {highest} Hz"));
    }
    let error = open.truncation_error(scene.method.mode, 0);
    let error = error.map_or_else(String::new, |error| {
        format!("; the first contact closed, half as many modes change the frequency by {error:.1e}")
    });
    row("reduction", format!("{modes} open modes up to {highest} Hz and the static flexibility of all others{error}"))
}

fn structure(matrices: &Matrices, model: &FeModel) -> Vec<Row> {
    let files = &matrices.files;
    let (inner, nodes) = (model.nodes_without_place().len(), model.nodes().len());
    let within =
        if inner == 0 { String::new() } else { format!(", {inner} of them without a place (within elements)") };
    let units = match matrices.units_are_assumed {
        true => format!("{} assumed, since `structure.units` is left out", files.units),
        false => format!("{} in the files, SI from here on", files.units),
    };
    let mut lines = vec![
        row("stiffness", format!("{}, {} entries in a triangle", files.stiffness, model.stiffness.n_entries())),
        row("mass", format!("{}, {} entries in a triangle", files.mass, model.mass.n_entries())),
        row("units", units),
        row("unknowns", format!("{} degrees of freedom of {}{within}", model.n_dofs(), counted(nodes, "node"))),
        row("fixed", fixed(model)),
        row("free mass", free_mass(matrices, model)),
    ];
    lines.extend(model.mesh.as_ref().map(|mesh| {
        let side = |axis: usize| {
            let values = || mesh.places.iter().map(|place| place[axis]);
            short(values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min))
        };
        let size = format!("{} × {} × {} m", side(0), side(1), side(2));
        row(
            "mesh",
            format!("{}, {}, {size}", counted(mesh.numbers.len(), "node"), counted(mesh.elements.len(), "element")),
        )
    }));
    lines
}

/// What has no row: CalculiX and Ansys leave out what they hold, and only a mesh tells of it.
fn fixed(model: &FeModel) -> String {
    let rows: HashSet<u64> = model.labels.iter().map(|label| label.node).collect();
    let in_elements = |mesh: &Mesh| {
        let named: HashSet<u32> = mesh.elements.iter().flat_map(|element| element.nodes.iter().copied()).collect();
        named.into_iter().filter(|index| !rows.contains(&mesh.numbers[*index as usize])).count()
    };
    let missing = model.mesh.as_ref().map(in_elements);
    let level = match model.held_on_diagonals.len() {
        0 => String::new(),
        n => format!(", {n} of them by equal values on both diagonals"),
    };
    match (model.fixed.len(), missing) {
        (0, Some(0)) => "each node of the mesh has rows, and `fixed` holds none".into(),
        (0, Some(n)) => format!(
            "{} of the mesh without rows: held by the files, or dependent on others; none by `fixed`",
            counted(n, "node")
        ),
        (0, None) => "none by `fixed`; what the program eliminated before it wrote the files has no rows".into(),
        (1, _) => format!("1 degree of freedom, by `fixed` or the files{level}"),
        (n, _) => format!("{n} degrees of freedom, by `fixed` or the files{level}"),
    }
}

fn free_mass(matrices: &Matrices, model: &FeModel) -> String {
    if let Some(silent) = unplaced_unknowns(&matrices.files, model) {
        let nodes = model.nodes().len();
        return format!(
            "not known without a mesh: the rows of {silent} of {nodes} nodes do not answer a rigid displacement, as \
            unknowns within elements (C3D8I)"
        );
    }
    let [x, y, z] = model.mass_along_axes().map(short);
    format!("{x} kg along x, {y} kg along y, {z} kg along z")
}

/// The first frequencies, behind the motions that strain nothing.
pub(super) fn frequencies(scene: &Scene, open: &OpenStructure) -> String {
    let (squares, count) = (open.modes.omega_squared(), open.strainless.count());
    let listed = |omega: &mut dyn Iterator<Item = f64>| {
        omega.take(FIRST).map(|omega| short(omega / TAU)).collect::<Vec<_>>().join(", ")
    };
    let open_hz = listed(&mut squares.iter().skip(count).map(|square| square.max(0.0).sqrt()));
    let rest = open.about_rest(scene).ok().flatten();
    let rest = rest.map_or_else(String::new, |omega| format!("; {} Hz about the rest", listed(&mut omega.into_iter())));
    let elastic = format!("{open_hz} Hz, contacts open{rest}");
    if count == 0 {
        return elastic;
    }
    let nodes: Vec<String> = open.strainless.floating.iter().take(LISTED).map(u64::to_string).collect();
    let bodies = match nodes.len() {
        0 => String::new(),
        1 => format!(" (the body of node {})", nodes[0]),
        _ => format!(" (the bodies of nodes {})", nodes.join(", ")),
    };
    let unseen = open.strainless.unseen_text().map_or_else(String::new, |text| format!(" ({text})"));
    format!(
        "{}, nothing holds the structure there{bodies}{unseen}; from mode {} on {elastic}",
        open.strainless.text(),
        count + 1
    )
}

/// What the digits of the files leave open of the mode that is computed, or of the first that strains something; and
/// what has neither stiffness nor mass.
fn left_open(scene: &Scene, open: &OpenStructure, model: &FeModel) -> Vec<Row> {
    let mode = scene.method.mode.max(open.strainless.count() + 1);
    let mut rows = Vec::new();
    if let Some(share) = open.modes.left_open(mode).filter(|share| *share > NOTHING) {
        rows.push(row(
            "digits",
            format!(
                "the stiffness is known to {}, which leaves mode {mode} open by ±{}",
                model.digits[0],
                percent(share)
            ),
        ));
    }
    let hourglass = open.modes.hourglass_motions();
    if hourglass > 0 {
        let motions = counted(hourglass, "motion");
        let text = format!("{motions} with neither stiffness nor mass left out, since no contact feels them");
        rows.push(row("hourglass", text));
    }
    rows
}

fn contacts(matrices: &Matrices, model: &FeModel, contacts: &[NodeContact]) -> Vec<Row> {
    let first = matrices.contacts.len();
    let numbered = matrices.law_contacts.iter().enumerate();
    let laws: Vec<Row> = numbered.map(|(i, law)| row(format!("contact {}", first + i), hertz(&law.hertz))).collect();
    if contacts.is_empty() {
        return if laws.is_empty() { vec![row("contacts", "none".to_owned())] } else { laws };
    }
    let gaps = || contacts.iter().map(|contact| contact.gap);
    let (low, high) = (gaps().fold(f64::MAX, f64::min), gaps().fold(f64::MIN, f64::max));
    let [low, high] = [low, high].map(short);
    let together: f64 = contacts.iter().filter_map(|contact| contact.stiffness).sum();
    let springs = match contacts.len() > 1 && together > 0.0 {
        true => format!("; springs of {} N/m together", short(together)),
        false => String::new(),
    };
    let mut lines = vec![row("contacts", format!("{}, gaps from {low} to {high} m{springs}", contacts.len()))];
    lines.extend(sets(matrices, model));
    lines.extend(contacts.iter().take(LISTED).enumerate().map(|(stop, of)| row("", contact(stop, model, of))));
    if contacts.len() > LISTED {
        lines.push(row("", format!("and {} more; all of them:", contacts.len() - LISTED)));
        lines.extend(stops::lines(contacts).into_iter().map(|line| row("", line)));
    }
    lines.extend(laws);
    lines
}

/// Sets of nodes of which some cannot touch.
fn sets(matrices: &Matrices, model: &FeModel) -> Vec<Row> {
    let names = |choice: &ContactChoice| {
        let partner = match &choice.partner {
            Partner::Nearest(nodes, _) => Some(nodes.clone()),
            Partner::Wall | Partner::Table(_) => None,
        };
        [Some(choice.nodes.clone()), partner]
    };
    let set = |(i, name): (usize, ContactNodes)| {
        let ContactNodes::Set(name) = name else { return None };
        let (all, without) = model.size_of_set(&name).filter(|(_, without)| *without > 0)?;
        let text = format!(
            "contact {i}: {without} of {all} nodes of `{name}` have no rows, being fixed or dependent on others, and \
            are left out"
        );
        Some(row("", text))
    };
    let choices = matrices.contacts.iter().enumerate();
    choices
        .flat_map(|(i, choice)| names(choice).into_iter().flatten().map(move |name| (i, name)))
        .filter_map(set)
        .collect()
}

fn contact(stop: usize, model: &FeModel, contact: &NodeContact) -> String {
    let [x, y, z] = contact.normal.map(short);
    let against = contact.against.map_or_else(|| "a wall".to_owned(), |node| format!("node {node}"));
    let law = law(contact.stiffness);
    let gap = short(contact.gap);
    let drawn = contact.distance_in(model).map_or_else(String::new, |distance| {
        // Distances that are nothing but rounding of places are none.
        let distance = if distance.abs() < 1e-12 { 0.0 } else { distance };
        format!("; {} m in the mesh", short(distance))
    });
    format!("stop {stop}: node {} before {against}, normal [{x}, {y}, {z}], gap {gap} m, {law}{drawn}", contact.node)
}

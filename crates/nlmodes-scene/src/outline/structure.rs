//! What the scene of a structure would compute.

use super::{Row, law, list, matrices, reduced, responses, row, springs, static_loads, transient};
use crate::assemble::{OpenStructure, StaticState};
use crate::number;
use crate::rule::{counted, significant};
use crate::scene::{
    AtBranchPoint, Contact, GroundSpring, Hertz, ImposedModes, InternalResonance, MethodKind, Scene, Section, Segment,
    SpringDirection, Start, Structure, Updating,
};

/// Structure, stops, method, branch or responses.
pub fn rows(scene: &Scene, open: Option<&OpenStructure>, state: Option<&StaticState>) -> Vec<Row> {
    let mut rows = Vec::new();
    let bodies = scene.structure.bodies();
    for (i, body) in bodies.iter().enumerate() {
        let name =
            if scene.structure.straight().is_some() { "structure".to_owned() } else { format!("structure {}", i + 1) };
        rows.extend(straight(&name, body));
    }
    rows.extend(matrices::rows(scene, open));
    rows.extend(reduced::rows(scene, open));
    for (i, contact) in scene.contacts.iter().enumerate() {
        rows.push(row(format!("contact {i}"), stop(contact, bodies.len() > 1)));
    }
    rows.extend(springs::rows(scene));
    rows.extend(static_loads::rows(scene, state));
    rows.extend(scene.updating.as_ref().map(|updating| row("updating", fitted(updating))));
    rows.extend(open.filter(|_| !bodies.is_empty()).map(|open| row("frequencies", matrices::frequencies(scene, open))));
    rows.extend(open.map(|open| matrices::reduction(scene, open)));
    if scene.transient.is_none() {
        rows.push(row("method", method(scene)));
    }
    if scene.responses.is_empty() && scene.transient.is_none() {
        let closed = state.map_or(&[][..], |state| &state.rest.closed);
        let reference = match (closed.contains(&true), closed.contains(&false)) {
            (true, true) => "lift-off or grazing",
            (true, false) => "lift-off",
            _ => "grazing",
        };
        rows.push(row("branch", branch(scene, reference)));
    }
    rows.extend(responses::rows(scene));
    rows.extend(transient::rows(scene));
    rows.push(row("results", scene.output_directory.display().to_string()));
    rows
}

fn straight(name: &str, of: &Structure) -> Vec<Row> {
    let mut rows = vec![row(name, structure(of))];
    rows.extend(of.segments.iter().map(|segment| row("segment", self::segment(segment))));
    rows.extend(of.modes.as_ref().map(|modes| row("modes", imposed(modes))));
    rows.push(mass(of));
    rows.push(row("supports", format!("start {}, end {}", of.start.name(), of.end.name())));
    rows.extend(of.springs.iter().map(|spring| row("", self::spring(spring, of))));
    rows.push(row("mesh", mesh(of)));
    rows
}

fn structure(structure: &Structure) -> String {
    let (modulus, density) = (number(structure.youngs_modulus), number(structure.density));
    let length = number(structure.length);
    match structure.section {
        Section::Rod { area } => {
            let added = added(structure.added_mass);
            format!("rod, {length} m long, {} m² of {modulus} Pa and {density} kg/m³{added}", number(area))
        }
        Section::Beam { area, second_moment, .. } => format!(
            "beam, {length} m long, {} m² and {} m⁴ of {modulus} Pa and {density} kg/m³{}",
            number(area),
            number(second_moment),
            added(structure.added_mass)
        ),
    }
}

fn segment(segment: &Segment) -> String {
    let (modulus, density) = (number(segment.youngs_modulus), number(segment.density));
    let section = match segment.section {
        Section::Rod { area } => format!("{} m²", number(area)),
        Section::Beam { area, second_moment, .. } => format!("{} m² and {} m⁴", number(area), number(second_moment)),
    };
    let to = number(segment.to);
    format!(
        "to {to} m (node {}), {section} of {modulus} Pa and {density} kg/m³{}",
        segment.to_node,
        added(segment.added_mass)
    )
}

/// The mass of all parts, and the point masses among them.
fn mass(of: &Structure) -> Row {
    let points: Vec<String> =
        of.mass_points.iter().map(|point| format!("{} kg at {} m", number(point.mass), number(point.at))).collect();
    let of_points = if points.is_empty() { String::new() } else { format!(", of which {}", points.join(", ")) };
    row("mass", format!("{} kg{of_points}", significant(of.total_mass(), 5)))
}

fn spring(spring: &GroundSpring, of: &Structure) -> String {
    let at = of
        .mesh()
        .ok()
        .and_then(|mesh| mesh.nodes().get(spring.node).copied())
        .map_or_else(String::new, |at| format!(" at {} m", number(at)));
    let unit = if spring.direction == SpringDirection::Rotation { "N m" } else { "N/m" };
    format!("spring of {} {unit}{at}, {}", number(spring.stiffness), spring.direction.name())
}

fn added(mass: f64) -> String {
    if mass > 0.0 { format!(", {} kg/m added", number(mass)) } else { String::new() }
}

fn imposed(modes: &ImposedModes) -> String {
    let damping = modes.damping_ratios.as_deref().map_or_else(String::new, |ratios| {
        format!("; damping ratios {}, which only a virtual test uses", list(ratios))
    });
    format!(
        "a modal model: {} Hz imposed on the lowest {}{damping}",
        list(&modes.frequencies_hz),
        modes.frequencies_hz.len()
    )
}

fn mesh(structure: &Structure) -> String {
    let elements = match structure.all_elements() {
        1 => "1 element,".into(),
        n => format!("{n} elements,"),
    };
    let grading = match structure.grading {
        1.0 => "of equal length".into(),
        grading => format!("the first {} times as long as the last", number(grading)),
    };
    let dofs = structure.free_dofs();
    let fitted = if structure.nodes.is_some() { ", but with nodes at stops and parts" } else { "" };
    let refined = structure.refined.as_ref().map_or_else(String::new, |refined| {
        let nodes = counted(refined.beside.len(), "node");
        format!(", but {} times shorter beside {nodes} with stops", number(refined.factor))
    });
    format!("{elements} {grading}{fitted}{refined}; {dofs} degrees of freedom; {} mass", structure.mass_matrix.name())
}

/// A law of force of a stop.
pub fn hertz(law: &Hertz) -> String {
    let &Hertz { stiffness, exponent, dissipation } = law;
    let dissipation =
        if dissipation > 0.0 { format!(", dissipation {} s/m", number(dissipation)) } else { String::new() };
    format!("{} N times power {} of the approach{dissipation}", number(stiffness), number(exponent))
}

fn stop(contact: &Contact, several: bool) -> String {
    let law = match contact.hertz {
        None => law(contact.stiffness),
        Some(law) => hertz(&law),
    };
    if let Some(other) = contact.against {
        return format!(
            "structure {} at {} m before structure {} at {} m, {}, on the {} side, gap {} m, {law}",
            contact.structure + 1,
            number(contact.at),
            other.structure + 1,
            number(other.at),
            contact.direction.name(),
            contact.side.name(),
            number(contact.gap)
        );
    }
    let of = if several { format!("structure {} at ", contact.structure + 1) } else { String::new() };
    format!(
        "{of}{} m (node {}), {}, on the {} side, gap {} m, {law}",
        number(contact.at),
        contact.node,
        contact.direction.name(),
        contact.side.name(),
        number(contact.gap)
    )
}

fn fitted(updating: &Updating) -> String {
    let names: Vec<&str> = updating.parameters.iter().map(|p| p.name()).collect();
    let modes = updating.modes.iter().zip(&updating.frequencies_hz);
    let modes: Vec<String> = modes.map(|(mode, hz)| format!("mode {mode} at {} Hz", number(*hz))).collect();
    format!("{} from {}", names.join(", "), modes.join(", "))
}

fn method(scene: &Scene) -> String {
    let method = &scene.method;
    let kind = match method.kind {
        MethodKind::MsHbm => "mixed shooting-harmonic balance",
        MethodKind::Hbm => "harmonic balance",
        MethodKind::Shooting => "exact shooting",
    };
    let list: Vec<String> = method.harmonics_list.iter().map(usize::to_string).collect();
    let chosen = method.accuracy.map(|accuracy| {
        let modes = if method.held_modes.is_some() { "" } else { " and held modes" };
        let (few, most) = (method.harmonics, accuracy.max_harmonics);
        format!("{few} to {most} harmonics{modes}, chosen for a relative error of {}", number(accuracy.error))
    });
    let harmonics = if let Some(chosen) = chosen {
        chosen
    } else if method.harmonics == 1 {
        "1 harmonic".into()
    } else {
        format!("{} harmonics", list.join(", "))
    };
    format!(
        "{kind}, {harmonics}, {} switching ({} samples), contact mass: {}, solver {}",
        method.switching.name(),
        method.samples,
        if scene.is_in_open_modes() { "kept" } else { method.mass_redistribution.name() },
        method.contact_solver.name()
    )
}

fn branch(scene: &Scene, reference: &str) -> String {
    let (continuation, mode) = (&scene.continuation, scene.method.mode);
    let from = match continuation.start() {
        Start::Grazing => format!("from {reference}"),
        Start::Frequency { hz, direction } => format!("from {} Hz, {}", number(hz), direction.name()),
        Start::Energy { ratio, direction } => {
            format!("from {} times the {reference} energy, {}", number(ratio), direction.name())
        }
    };
    let ratio = scene.max_energy_ratio(continuation.frequency_hz.is_some());
    let energy = Some(format!("to {} times the {reference} energy", number(ratio)));
    let window = continuation.frequency_hz.map(|[low, high]| format!("within {} to {} Hz", number(low), number(high)));
    let points = format!("at most {} points", continuation.max_points);
    let arms = match continuation.at_branch_point {
        AtBranchPoint::Stay => None,
        AtBranchPoint::Switch => Some("onto another half-branch at branch points".to_owned()),
        AtBranchPoint::All => {
            Some(format!("all half-branches of branch points, at most {} branches", continuation.max_branches))
        }
    };
    let tongues = match continuation.internal_resonance {
        InternalResonance::Auto => None,
        InternalResonance::Follow => Some("internal-resonance branches followed".to_owned()),
        InternalResonance::Skip => Some("internal-resonance branches skipped".to_owned()),
    };
    let parts: Vec<String> = [Some(format!("mode {mode} {from}")), energy, window, Some(points), arms, tongues]
        .into_iter()
        .flatten()
        .collect();
    parts.join(", ")
}

use nlmodes_fem::Mesh;

use super::section::section;
use crate::raw::{RawMaterial, RawSegment, RawStructure};
use crate::rule::number;
use crate::scene::{Section, Segment, Structure, Support};
use crate::{Diagnostic, Diagnostics};

use super::nodes::{Nodes, beside, node_at};
use super::parts::Fixed;
use super::response::own_damping;

/// The checked structure with its nodes and what is fixed to these.
pub fn check(
    raw: &RawStructure,
    nodes: &Nodes,
    fixed: &Fixed<'_>,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<Structure> {
    let section = section("structure.section", &raw.section, raw.kind, &raw.material, diagnostics);
    raw.modes.iter().for_each(|modes| super::modes::check(modes, diagnostics));
    let mass_points = super::parts::masses(raw, &fixed.masses, &nodes.mesh, diagnostics);
    let springs = super::parts::springs(raw, &fixed.springs, &nodes.mesh, diagnostics);
    let damping = raw.damping.as_ref().and_then(|written| own_damping(written, diagnostics));
    let segments = segments(raw, section, &nodes.mesh, diagnostics);
    Some(Structure {
        length: raw.length_m,
        elements: nodes.elements,
        grading: raw.grading.unwrap_or(1.0),
        mass_matrix: raw.mass_matrix.unwrap_or_default(),
        start: raw.start,
        end: raw.end.unwrap_or(Support::Free),
        youngs_modulus: raw.material.youngs_modulus_pa,
        density: raw.material.density_kg_m3,
        section: section?,
        added_mass: raw.added_mass_kg_m.unwrap_or(0.0),
        segments: segments?,
        nodes: nodes.nodes.clone(),
        refined: nodes.refined.clone(),
        mass_points,
        springs,
        modes: raw.modes.clone(),
        damping,
    })
}

/// Says that a single structure has no damping of its own.
pub fn alone(raw: &RawStructure, diagnostics: &mut Diagnostics<'_>) {
    if raw.damping.is_some() {
        let diagnostic = Diagnostic::error("`structure.damping` is for scenes of several structures");
        diagnostics.put("structure.damping", diagnostic, "expected a table [damping] beside [structure]");
    }
}

/// The segments, each behind the one before; `None` if one of them is not sound.
fn segments(
    raw: &RawStructure,
    own: Option<Section>,
    mesh: &Mesh,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<Vec<Segment>> {
    let (mut sound, mut from) = (Some(Vec::new()), 0);
    for (i, found) in raw.segment.iter().flatten().enumerate() {
        let to_node = end(i, found, from, mesh, diagnostics);
        from = to_node.unwrap_or(from);
        let segment = segment(i, found, raw, own, diagnostics);
        let segment =
            segment.zip(to_node).map(|(segment, to_node)| Segment { to_node, to: mesh.nodes()[to_node], ..segment });
        match (&mut sound, segment) {
            (Some(all), Some(segment)) => all.push(segment),
            _ => sound = None,
        }
    }
    sound
}

/// The node at which segment `i` ends.
fn end(i: usize, raw: &RawSegment, from: usize, mesh: &Mesh, diagnostics: &mut Diagnostics<'_>) -> Option<usize> {
    let path = format!("structure.segment.{i}.to_m");
    let to = raw.to_m;
    let Some(node) = node_at(mesh, to) else {
        let [low, high] = beside(mesh, to).map(|node| number(mesh.nodes()[node]));
        let diagnostic = Diagnostic::error(format!("`{path}` is beyond the structure, or too near to another node"));
        let label = format!("found {}, expected the position of a node: {low} or {high} m", diagnostics.written(&path));
        diagnostics.put(&path, diagnostic, label);
        return None;
    };
    if node <= from {
        let diagnostic = Diagnostic::error(format!("`{path}` is not behind the end of the segment before"));
        diagnostics.put(&path, diagnostic, format!("expected more than {} m", number(mesh.nodes()[from])));
        return None;
    }
    Some(node)
}

/// What segment `i` is made of; its end is still open.
fn segment(
    i: usize,
    raw: &RawSegment,
    structure: &RawStructure,
    own: Option<Section>,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<Segment> {
    let material = raw.material.as_ref().unwrap_or(&structure.material);
    let path = format!("structure.segment.{i}.section");
    let section = match &raw.section {
        Some(found) => section(&path, found, structure.kind, material, diagnostics),
        None => own.map(|own| with_poissons_ratio(own, material)),
    };
    Some(Segment {
        to_node: 0,
        to: 0.0,
        youngs_modulus: material.youngs_modulus_pa,
        density: material.density_kg_m3,
        section: section?,
        added_mass: raw.added_mass_kg_m.or(structure.added_mass_kg_m).unwrap_or(0.0),
    })
}

/// The section of the structure in a material of its own.
fn with_poissons_ratio(own: Section, material: &RawMaterial) -> Section {
    match (own, material.poissons_ratio) {
        (Section::Beam { area, second_moment, shear_factor, outer_fibre, .. }, Some(poissons_ratio)) => {
            Section::Beam { area, second_moment, shear_factor, poissons_ratio, outer_fibre }
        }
        (own, _) => own,
    }
}

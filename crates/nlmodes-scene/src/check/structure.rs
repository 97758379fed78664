use nlmodes_fem::Mesh;

use super::section::section;
use crate::raw::{RawMaterial, RawSegment, RawStructure};
use crate::rule::number;
use crate::scene::{MassMatrix, Section, Segment, Structure, Support};
use crate::{Findings, Problem};

use super::nodes::{Nodes, beside, node_at};
use super::parts::Fixed;
use super::response::own_damping;

/// The checked structure with its nodes and what is fixed to these.
pub fn check(
    raw: &RawStructure,
    nodes: Option<&Nodes>,
    fixed: &Fixed<'_>,
    findings: &mut Findings<'_>,
) -> Option<Structure> {
    let own = raw.section.as_ref().zip(raw.kind);
    let section =
        own.and_then(|(found, kind)| section("structure.section", found, kind, raw.material.as_ref(), findings));
    let modes = raw.modes.as_ref().map(|modes| super::modes::check(modes, findings));
    let masses = nodes.map(|nodes| super::parts::masses(raw, &fixed.masses, &nodes.mesh, findings));
    let springs = nodes.map(|nodes| super::parts::springs(raw, &fixed.springs, &nodes.mesh, findings));
    let damping = raw.damping.as_ref().map(|written| own_damping(written, findings));
    let segments = match nodes {
        Some(nodes) => segments(raw, section, &nodes.mesh, findings),
        None => Some(Vec::new()),
    };
    let material = raw.material.as_ref()?;
    Some(Structure {
        length: raw.length_m?,
        elements: raw.elements? as usize,
        grading: raw.grading.unwrap_or(1.0),
        mass_matrix: raw.mass_matrix.unwrap_or(MassMatrix::Consistent),
        start: raw.start?,
        end: raw.end.unwrap_or(Support::Free),
        youngs_modulus: material.youngs_modulus_pa?,
        density: material.density_kg_m3?,
        section: section?,
        added_mass: raw.added_mass_kg_m.unwrap_or(0.0),
        segments: segments?,
        refined: nodes.and_then(|nodes| nodes.refined.clone()),
        mass_points: masses.unwrap_or_default(),
        springs: springs.unwrap_or_default(),
        modes: match modes {
            Some(modes) => Some(modes?),
            None => None,
        },
        damping: match damping {
            Some(damping) => Some(damping?),
            None => None,
        },
    })
}

/// Says that a structure that stands alone has no damping of its own.
pub fn alone(raw: &RawStructure, findings: &mut Findings<'_>) {
    if raw.damping.is_some() {
        let problem = Problem::error("`structure.damping` is for scenes of several structures");
        findings.put("structure.damping", problem, "expected a table [damping] beside [structure]");
    }
}

/// The segments, each behind the one before; `None` if one of them is not sound.
fn segments(
    raw: &RawStructure,
    own: Option<Section>,
    mesh: &Mesh,
    findings: &mut Findings<'_>,
) -> Option<Vec<Segment>> {
    let (mut sound, mut from) = (Some(Vec::new()), 0);
    for (i, found) in raw.segment.iter().flatten().enumerate() {
        let to_node = end(i, found, from, mesh, findings);
        from = to_node.unwrap_or(from);
        let segment = segment(i, found, raw, own, findings);
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
fn end(i: usize, raw: &RawSegment, from: usize, mesh: &Mesh, findings: &mut Findings<'_>) -> Option<usize> {
    let path = format!("structure.segment.{i}.to_m");
    let to = raw.to_m?;
    let Some(node) = node_at(mesh, to) else {
        let [low, high] = beside(mesh, to).map(|node| number(mesh.nodes()[node]));
        let problem = Problem::error(format!("`{path}` is not at a node of the mesh"));
        let label = format!("found {}, expected the position of a node: {low} or {high} m", findings.written(&path));
        findings.put(&path, problem, label);
        return None;
    };
    if node <= from {
        let problem = Problem::error(format!("`{path}` is not behind the end of the segment before"));
        findings.put(&path, problem, format!("expected more than {} m", number(mesh.nodes()[from])));
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
    findings: &mut Findings<'_>,
) -> Option<Segment> {
    let material = raw.material.as_ref().or(structure.material.as_ref());
    let path = format!("structure.segment.{i}.section");
    let section = match &raw.section {
        Some(found) => section(&path, found, structure.kind?, material, findings),
        None => own.map(|own| with_poissons_ratio(own, material)),
    };
    Some(Segment {
        to_node: 0,
        to: 0.0,
        youngs_modulus: material?.youngs_modulus_pa?,
        density: material?.density_kg_m3?,
        section: section?,
        added_mass: raw.added_mass_kg_m.or(structure.added_mass_kg_m).unwrap_or(0.0),
    })
}

/// The section of the structure in a material of its own.
fn with_poissons_ratio(own: Section, material: Option<&RawMaterial>) -> Section {
    match (own, material.and_then(|material| material.poissons_ratio)) {
        (Section::Beam { area, second_moment, shear_factor, .. }, Some(poissons_ratio)) => {
            Section::Beam { area, second_moment, shear_factor, poissons_ratio }
        }
        (own, _) => own,
    }
}

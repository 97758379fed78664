//! Point masses and springs of rods and beams.

use nlmodes_fem::Mesh;

use super::nodes::{beside, node_at};
use crate::raw::RawStructure;
use crate::rule::number;
use crate::scene::{Direction, GroundSpring, MassPoint, SpringDirection, StructureKind, Support, holds};
use crate::{Findings, Problem};

/// The point masses that are sound.
pub fn masses(raw: &RawStructure, mesh: &Mesh, findings: &mut Findings<'_>) -> Vec<MassPoint> {
    let mut sound = Vec::new();
    for (i, point) in raw.mass_point.iter().flatten().enumerate() {
        let path = format!("structure.mass_point.{i}");
        let Some(node) = point.at_m.and_then(|at| node(&path, at, mesh, findings)) else { continue };
        let inertia = point.inertia_kg_m2.unwrap_or(0.0);
        if inertia > 0.0 && raw.kind == Some(StructureKind::Rod) {
            let path = format!("{path}.inertia_kg_m2");
            let problem = Problem::warning(format!("`{path}` has no effect"));
            findings.put(&path, problem, "a rod does not turn");
        }
        if is_clamped(raw, node, mesh) {
            let path = format!("{path}.at_m");
            let problem = Problem::error(format!("`{path}` is at an end that does not move"));
            findings.put(&path, problem, "expected a node that moves");
            continue;
        }
        sound.extend(point.mass_kg.map(|mass| MassPoint { node, mass, inertia }));
    }
    sound
}

/// The springs that are sound.
pub fn springs(raw: &RawStructure, mesh: &Mesh, findings: &mut Findings<'_>) -> Vec<GroundSpring> {
    let mut sound = Vec::new();
    for (i, spring) in raw.spring.iter().flatten().enumerate() {
        let path = format!("structure.spring.{i}");
        let node = spring.at_m.and_then(|at| node(&path, at, mesh, findings));
        let (Some(node), Some(direction), Some(kind)) = (node, spring.direction, raw.kind) else { continue };
        if kind == StructureKind::Rod && direction != SpringDirection::Axial {
            let path = format!("{path}.direction");
            let problem = Problem::error(format!("`{path}` cannot be \"{}\" on a rod", direction.name()));
            findings.put(&path, problem.help("a rod moves along its axis only"), "expected \"axial\"");
            continue;
        }
        let (key, unused) = match direction {
            SpringDirection::Rotation => ("stiffness_nm", "stiffness_n_m"),
            _ => ("stiffness_n_m", "stiffness_nm"),
        };
        if findings.has(&format!("{path}.{unused}")) {
            let path = format!("{path}.{unused}");
            let problem = Problem::error(format!("`{path}` does not belong to direction = \"{}\"", direction.name()));
            findings.put(&path, problem, format!("expected `{key}`"));
            continue;
        }
        if is_held(raw, node, direction, mesh) {
            let path = format!("{path}.at_m");
            let problem = Problem::error(format!("`{path}` is at an end that does not move"));
            findings.put(&path, problem, "expected a node that moves in this direction");
            continue;
        }
        let stiffness = if key == "stiffness_nm" { spring.stiffness_nm } else { spring.stiffness_n_m };
        sound.extend(stiffness.map(|stiffness| GroundSpring { node, direction, stiffness }));
    }
    sound
}

/// The node at a position.
fn node(path: &str, at: f64, mesh: &Mesh, findings: &mut Findings<'_>) -> Option<usize> {
    let found = node_at(mesh, at);
    if found.is_none() {
        let path = format!("{path}.at_m");
        let [low, high] = beside(mesh, at).map(|node| number(mesh.nodes()[node]));
        let problem = Problem::error(format!("`{path}` is not at a node of the mesh"));
        let label = format!("found {}, expected the position of a node: {low} or {high} m", findings.written(&path));
        findings.put(&path, problem, label);
    }
    found
}

/// The support of a node at an end.
fn support(raw: &RawStructure, node: usize, mesh: &Mesh) -> Option<Support> {
    match node {
        0 => raw.start,
        n if n == mesh.elements() => Some(raw.end.unwrap_or(Support::Free)),
        _ => None,
    }
}

fn is_clamped(raw: &RawStructure, node: usize, mesh: &Mesh) -> bool {
    let (Some(support), Some(kind)) = (support(raw, node, mesh), raw.kind) else { return false };
    support == Support::Clamped || (kind == StructureKind::Rod && holds(kind, support, Direction::Axial))
}

fn is_held(raw: &RawStructure, node: usize, direction: SpringDirection, mesh: &Mesh) -> bool {
    let (Some(support), Some(kind)) = (support(raw, node, mesh), raw.kind) else { return false };
    match direction {
        SpringDirection::Axial => holds(kind, support, Direction::Axial),
        SpringDirection::Transverse => holds(kind, support, Direction::Transverse),
        SpringDirection::Rotation => matches!(support, Support::Clamped | Support::Sliding),
    }
}

//! Nodes of the mesh.

use nlmodes_fem::{FemError, Mesh};

use crate::raw::RawStructure;
use crate::scene::Refined;
use crate::{Diagnostic, Diagnostics};

/// A stop is at a node if it is nearer to it than this part of the shorter element beside it.
const TOLERANCE: f64 = 1e-4;

/// A mesh, and how it was made.
pub struct Nodes {
    pub mesh: Mesh,
    /// Positions of the nodes, before refinement, where these are not those of a graded mesh.
    pub nodes: Option<Vec<f64>>,
    /// Number of elements before refinement.
    pub elements: usize,
    pub refined: Option<Refined>,
}

/// The mesh of the structure with nodes at its stops and at these other places, if what it depends on is sound.
pub fn mesh(raw: &RawStructure, stops: &[f64], parts: &[f64], diagnostics: &mut Diagnostics<'_>) -> Option<Nodes> {
    let graded = coarse(raw, diagnostics)?;
    let segments = raw.segment.iter().flatten().map(|segment| segment.to_m);
    let wanted: Vec<f64> = stops.iter().chain(parts).copied().chain(segments).collect();
    let mesh = graded.with_nodes_at(&wanted, TOLERANCE);
    let nodes = (mesh != graded).then(|| mesh.nodes().to_vec());
    let elements = mesh.elements();
    let Some(factor) = raw.refine.filter(|factor| *factor > 1.0) else {
        return Some(Nodes { mesh, nodes, elements, refined: None });
    };
    let mut beside: Vec<usize> = stops.iter().filter_map(|at| node_at(&mesh, *at)).collect();
    beside.sort_unstable();
    beside.dedup();
    if beside.is_empty() {
        let path = "structure.refine";
        let diagnostic = Diagnostic::warning(format!("`{path}` has no effect"));
        diagnostics.put(path, diagnostic, "there is no stop at a node of the mesh");
        return Some(Nodes { mesh, nodes, elements, refined: None });
    }
    match mesh.refined(&beside, factor) {
        Ok(mesh) => Some(Nodes { mesh, nodes, elements, refined: Some(Refined { beside, factor }) }),
        Err(error) => {
            diagnostics.put("structure.refine", unusable(&error), "expected elements that are distinct");
            None
        }
    }
}

fn coarse(raw: &RawStructure, diagnostics: &mut Diagnostics<'_>) -> Option<Mesh> {
    match Mesh::graded(raw.length_m, raw.elements as usize, raw.grading.unwrap_or(1.0)) {
        Ok(mesh) => Some(mesh),
        Err(error) => {
            diagnostics.put("structure.grading", unusable(&error), "expected elements that are distinct");
            None
        }
    }
}

fn unusable(error: &FemError) -> Diagnostic {
    let diagnostic = Diagnostic::error(format!("the mesh cannot be made: {error}"));
    diagnostic.help("take fewer `structure.elements`, or a `structure.grading` nearer to 1")
}

/// The node nearest to a position.
pub fn nearest(mesh: &Mesh, at: f64) -> usize {
    let nodes = mesh.nodes();
    let after = nodes.partition_point(|x| *x < at).min(mesh.elements());
    let before = after.saturating_sub(1);
    if (nodes[before] - at).abs() < (nodes[after] - at).abs() { before } else { after }
}

/// The nodes on both sides of a position; beyond the end the last one twice.
pub fn beside(mesh: &Mesh, at: f64) -> [usize; 2] {
    let after = mesh.nodes().partition_point(|x| *x < at);
    if after > mesh.elements() { [mesh.elements(); 2] } else { [after.saturating_sub(1), after] }
}

/// The node at a position, if there is one.
pub fn node_at(mesh: &Mesh, at: f64) -> Option<usize> {
    let node = nearest(mesh, at);
    let beside = &mesh.element_lengths()[node.saturating_sub(1)..(node + 1).min(mesh.elements())];
    let shorter = beside.iter().copied().fold(f64::INFINITY, f64::min);
    ((mesh.nodes()[node] - at).abs() <= TOLERANCE * shorter).then_some(node)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_as_they_are_shown_in_messages_are_found_again() {
        let mesh = Mesh::graded(1234.56789, 50, 30.0).unwrap();
        for (node, x) in mesh.nodes().iter().enumerate() {
            let shown: f64 = crate::number(*x).parse().unwrap();
            assert_eq!(node_at(&mesh, shown), Some(node));
        }
        assert_eq!(node_at(&mesh, 1234.5), None);
        assert_eq!(nearest(&mesh, 2000.0), 50);
    }
}

//! The area of a face that belongs to each of its nodes.

use std::collections::HashMap;

use super::skin::{Skin, SkinCell, cell_area};
use super::{ElementKind, Mesh};

impl Skin {
    /// The area that belongs to each node of a set, m² if the mesh's places are in m, as seen along the direction
    /// beside it: force over it is the mean pressure around the node. Nodes are indices in the mesh.
    ///
    /// Faces count that lie in the set with all of their corners and look along the direction of the node. A face with
    /// nodes in the middle of its edges is divided into pieces between neighbouring nodes. A node without such a face,
    /// as of an edge or of a single corner, has zero.
    pub fn tributary_areas(&self, mesh: &Mesh, nodes: &[(u32, [f64; 3])]) -> Vec<f64> {
        let place: HashMap<u32, usize> = nodes.iter().enumerate().map(|(k, (node, _))| (*node, k)).collect();
        let mut areas = vec![0.0; nodes.len()];
        let inside = |cell: &&SkinCell| cell.nodes[..cell.kind.corners()].iter().all(|node| place.contains_key(node));
        for cell in self.cells.iter().filter(|cell| cell.kind != ElementKind::Line).filter(inside) {
            let normal = cell_area(cell, mesh);
            let [corner, middle] = shares(cell);
            for (k, node) in cell.nodes.iter().enumerate() {
                let Some(&at) = place.get(node) else { continue };
                let seen: f64 = normal.iter().zip(nodes[at].1).map(|(n, d)| n * d).sum();
                areas[at] += seen.max(0.0) * if k < cell.kind.corners() { corner } else { middle };
            }
        }
        areas
    }
}

/// Share of a face that belongs to a corner, and to the middle of an edge.
fn shares(cell: &SkinCell) -> [f64; 2] {
    let corners = cell.kind.corners();
    match cell.nodes.len() > corners {
        false => [1.0 / corners as f64, 0.0],
        // Four triangles, of which each has a quarter.
        true if corners == 3 => [1.0 / 12.0, 1.0 / 4.0],
        // A triangle at each corner, an eighth, and the square between the middles.
        true => [1.0 / 24.0, 5.0 / 24.0],
    }
}

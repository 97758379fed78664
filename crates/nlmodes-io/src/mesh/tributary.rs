//! The area of a face that belongs to each of its nodes.

use std::collections::HashMap;

use super::skin::{Skin, SkinCell, cell_area};
use super::{ElementKind, Mesh};

impl Skin {
    /// The tributary area of each node of a set, m² if positions are in m, projected along the given direction: force
    /// over it is the mean pressure around the node. Nodes are indices in the mesh.
    ///
    /// Only faces with all corner nodes in the set and oriented along the direction of the node are used. A face with
    /// midside nodes is divided into parts between neighbouring nodes. A node without such a face, as on an edge or a
    /// single corner node, has zero.
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

/// Share of a face for a corner node, and for a midside node.
fn shares(cell: &SkinCell) -> [f64; 2] {
    let corners = cell.kind.corners();
    match cell.nodes.len() > corners {
        false => [1.0 / corners as f64, 0.0],
        // Four triangles, of which each has a quarter.
        true if corners == 3 => [1.0 / 12.0, 1.0 / 4.0],
        // A triangle at each corner node, an eighth, and the square between the midside nodes.
        true => [1.0 / 24.0, 5.0 / 24.0],
    }
}

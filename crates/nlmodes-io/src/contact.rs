//! Contacts of a model's nodes with walls and with each other, as sparse directions.

mod choice;
mod error;
mod find;
mod pairs;

use nlmodes_linalg::{LinalgError, SparseMatrix, Triplet, sparse_from_triplets};

pub use choice::{ContactChoice, ContactNodes, GapChoice, NormalChoice, Partner};
pub use error::{ContactError, ContactProblem};
pub use find::find_contacts;

use crate::model::FeModel;

/// One contact: of a node with a wall, or of two nodes.
///
/// ```text
/// g = g₀ + wᵀ q ,   w = −n at the node, +n at the node that it touches
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct NodeContact {
    /// The node.
    pub node: u64,
    /// The node that it touches; none for a wall.
    pub against: Option<u64>,
    /// Unit vector from the node to its obstacle.
    pub normal: [f64; 3],
    /// Clearance at rest `g₀`, m; negative where it presses.
    pub gap: f64,
    /// Contact stiffness, N/m; none of a rigid contact.
    pub stiffness: Option<f64>,
    /// Damper parallel to the stiffness, N s/m; none without dissipation.
    pub damping: Option<f64>,
    /// The choice that it comes from, from 0.
    pub origin: usize,
}

impl NodeContact {
    /// Distance of the node from its partner along the normal, from the positions of the model, m; negative if the
    /// partner is behind. None for a wall, or if a position is unknown.
    pub fn distance_in(&self, model: &FeModel) -> Option<f64> {
        let (from, to) = (model.place_of(self.node)?, model.place_of(self.against?)?);
        Some((0..3).map(|axis| (to[axis] - from[axis]) * self.normal[axis]).sum())
    }

    /// Entries of column `k` of `W`. Fixed displacements have no row.
    fn column(&self, model: &FeModel, k: usize) -> Vec<Triplet> {
        let at = |node: u64, sign: f64| {
            let rows = model.translations_of(node).into_iter().zip(self.normal);
            rows.filter_map(move |(row, n)| Some((row?, k, sign * n))).filter(|entry| entry.2 != 0.0)
        };
        at(self.node, -1.0).chain(self.against.into_iter().flat_map(|node| at(node, 1.0))).collect()
    }
}

impl FeModel {
    /// Directions `W` (n × c) of contact forces, a column each: `g = g₀ + Wᵀ q`.
    ///
    /// # Errors
    /// [`LinalgError`] if a normal is not finite or there is no memory.
    pub fn contact_directions(&self, contacts: &[NodeContact]) -> Result<SparseMatrix, LinalgError> {
        let entries: Vec<_> = contacts.iter().enumerate().flat_map(|(k, contact)| contact.column(self, k)).collect();
        sparse_from_triplets(self.n_dofs(), contacts.len(), &entries)
    }
}

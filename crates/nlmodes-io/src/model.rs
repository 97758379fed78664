//! Matrices, labels and mesh together.

mod assemble;
mod expanded;
mod files;
mod inner;
mod level;
mod turned;
mod written;

use std::collections::{BTreeMap, HashMap, HashSet};

pub use files::{FeFiles, NodeChoice};

use crate::error::{Problem, ReadError, Result};
use crate::labels::{Component, DofLabel};
use crate::lower::LowerTriangle;
use crate::mesh::{Expanded, Mesh};
use nlmodes_linalg::Digits;

/// A linear structure of finite elements in SI units: what the files hold, checked against each other.
///
/// `M` and `K` are symmetric; every diagonal entry of `K` is positive. The mass may be singular and may have negative
/// rows at corners, as those of quadratic tetrahedra have.
#[derive(Debug, Clone)]
pub struct FeModel {
    /// Stiffness `K` (n × n; N/m, N, N·m as the components need).
    pub stiffness: LowerTriangle,
    /// Mass `M` (n × n; kg, kg·m, kg·m²).
    pub mass: LowerTriangle,
    /// Node and component of each row.
    pub labels: Vec<DofLabel>,
    /// Places in m, elements and node sets, where a mesh is there.
    pub mesh: Option<Mesh>,
    /// Degrees of freedom that the files or `fixed` hold, which have no row.
    pub fixed: Vec<DofLabel>,
    /// Those of them that the files hold by equal values on both diagonals, with nothing beside them.
    pub held_on_diagonals: Vec<DofLabel>,
    /// Digits with which the entries of stiffness and mass were written, as they show them.
    pub digits: [Digits; 2],
    /// Mass between a row and a degree of freedom of a node that `fixed` holds: row, what is held, kg, kg·m, kg·m².
    /// What the files hold has none.
    pub fixed_mass: Vec<(usize, DofLabel, f64)>,
    places: HashMap<u64, [f64; 3]>,
    rows: HashMap<DofLabel, usize>,
    /// Numbers of nodes that represent unknowns within elements, which no file names, and the nodes of the deck from
    /// which they come.
    within: BTreeMap<u64, u64>,
    /// What the files hold, where other unknowns have taken the place of theirs.
    as_written: Option<written::AsWritten>,
}

impl FeModel {
    /// Reads the files of a model.
    ///
    /// # Errors
    /// [`ReadError`]: the file, the place in it, what is there and what was expected.
    pub fn read(files: &FeFiles) -> Result<Self> {
        assemble::read(files)
    }

    /// Number of rows.
    pub fn n_dofs(&self) -> usize {
        self.labels.len()
    }

    /// Row of a component of a node; none if it is held or not there.
    pub fn row_of(&self, node: u64, component: Component) -> Option<usize> {
        self.rows.get(&DofLabel { node, component }).copied()
    }

    /// Whether a displacement that has no row is held: by the files, by `fixed`, or by the deck. If it is not, it
    /// depends on others (`*EQUATION`, `*RIGID BODY`, `*TIE`, `*COUPLING`); none where nothing is known of supports, or
    /// where no node moves along that axis.
    pub fn is_held(&self, node: u64, component: Component) -> Option<bool> {
        let in_plane = self.mesh.as_ref().is_some_and(|mesh| mesh.expanded.get(&node) == Some(&Expanded::InPlane));
        if self.fixed.contains(&DofLabel { node, component }) || (in_plane && component == Component::Z) {
            return Some(true);
        }
        let supports = self.mesh.as_ref()?.supports.as_ref()?;
        let axis = component.translation().filter(|_| self.labels.iter().any(|label| label.component == component))?;
        Some(supports.get(&node).is_some_and(|held| held[axis]))
    }

    /// Rows of the displacements of a node along x, y and z.
    pub fn translations_of(&self, node: u64) -> [Option<usize>; 3] {
        [Component::X, Component::Y, Component::Z].map(|component| self.row_of(node, component))
    }

    /// Place of a node, m, from the mesh or the table of labels.
    pub fn place_of(&self, node: u64) -> Option<[f64; 3]> {
        self.mesh.as_ref().and_then(|mesh| mesh.place_of(node)).or_else(|| self.places.get(&node).copied())
    }

    /// Nodes that have rows, ascending.
    pub fn nodes(&self) -> Vec<u64> {
        let mut nodes: Vec<u64> = self.labels.iter().map(|label| label.node).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Whether any places are known.
    pub fn knows_places(&self) -> bool {
        self.mesh.is_some() || !self.places.is_empty()
    }

    /// Nodes with rows but without a place, where places are known at all: those within elements, which a deck does not
    /// name.
    pub fn nodes_without_place(&self) -> Vec<u64> {
        if !self.knows_places() {
            return Vec::new();
        }
        self.nodes().into_iter().filter(|node| self.place_of(*node).is_none()).collect()
    }

    /// Nodes of a set of the mesh, and how many of them have no row: they are fixed, or dependent on others. None
    /// without such a set.
    pub fn size_of_set(&self, name: &str) -> Option<(usize, usize)> {
        let set = self.mesh.as_ref()?.node_set(name)?;
        let present: HashSet<u64> = self.labels.iter().map(|label| label.node).collect();
        Some((set.len(), set.iter().filter(|node| !present.contains(node)).count()))
    }

    /// Mass that a rigid displacement along x, y and z moves, kg: the sum of `M` over the free displacements of nodes
    /// that have a place (of all nodes, where no places are known).
    pub fn mass_along_axes(&self) -> [f64; 3] {
        let inner: HashSet<u64> = self.nodes_without_place().into_iter().collect();
        let axis =
            |row: usize| self.labels[row].component.translation().filter(|_| !inner.contains(&self.labels[row].node));
        let axes: Vec<Option<usize>> = (0..self.n_dofs()).map(axis).collect();
        let mut sums = [0.0; 3];
        for (i, j, value) in self.mass.entries() {
            if let (Some(a), true) = (axes[i], axes[i] == axes[j]) {
                sums[a] += if i == j { value } else { 2.0 * value };
            }
        }
        sums
    }

    /// The motion `r` of each row while the structure with its supports is displaced by one unit along a direction (n).
    /// Rotations, and nodes within elements that have no place, do not move.
    pub fn rigid_displacement(&self, direction: [f64; 3]) -> Vec<f64> {
        let inner: HashSet<u64> = self.nodes_without_place().into_iter().collect();
        let of = |label: &DofLabel| match label.component.translation() {
            Some(axis) if !inner.contains(&label.node) => direction[axis],
            _ => 0.0,
        };
        self.labels.iter().map(of).collect()
    }

    /// `M r` of all rows, with the mass between them and what `fixed` holds, in that motion (n, kg): what an
    /// acceleration of the base meets.
    pub fn inertia_along(&self, direction: [f64; 3]) -> Vec<f64> {
        let mut inertia = vec![0.0; self.n_dofs()];
        self.mass.multiply(&self.rigid_displacement(direction), &mut inertia);
        for (row, held, mass) in self.fixed_mass.iter().filter(|(_, held, _)| !self.within.contains_key(&held.node)) {
            inertia[*row] += held.component.translation().map_or(0.0, |axis| direction[axis] * mass);
        }
        inertia
    }

    /// Nodes of a set of the mesh that have rows.
    ///
    /// # Errors
    /// [`ReadError`] if there is no mesh, no such set, or none of its nodes has a row.
    pub fn nodes_of_set(&self, files: &FeFiles, name: &str) -> Result<Vec<u64>> {
        let Some(mesh) = &self.mesh else {
            let found = format!("the node set `{name}` and no mesh");
            let problem = Problem::Expected { expected: "a mesh with its sets (key `mesh`)".into(), found };
            return Err(ReadError::whole(&files.stiffness.path, problem));
        };
        let path = files.mesh.as_deref().unwrap_or(&files.stiffness.path);
        let set = mesh.node_set(name).ok_or_else(|| {
            let known = mesh.node_sets.keys().cloned().collect();
            ReadError::whole(path, Problem::Missing { what: "node set", name: name.to_owned(), known })
        })?;
        let present: HashSet<u64> = self.labels.iter().map(|label| label.node).collect();
        let nodes: Vec<u64> = set.iter().copied().filter(|node| present.contains(node)).collect();
        if nodes.is_empty() {
            let found = format!(
                "the node set `{name}` of {}, none with a row of its own in the matrices: fixed, or dependent on \
                 other nodes (*EQUATION, *MPC, *TIE, nodes of a *RIGID BODY or *COUPLING; the reference node of a \
                 rigid body or of a *KINEMATIC coupling has rows, that of a *DISTRIBUTING one has none)",
                match set.len() {
                    1 => "one node".to_owned(),
                    n => format!("{n} nodes"),
                }
            );
            let problem = Problem::Expected { expected: "a set with free nodes".into(), found };
            return Err(ReadError::whole(path, problem));
        }
        Ok(nodes)
    }
}

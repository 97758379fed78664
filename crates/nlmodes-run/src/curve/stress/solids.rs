//! Stress at the nodes of solids.

use std::collections::HashMap;

use nlmodes::fem::{Elastic, NodalStress, Solid, SolidShape, largest_principal, von_mises};
use nlmodes::linalg::Mat;
use nlmodes::modal::PeakStress;
use nlmodes_io::{Component, FeModel, Mesh};
use nlmodes_scene::assemble::OpenStructure;
use nlmodes_scene::scene::Scene;

use crate::Failure;
use crate::curve::Instants;

/// Memory of the stress of one shape at a node, bytes: six components and the equivalent stress.
const BYTES: f64 = 56.0;

/// Stress of each shape of which motions are made, at the nodes of solids: of the modes, of the contact forces beyond
/// these, of the loads beyond these, and of the static loads.
///
/// Stress is linear: that of a motion is their sum with its coordinates, `σ(t) = Σ_j s_j x_j(t)`.
pub struct Solids {
    /// Numbers of the nodes.
    numbers: Vec<u64>,
    /// The row of a node, by its index in the mesh.
    row: HashMap<u32, usize>,
    /// Of each node and component a number a shape, Pa.
    stress: NodalStress,
    /// Equivalent stress, of each node a number a shape, Pa.
    mises: Vec<f64>,
}

/// Stress at points of a surface at one instant.
pub struct PointStress {
    /// Six components of each point, Pa.
    pub components: Vec<f64>,
    /// Equivalent stress of von Mises, Pa.
    pub mises: Vec<f64>,
    /// The principal stress of the largest magnitude, Pa.
    pub principal: Vec<f64>,
}

impl Solids {
    /// Of a structure from files; none where not all solids of its mesh have elements whose strain is known and a
    /// material, where heat strains them in a way that the files do not tell, or where there are too many.
    ///
    /// # Errors
    /// [`Failure`] for elements that are inside out.
    pub fn of(scene: &Scene, open: &OpenStructure, loads: &[Vec<f64>]) -> Result<Option<Self>, Failure> {
        let Some((model, mesh, solids)) = known(scene, open) else { return Ok(None) };
        if Self::left_out(scene, open, loads.len()).is_some() {
            return Ok(None);
        }
        let stress = NodalStress::of(&mesh.places, &solids, &displacements(open, (model, mesh), loads))?;
        let (nodes, states) = (stress.nodes.len(), stress.states);
        let of = |node: usize, shape: usize| von_mises(std::array::from_fn(|i| stress.line(node, i)[shape]));
        Ok(Some(Self {
            numbers: stress.nodes.iter().map(|index| mesh.numbers[*index]).collect(),
            row: stress.nodes.iter().enumerate().map(|(row, index)| (*index as u32, row)).collect(),
            mises: (0..nodes)
                .flat_map(|node| (0..states).map(move |shape| (node, shape)))
                .map(|(n, s)| of(n, s))
                .collect(),
            stress,
        }))
    }

    /// Why stress that could be recovered is not: it would take more memory than the scene allows.
    pub fn left_out(scene: &Scene, open: &OpenStructure, loads: usize) -> Option<String> {
        let (_, mesh, _) = known(scene, open)?;
        let (needed, most) =
            (BYTES * (shapes(open, loads) * mesh.places.len()) as f64 / 1e9, scene.files.stress_memory_gb);
        (needed > most).then(|| {
            format!(
                "no stress is recovered: those of all shapes would take {} GB of memory, more than the {} GB of \
                output.stress_memory_gb",
                nlmodes_scene::significant(needed, 2),
                nlmodes_scene::number(most)
            )
        })
    }

    /// The largest equivalent stress at these instants, and the number of its node.
    ///
    /// The equivalent stress is a seminorm: that of a node is at most the sum of those of its shapes, each with its
    /// largest coordinate. Nodes are looked at in the order of that bound, as long as it is not below what was found,
    /// and of their instants those at which the same sum with the coordinates there is not.
    pub fn largest(&self, instants: &Instants) -> Option<PeakStress> {
        let x = coordinates(instants);
        let sizes: Vec<Vec<f64>> = x.iter().map(|x| x.iter().map(|x| x.abs()).collect()).collect();
        let reach: Vec<f64> =
            (0..self.stress.states).map(|j| sizes.iter().map(|size| size[j]).fold(0.0, f64::max)).collect();
        let bound = |node: usize| dot(self.mises_of(node), &reach);
        // Nodes whose displacements are not known have no stress.
        let mut bounds: Vec<(usize, f64)> =
            (0..self.numbers.len()).map(|node| (node, bound(node))).filter(|(_, bound)| !bound.is_nan()).collect();
        bounds.sort_unstable_by(|a, b| b.1.total_cmp(&a.1));
        let mut found: Option<PeakStress> = None;
        for (node, bound) in bounds {
            if found.is_some_and(|found| found.stress >= bound) {
                break;
            }
            let (own, at) = (self.mises_of(node), self.numbers[node] as f64);
            for (x, size) in x.iter().zip(&sizes) {
                if found.is_some_and(|found| found.stress >= dot(own, size)) {
                    continue;
                }
                let stress = von_mises(self.at(node, x));
                if found.is_none_or(|found| stress > found.stress) {
                    found = Some(PeakStress { stress, at });
                }
            }
        }
        found
    }

    fn mises_of(&self, node: usize) -> &[f64] {
        let states = self.stress.states;
        &self.mises[node * states..(node + 1) * states]
    }

    /// Stress at points of a surface, by their indices in the mesh, at one of these instants; NaN where it is not
    /// known.
    pub fn at_points(&self, points: &[u32], instants: &Instants, k: usize) -> PointStress {
        let x = coordinate(instants, k);
        let all: Vec<[f64; 6]> =
            points.iter().map(|index| self.row.get(index).map_or([f64::NAN; 6], |node| self.at(*node, &x))).collect();
        PointStress {
            components: all.iter().flatten().copied().collect(),
            mises: all.iter().map(|stress| von_mises(*stress)).collect(),
            principal: all.iter().map(|stress| largest_principal(*stress)).collect(),
        }
    }

    fn at(&self, node: usize, x: &[f64]) -> [f64; 6] {
        std::array::from_fn(|i| dot(self.stress.line(node, i), x))
    }
}

/// The model with its mesh and the solids of that, where their stress is known.
fn known<'a>(scene: &Scene, open: &'a OpenStructure) -> Option<(&'a FeModel, &'a Mesh, Vec<Solid>)> {
    let (model, _) = open.files.as_ref()?;
    let mesh = model.mesh.as_ref().filter(|_| scene.static_loads.thermal.is_none())?;
    Some((model, mesh, solids(mesh)?))
}

/// Number of shapes of which motions are made.
fn shapes(open: &OpenStructure, loads: usize) -> usize {
    open.modes.n_modes() + open.modes.n_contacts() + loads + 1
}

/// Coordinates of the shapes at each instant.
fn coordinates(instants: &Instants) -> Vec<Vec<f64>> {
    (0..instants.eta.ncols()).map(|k| coordinate(instants, k)).collect()
}

/// Those at one instant.
fn coordinate(instants: &Instants, k: usize) -> Vec<f64> {
    let Instants { eta, forces, loads, .. } = instants;
    [eta, forces, loads].into_iter().flat_map(|of| (0..of.nrows()).map(move |j| of[(j, k)])).chain([1.0]).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The solids of a mesh; none where there are none, or one of them is not known well enough.
fn solids(mesh: &Mesh) -> Option<Vec<Solid>> {
    let elements = mesh.elements.iter().enumerate().filter(|(_, element)| element.kind.is_solid());
    let solid = |(k, element): (usize, &nlmodes_io::Element)| {
        let (name, [youngs_modulus, poissons_ratio]) = mesh.elasticity(k)?;
        let nodes = element.nodes.iter().map(|node| *node as usize).collect();
        Some(Solid { shape: SolidShape::from_type(name)?, nodes, material: Elastic { youngs_modulus, poissons_ratio } })
    };
    elements.map(solid).collect::<Option<Vec<Solid>>>().filter(|solids| !solids.is_empty())
}

/// Displacements of the nodes of the mesh in each shape, m: `u_x, u_y, u_z` of each, one below the other. What is held
/// does not move; NaN where it depends on others in a way that is not known.
fn displacements(open: &OpenStructure, (model, mesh): (&FeModel, &Mesh), loads: &[Vec<f64>]) -> Mat<f64> {
    let (m, c) = (open.modes.n_modes(), open.modes.n_contacts());
    let all: Vec<usize> = (0..model.n_dofs()).collect();
    let unit = Mat::from_fn(c, c, |i, j| f64::from(u8::from(i == j)));
    let pressed = open.modes.displacements(&all, &Mat::zeros(m, c), &unit);
    let moved = open.state.as_ref().map(|state| open.beyond_modes(state, &all));
    let shape = |dof: usize, j: usize| match j {
        j if j < m => open.modes.shapes()[(dof, j)],
        j if j < m + c => pressed[(dof, j - m)],
        j if j < m + c + loads.len() => loads[j - m - c][dof],
        _ => moved.as_ref().map_or(0.0, |moved| moved[dof]),
    };
    let mut found = Mat::zeros(3 * mesh.numbers.len(), m + c + loads.len() + 1);
    for (node, number) in mesh.numbers.iter().enumerate() {
        for (axis, component) in [Component::X, Component::Y, Component::Z].into_iter().enumerate() {
            let row = model.row_of(*number, component);
            let is_unknown = row.is_none() && model.is_held(*number, component) == Some(false);
            for j in 0..found.ncols() {
                found[(3 * node + axis, j)] = match row {
                    Some(dof) => shape(dof, j),
                    None if is_unknown => f64::NAN,
                    None => 0.0,
                };
            }
        }
    }
    found
}

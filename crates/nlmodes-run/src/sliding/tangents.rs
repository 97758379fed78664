//! The tangential directions of contacts.

use std::collections::HashMap;
use std::ops::Range;

use nlmodes::model::{Dof, DofKind};
use nlmodes::response::Weights;
use nlmodes_io::{Component, FeModel, NodeContact};
use nlmodes_scene::assemble::NodeContacts;
use nlmodes_scene::scene::{BaseDirection, Direction, Scene, StopOfBase};

/// A displacement within the plane of a contact, of its node relative to what it touches.
#[derive(Debug, Clone, PartialEq)]
pub struct Tangent {
    /// Degrees of freedom with weights.
    pub weights: Weights,
    /// Share of the motion of the base in it: of a base that shakes past a stop which is fixed.
    pub base: f64,
}

/// The tangential displacements of all contacts: one of beams, which move in a plane, two in space, none where the
/// structure has no degree of freedom for them, or where it is not known what moves them.
#[derive(Debug, Default)]
pub struct Tangents {
    all: Vec<Tangent>,
    /// Those of each contact.
    of: Vec<Range<usize>>,
    friction: Vec<Option<f64>>,
}

impl Tangents {
    /// Of the contacts of a scene: `directions` are the entries of `W`, degree of freedom, contact and weight.
    pub fn of(scene: &Scene, dofs: &[Dof], directions: &[(usize, usize, f64)], nodes: Option<&NodeContacts>) -> Self {
        let count = directions.iter().map(|(_, contact, _)| contact + 1).max().unwrap_or(0);
        let mut columns: Vec<Weights> = vec![Weights::new(); count];
        directions.iter().filter(|entry| entry.2 != 0.0).for_each(|&(dof, contact, w)| columns[contact].push((dof, w)));
        let places = Places::new(dofs);
        let base = Base::of(scene);
        let mut found = Self::default();
        for (contact, column) in columns.iter().enumerate() {
            let tangents = match nodes {
                Some((model, contacts)) => contacts.get(contact).map_or_else(Vec::new, |of| in_space(model, of, &base)),
                None => places.across(column, &base).into_iter().collect(),
            };
            let from = found.all.len();
            found.all.extend(tangents);
            found.of.push(from..found.all.len());
            found.friction.push(friction(scene, contact, nodes));
        }
        found
    }

    /// Whether no contact has any.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Number of tangential displacements.
    pub fn count(&self) -> usize {
        self.all.len()
    }

    /// All tangential displacements.
    pub fn all(&self) -> impl Iterator<Item = &Tangent> {
        self.all.iter()
    }

    /// Those of a contact, by their numbers.
    pub fn of_contact(&self, contact: usize) -> Range<usize> {
        self.of.get(contact).cloned().unwrap_or_default()
    }

    /// The coefficient of friction that the scene gives for an estimate at a contact.
    pub fn friction(&self, contact: usize) -> Option<f64> {
        self.friction.get(contact).copied().flatten()
    }
}

/// The coefficient of a contact: of files that of the table from which it comes.
fn friction(scene: &Scene, contact: usize, nodes: Option<&NodeContacts>) -> Option<f64> {
    match (nodes, scene.structure.matrices()) {
        (Some((_, contacts)), Some(matrices)) => {
            matrices.contacts.get(contacts.get(contact)?.origin)?.friction_estimate
        }
        _ => scene.contacts.get(contact)?.friction_estimate,
    }
}

/// A base that shakes past stops which are fixed.
enum Base {
    /// There is none.
    Still,
    /// Along or across the axes of rods and beams.
    Along(Direction),
    /// In space.
    Vector([f64; 3]),
}

impl Base {
    fn of(scene: &Scene) -> Self {
        match scene.base_motion.filter(|base| base.stop == StopOfBase::Fixed).map(|base| base.direction) {
            None => Self::Still,
            Some(BaseDirection::Along(direction)) => Self::Along(direction),
            Some(BaseDirection::Vector(direction)) => Self::Vector(direction),
        }
    }
}

/// The degrees of freedom of rods and beams by node and kind.
struct Places<'a> {
    dofs: &'a [Dof],
    rows: HashMap<(usize, DofKind), usize>,
}

impl<'a> Places<'a> {
    fn new(dofs: &'a [Dof]) -> Self {
        Self { dofs, rows: dofs.iter().enumerate().map(|(row, dof)| ((dof.node, dof.kind), row)).collect() }
    }

    /// What a contact of rods or beams does across its direction: each of its nodes moves along the other one, the
    /// touched one against it.
    fn across(&self, column: &[(usize, f64)], base: &Base) -> Option<Tangent> {
        let mut weights = Weights::new();
        let mut kind = None;
        for (end, (dof, _)) in column.iter().enumerate() {
            let own = self.dofs.get(*dof)?;
            let other = match own.kind {
                DofKind::Axial => DofKind::Deflection,
                DofKind::Deflection => DofKind::Axial,
                _ => return None,
            };
            kind = Some(other);
            let sign = if end == 0 { 1.0 } else { -1.0 };
            weights.extend(self.rows.get(&(own.node, other)).map(|row| (*row, sign)));
        }
        let shakes = match (base, kind) {
            (Base::Along(Direction::Axial), Some(DofKind::Axial))
            | (Base::Along(Direction::Transverse), Some(DofKind::Deflection)) => column.len() == 1,
            _ => false,
        };
        (!weights.is_empty()).then_some(Tangent { weights, base: f64::from(u8::from(shakes)) })
    }
}

/// The two directions within the plane of a contact of nodes. Displacements that are held do not move; there are none
/// where one depends on others in a way that is not known.
fn in_space(model: &FeModel, contact: &NodeContact, base: &Base) -> Vec<Tangent> {
    let ends = || std::iter::once((contact.node, 1.0)).chain(contact.against.map(|node| (node, -1.0)));
    let axes = [Component::X, Component::Y, Component::Z];
    let is_unknown =
        |node: u64, component| model.row_of(node, component).is_none() && model.is_held(node, component) == Some(false);
    if ends().any(|(node, _)| axes.iter().any(|component| is_unknown(node, *component))) {
        return Vec::new();
    }
    let tangent = |t: [f64; 3]| {
        let end = |(node, sign): (u64, f64)| {
            let rows = model.translations_of(node).into_iter().zip(t);
            rows.filter_map(move |(row, t)| Some((row?, sign * t))).filter(|entry| entry.1 != 0.0)
        };
        let weights: Weights = ends().flat_map(end).collect();
        let shakes = match base {
            Base::Vector(direction) if contact.against.is_none() => (0..3).map(|k| t[k] * direction[k]).sum(),
            _ => 0.0,
        };
        (!weights.is_empty()).then_some(Tangent { weights, base: shakes })
    };
    plane(contact.normal).into_iter().filter_map(tangent).collect()
}

/// Two unit vectors that are orthogonal to a unit normal and to each other.
fn plane(normal: [f64; 3]) -> [[f64; 3]; 2] {
    // The axis that is farthest from the normal.
    let axis = (0..3).min_by(|a, b| normal[*a].abs().total_cmp(&normal[*b].abs())).unwrap_or(0);
    let along = |k: usize| f64::from(u8::from(k == axis)) - normal[axis] * normal[k];
    let length = (0..3).map(|k| along(k).powi(2)).sum::<f64>().sqrt();
    let first: [f64; 3] = std::array::from_fn(|k| along(k) / length);
    let second = std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        normal[i] * first[j] - normal[j] * first[i]
    });
    [first, second]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
        (0..3).map(|k| a[k] * b[k]).sum()
    }

    #[test]
    fn directions_within_a_plane_are_orthonormal() {
        let slanted = [0.36, 0.48, 0.8];
        for normal in [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.6, 0.0, -0.8], slanted] {
            let [a, b] = plane(normal);
            for (u, v, expected) in [(a, a, 1.0), (b, b, 1.0), (a, b, 0.0), (a, normal, 0.0), (b, normal, 0.0)] {
                assert!((dot(u, v) - expected).abs() < 1e-15, "{normal:?}: {a:?} {b:?}");
            }
        }
    }
}

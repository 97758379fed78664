//! Places of a structure: the degrees of freedom that move there.

use nlmodes::fem::FemError;
use nlmodes::model::{Dof, DofKind, StructuralModel};
use nlmodes::response::{BaseMotion, BaseUnit, Weights};
use nlmodes_fem::Mesh;

use super::Elements;
use crate::scene::{Direction, Structure, StructureKind, Support};

/// A rod or beam, alone or one of several.
#[derive(Debug)]
pub struct Body {
    /// Its elements.
    pub elements: Elements,
    /// Their matrices.
    pub model: StructuralModel,
    /// Number of degrees of freedom of those before.
    pub first: usize,
}

impl Body {
    /// The structures of a scene, with consecutive degrees of freedom.
    ///
    /// # Errors
    /// What the element library has against one; a checked scene gives no reason for that.
    pub fn all(structures: &[Structure]) -> Result<Vec<Self>, FemError> {
        let (mut bodies, mut first) = (Vec::new(), 0);
        for structure in structures {
            let elements = Elements::new(structure)?;
            let model = elements.assemble(&[])?;
            let n = model.dofs().len();
            bodies.push(Self { elements, model, first });
            first += n;
        }
        Ok(bodies)
    }

    /// The displacement at a position along or across the axis, m: degrees of freedom of all structures with weights;
    /// none where the structure is held.
    ///
    /// # Errors
    /// [`FemError::OutsideMesh`].
    pub fn weights(&self, at: f64, direction: Direction) -> Result<Weights, FemError> {
        let is_own = (self.elements.kind() == StructureKind::Rod) == (direction == Direction::Axial);
        let own = match is_own {
            true => self.elements.displacement_at(&self.model, at)?,
            false => axial_of_a_beam(self.elements.mesh(), self.model.dofs(), at)?,
        };
        Ok(own.into_iter().map(|(dof, w)| (self.first + dof, w)).collect())
    }

    /// A base that moves in this direction, with the mass between its supports and the nodes that are free.
    ///
    /// # Errors
    /// What the element library has against the structure without its supports.
    pub fn on_base(
        &self,
        structure: &Structure,
        direction: Direction,
        unit: BaseUnit,
        stop_is_fixed: bool,
    ) -> Result<Option<BaseMotion>, FemError> {
        let free = Elements::new(&unsupported(structure))?.assemble(&[])?;
        let moving = match (structure.kind(), direction) {
            (StructureKind::Beam, Direction::Transverse) => DofKind::Deflection,
            _ => DofKind::Axial,
        };
        Ok(BaseMotion::of_supports(&self.model, &free, moving, &[], unit, stop_is_fixed))
    }
}

/// The structure as its elements are, without supports and imposed frequencies.
pub(super) fn unsupported(structure: &Structure) -> Structure {
    Structure { start: Support::Free, end: Support::Free, modes: None, ..structure.clone() }
}

/// The motion of a node of files in a direction; none where it is held.
///
/// # Errors
/// If there is no such node, in words.
pub fn node_weights(dofs: &[Dof], node: u64, direction: [f64; 3]) -> Result<Weights, String> {
    if !dofs.iter().any(|dof| dof.node as u64 == node) {
        return Err(format!("the structure has no node {node}, or its supports hold it in all directions"));
    }
    let find = |kind: DofKind| dofs.iter().position(|dof| dof.node as u64 == node && dof.kind == kind);
    let along = [DofKind::X, DofKind::Y, DofKind::Z].into_iter().zip(direction).filter(|(_, w)| *w != 0.0);
    Ok(along.filter_map(|(kind, w)| Some((find(kind)?, w))).collect())
}

/// The motion of a row (from 1) of a structure that was reduced elsewhere and has so many.
///
/// # Errors
/// If there is no such row, in words.
pub fn row_weights(rows: usize, row: usize) -> Result<Weights, String> {
    match row.checked_sub(1).filter(|row| *row < rows) {
        Some(index) => Ok(vec![(index, 1.0)]),
        None => Err(format!("there is no row {row}: `structure.contact_rows` has {rows}, counted from 1")),
    }
}

/// Along the axis of a beam: linear between the nodes.
fn axial_of_a_beam(mesh: &Mesh, dofs: &[Dof], at: f64) -> Result<Weights, FemError> {
    let nodes = mesh.nodes();
    if !(0.0..=mesh.length() * (1.0 + 1e-9)).contains(&at) {
        return Err(FemError::OutsideMesh { asked: at, length: mesh.length() });
    }
    let after = nodes.partition_point(|x| *x <= at).clamp(1, mesh.elements());
    let share = ((at - nodes[after - 1]) / (nodes[after] - nodes[after - 1])).clamp(0.0, 1.0);
    let find = |node: usize| dofs.iter().position(|dof| dof.node == node && dof.kind == DofKind::Axial);
    let both = [(after - 1, 1.0 - share), (after, share)];
    Ok(both.into_iter().filter(|(_, w)| *w != 0.0).filter_map(|(node, w)| Some((find(node)?, w))).collect())
}

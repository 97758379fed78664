//! What is fixed to the nodes of a rod or beam.

use nlmodes::fem::FemError;
use nlmodes::model::{DofKind, ModelError, StructuralModel};
use nlmodes_linalg::{SparseMatrix, Triplet, sparse_from_triplets, triplets};

use crate::scene::{GroundSpring, MassPoint, SpringDirection};

/// The model with these masses and springs on the diagonals of its matrices.
pub fn fixed_to(
    model: StructuralModel,
    masses: &[MassPoint],
    springs: &[GroundSpring],
) -> Result<StructuralModel, FemError> {
    if masses.is_empty() && springs.is_empty() {
        return Ok(model);
    }
    let at = |node: usize, kind: DofKind| model.dofs().iter().position(|dof| dof.node == node && dof.kind == kind);
    let heavy = |point: &MassPoint| {
        let kinds =
            [(DofKind::Axial, point.mass), (DofKind::Deflection, point.mass), (DofKind::Rotation, point.inertia)];
        kinds.into_iter().filter_map(|(kind, value)| Some((at(point.node, kind)?, value))).collect::<Vec<_>>()
    };
    let stiff = |spring: &GroundSpring| Some((at(spring.node, kind(spring.direction))?, spring.stiffness));
    let mass = with_diagonal(model.mass(), masses.iter().flat_map(heavy))?;
    let stiffness = with_diagonal(model.stiffness(), springs.iter().filter_map(stiff))?;
    Ok(StructuralModel::new(mass, stiffness, model.dofs().to_vec(), model.contacts().to_vec())?)
}

fn kind(direction: SpringDirection) -> DofKind {
    match direction {
        SpringDirection::Axial => DofKind::Axial,
        SpringDirection::Transverse => DofKind::Deflection,
        SpringDirection::Rotation => DofKind::Rotation,
    }
}

fn with_diagonal(a: &SparseMatrix, added: impl Iterator<Item = (usize, f64)>) -> Result<SparseMatrix, ModelError> {
    let entries: Vec<Triplet> = triplets(a).chain(added.map(|(i, value)| (i, i, value))).collect();
    sparse_from_triplets(a.nrows(), a.ncols(), &entries)
        .map_err(|source| ModelError::Linalg { what: "masses and springs at nodes", source })
}

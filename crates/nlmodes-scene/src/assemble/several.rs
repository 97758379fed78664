//! Several rods and beams as one structure with contacts between them.

use nlmodes::model::{Contact, Dof, DofKind, ModelError, Side, SparseDirection, StructuralModel};
use nlmodes_linalg::{SparseMatrix, Triplet, sparse_from_triplets, triplets};

use super::{Elements, StructureError, imposed, side};
use crate::scene::{self, Direction};

/// The structures side by side, the nodes of each numbered behind those of the one before; each keeps the positions along its own axis.
pub fn model(structures: &[scene::Structure], contacts: &[scene::Contact]) -> Result<StructuralModel, StructureError> {
    let (mut mass, mut stiffness): (Vec<Triplet>, Vec<Triplet>) = (Vec::new(), Vec::new());
    let (mut dofs, mut first_nodes, mut nodes) = (Vec::<Dof>::new(), Vec::new(), 0);
    for structure in structures {
        let elements = Elements::new(structure)?;
        let own = elements.assemble(&[])?;
        let own = imposed(structure, &own, None)?.map_or(own, |imposed| imposed.model);
        let first = dofs.len();
        let shifted = |a: &SparseMatrix| triplets(a).map(|(i, j, v)| (first + i, first + j, v)).collect::<Vec<_>>();
        mass.extend(shifted(own.mass()));
        stiffness.extend(shifted(own.stiffness()));
        dofs.extend(own.dofs().iter().map(|dof| Dof { node: nodes + dof.node, ..*dof }));
        first_nodes.push(nodes);
        nodes += elements.mesh().nodes().len();
    }
    let at = |structure: usize, node: usize, kind: DofKind| {
        let node = first_nodes.get(structure)? + node;
        dofs.iter().position(|dof| dof.node == node && dof.kind == kind)
    };
    let contact = |of: &scene::Contact| -> Result<Contact, ModelError> {
        let kind = match of.direction {
            Direction::Axial => DofKind::Axial,
            Direction::Transverse => DofKind::Deflection,
        };
        // The gap closes as the node moves toward what it touches, and opens as that moves away.
        let toward = match side(of.side) {
            Side::Positive => 1.0,
            Side::Negative => -1.0,
        };
        let own = at(of.structure, of.node, kind).map(|dof| (dof, -toward));
        let other = of.against.and_then(|other| at(other.structure, other.node, kind)).map(|dof| (dof, toward));
        let contact = Contact::new(SparseDirection::new(own.into_iter().chain(other))?, of.gap);
        Ok(of.stiffness.map_or(contact.clone(), |stiffness| contact.on_spring(stiffness)))
    };
    let contacts = contacts.iter().map(contact).collect::<Result<Vec<_>, _>>()?;
    let n = dofs.len();
    let sparse = |entries: &[Triplet]| sparse_from_triplets(n, n, entries);
    Ok(StructuralModel::new(sparse(&mass)?, sparse(&stiffness)?, dofs, contacts)?)
}

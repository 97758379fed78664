//! Contacts of rods and beams, which name the node that they are at.

use nlmodes::model::{Contact, Dof, DofKind, ModelError, Side, SparseDirection};

use crate::scene::{self, Direction};

/// A contact of the scene among degrees of freedom in the order of their nodes; the nodes of structure `k` are numbered
/// from `first_nodes[k]` on.
///
/// # Errors
/// [`ModelError`] where supports hold all that would move.
pub fn contact(of: &scene::Contact, dofs: &[Dof], first_nodes: &[usize]) -> Result<Contact, ModelError> {
    let kind = match of.direction {
        Direction::Axial => DofKind::Axial,
        Direction::Transverse => DofKind::Deflection,
    };
    // The gap closes as the node moves toward the obstacle, and opens as the obstacle recedes.
    let toward = side(of.side).sign();
    let at = |structure: usize, node: usize| {
        let node = first_nodes.get(structure)? + node;
        let first = dofs.partition_point(|dof| dof.node < node);
        let own = dofs[first..].iter().take_while(|dof| dof.node == node);
        own.zip(first..).find(|(dof, _)| dof.kind == kind).map(|(_, number)| number)
    };
    let own = at(of.structure, of.node).map(|dof| (dof, -toward));
    let other = of.against.and_then(|other| at(other.structure, other.node)).map(|dof| (dof, toward));
    let contact = Contact::new(SparseDirection::new(own.into_iter().chain(other))?, of.gap);
    Ok(match of.stiffness {
        Some(stiffness) => contact.on_spring(stiffness),
        None => contact,
    })
}

fn side(side: scene::Side) -> Side {
    match side {
        scene::Side::Positive => Side::Positive,
        scene::Side::Negative => Side::Negative,
    }
}

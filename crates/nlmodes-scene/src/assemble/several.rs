//! Several rods and beams as one structure with contacts between them.

use nlmodes::model::{Dof, StructuralModel};
use nlmodes_linalg::{SparseMatrix, Triplet, sparse_from_triplets, triplets};

use super::contact::contact;
use super::{Elements, StructureError, imposed};
use crate::scene;

/// The structures combined, with nodes numbered consecutively; each keeps the positions along its own axis.
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
    let stops = contacts.iter().filter(|of| of.hertz.is_none());
    let contacts = stops.map(|of| contact(of, &dofs, &first_nodes)).collect::<Result<Vec<_>, _>>()?;
    let n = dofs.len();
    let sparse = |entries: &[Triplet]| sparse_from_triplets(n, n, entries);
    Ok(StructuralModel::new(sparse(&mass)?, sparse(&stiffness)?, dofs, contacts)?)
}

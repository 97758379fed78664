//! Structures for the tests of this crate.

use nlmodes_linalg::sparse_from_triplets;

use crate::{Contact, Dof, DofKind, StructuralModel};

/// Unit masses and springs in a row at x = 1, 2 …, the first attached to the wall at x = 0 by a spring.
pub(crate) fn chain(n: usize, contacts: Vec<Contact>) -> StructuralModel {
    springs(n, 1.0, contacts, &(0..n).map(|i| (i, i, 1.0)).collect::<Vec<_>>())
}

/// Unit springs with the given mass entries; `wall` is the stiffness of the support of the first mass.
pub(crate) fn springs(n: usize, wall: f64, contacts: Vec<Contact>, mass: &[(usize, usize, f64)]) -> StructuralModel {
    let mut k = vec![(0, 0, wall)];
    for i in 1..n {
        k.extend([(i - 1, i - 1, 1.0), (i, i, 1.0), (i - 1, i, -1.0), (i, i - 1, -1.0)]);
    }
    let dofs = (0..n).map(|i| Dof { node: i, position: (i + 1) as f64, kind: DofKind::Axial }).collect();
    let matrix = |entries: &[(usize, usize, f64)]| sparse_from_triplets(n, n, entries).unwrap();
    StructuralModel::new(matrix(mass), matrix(&k), dofs, contacts).unwrap()
}

//! Assembly of element matrices to a structural model.

use nlmodes_linalg::{Triplet, sparse_from_triplets};
use nlmodes_model::{Contact, Dof, DofKind, ModelError, StructuralModel};

use crate::{ElementMatrices, FemError, Mesh, Stop, Support};

/// Nodes, the degrees of freedom of each node, and those fixed at the ends.
pub(crate) struct Layout<'a> {
    pub(crate) mesh: &'a Mesh,
    /// Kinds of the degrees of freedom of one node, in the order of the element matrices.
    pub(crate) kinds: &'a [DofKind],
    /// Support at the first and at the last node.
    pub(crate) supports: [Support; 2],
    /// The degrees of freedom fixed by a support.
    pub(crate) holds: fn(Support) -> &'static [DofKind],
}

/// Numbering of the free degrees of freedom.
struct Numbering {
    /// Number of each degree of freedom of each node; none if a support fixes it.
    numbers: Vec<Option<usize>>,
    dofs: Vec<Dof>,
}

impl Layout<'_> {
    /// Support of a node at an end.
    fn support(&self, node: usize) -> Option<Support> {
        match node {
            0 => Some(self.supports[0]),
            n if n == self.mesh.elements() => Some(self.supports[1]),
            _ => None,
        }
    }

    fn is_held(&self, node: usize, kind: DofKind) -> bool {
        self.support(node).is_some_and(|s| (self.holds)(s).contains(&kind))
    }

    /// Numbers the free degrees of freedom node by node.
    fn number(&self) -> Result<Numbering, FemError> {
        let mut numbering = Numbering { numbers: Vec::new(), dofs: Vec::new() };
        for (node, &position) in self.mesh.nodes().iter().enumerate() {
            for &kind in self.kinds {
                let free = !self.is_held(node, kind);
                numbering.numbers.push(free.then_some(numbering.dofs.len()));
                numbering.dofs.extend(free.then_some(Dof { node, position, kind }));
            }
        }
        if numbering.dofs.is_empty() { Err(FemError::NothingMoves) } else { Ok(numbering) }
    }

    /// The contact that a stop makes.
    fn contact(&self, stop: &Stop, numbering: &Numbering) -> Result<Contact, FemError> {
        let Stop { position, direction, side, gap, law } = *stop;
        let node = self.mesh.find_node(position)?;
        let Some(offset) = self.kinds.iter().position(|&k| k == direction.kind()) else {
            return Err(FemError::NoSuchDirection { position, direction });
        };
        match (numbering.numbers[node * self.kinds.len() + offset], self.support(node)) {
            (Some(dof), _) => Ok(Contact { law, ..Contact::stop(dof, side, gap) }),
            (None, support) => Err(FemError::HeldDof { position, direction, support: support.unwrap_or_default() }),
        }
    }
}

/// Assembles the element matrices, which are functions of the number and length of the element, for the free degrees of
/// freedom.
pub(crate) fn assemble<const N: usize>(
    layout: &Layout,
    stops: &[Stop],
    element: impl Fn(usize, f64) -> ElementMatrices<N>,
) -> Result<StructuralModel, FemError> {
    let numbering = layout.number()?;
    let contacts = stops.iter().map(|s| layout.contact(s, &numbering)).collect::<Result<Vec<_>, _>>()?;
    let (mut mass, mut stiffness) = (Vec::new(), Vec::new());
    for (i, &length) in layout.mesh.element_lengths().iter().enumerate() {
        let matrices = element(i, length);
        check_finite(layout, i, &matrices)?;
        // The two nodes of an element have consecutive numbers.
        let numbers = &numbering.numbers[i * layout.kinds.len()..][..N];
        scatter(&mut mass, &matrices.mass, numbers);
        scatter(&mut stiffness, &matrices.stiffness, numbers);
    }
    let n = numbering.dofs.len();
    let sparse = |entries: &[Triplet]| {
        sparse_from_triplets(n, n, entries).map_err(|source| ModelError::Linalg { what: "assembly", source })
    };
    Ok(StructuralModel::new(sparse(&mass)?, sparse(&stiffness)?, numbering.dofs, contacts)?)
}

fn scatter<const N: usize>(
    entries: &mut Vec<Triplet>,
    matrix: &nalgebra::SMatrix<f64, N, N>,
    numbers: &[Option<usize>],
) {
    for (i, row) in numbers.iter().enumerate() {
        for (j, column) in numbers.iter().enumerate() {
            if let (Some(row), Some(column)) = (row, column)
                && matrix[(i, j)] != 0.0
            {
                entries.push((*row, *column, matrix[(i, j)]));
            }
        }
    }
}

/// Extreme dimensions overflow in the powers of an element length.
fn check_finite<const N: usize>(layout: &Layout, i: usize, matrices: &ElementMatrices<N>) -> Result<(), FemError> {
    let finite =
        |row: usize| matrices.stiffness.row(row).iter().chain(matrices.mass.row(row).iter()).all(|v| v.is_finite());
    match (0..N).find(|&row| !finite(row)) {
        Some(row) => {
            let kind = layout.kinds[row % layout.kinds.len()];
            Err(FemError::Overflow { from: layout.mesh.nodes()[i], to: layout.mesh.nodes()[i + 1], kind })
        }
        None => Ok(()),
    }
}

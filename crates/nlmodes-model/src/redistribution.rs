use nlmodes_linalg::{LinalgError, SparseCholesky, SparseMatrix, Triplet, select, sparse_from_triplets, triplets};

use crate::massless::contact_dofs;
use crate::rigid::positions;
use crate::{Dof, ModelError, StructuralModel};

/// Removes the mass from the contact degrees of freedom, eq. (12).
pub trait MassRedistribution {
    /// Name in scenes and result files.
    fn name(&self) -> &'static str;

    /// Redistributed mass matrix `M_R` (n × n), with zero rows and columns at the contact degrees of freedom.
    ///
    /// # Errors
    /// [`ModelError`] if the rule cannot be applied.
    fn redistribute(&self, model: &StructuralModel) -> Result<SparseMatrix, ModelError>;
}

/// The paper's rule: the mass of the contact degrees of freedom is neglected.
///
/// Their rows and columns of `M` become zero, coupling terms included. The frequencies rise; the change vanishes with
/// the length of the elements at the contact.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Drop;

/// The mass of a contact degree of freedom is moved to its neighbours of the same kind; total mass and centre of mass
/// are conserved.
///
/// Removing row and column `d` of `M` removes the mass `Δm` and the first moment `Δs` of [`MassProperties`], those of
/// the kind of `d`. They are restored as two point masses at neighbours at `x_1` and `x_2`,
///
/// ```text
/// m_1 + m_2 = Δm ,   m_1 x_1 + m_2 x_2 = Δs ,
/// ```
///
/// added to the diagonal of `M`. The neighbours are the nearest degrees of freedom of the same kind that have mass and
/// no contact: one on either side, or the nearest two if the contact is at an end. There the farther one gets a
/// negative mass, which is smaller than its own for usual meshes; otherwise there is an error.
///
/// Kept exactly, apart from rounding: for each kind of displacement that a contact has, total mass and first moment,
/// and so the centre of mass. Not kept: moment of inertia and, with it, the frequencies of rigid rotation;
/// [`Conserve`](crate::Conserve) conserves that too.
///
/// [`MassProperties`]: crate::MassProperties
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Move;

impl MassRedistribution for Drop {
    fn name(&self) -> &'static str {
        "drop"
    }

    fn redistribute(&self, model: &StructuralModel) -> Result<SparseMatrix, ModelError> {
        from_entries(model.dofs().len(), &without(model.mass(), &contact_dofs(model)))
    }
}

impl MassRedistribution for Move {
    fn name(&self) -> &'static str {
        "move"
    }

    fn redistribute(&self, model: &StructuralModel) -> Result<SparseMatrix, ModelError> {
        let (n, contacts) = (model.dofs().len(), contact_dofs(model));
        refuse_in_space(self.name(), model.dofs(), &contacts)?;
        let mut entries = without(model.mass(), &contacts);
        let massive: Vec<usize> = entries.iter().filter(|e| e.0 == e.1 && e.2 > 0.0).map(|e| e.0).collect();
        for (i, &dof) in contacts.iter().enumerate() {
            // Mass removed with previous contacts must not be moved twice.
            let taken = Taken::from(model, dof, &contacts[..i]);
            if taken.mass != 0.0 || taken.moment != 0.0 {
                let [a, b] = neighbours(model.dofs(), dof, &massive)?;
                let (x_a, x_b) = (model.dofs()[a].position, model.dofs()[b].position);
                let m_a = (taken.moment - taken.mass * x_b) / (x_a - x_b);
                entries.extend([(a, a, m_a), (b, b, taken.mass - m_a)]);
            }
        }
        let mass = from_entries(n, &entries)?;
        check_definite(&mass, &massive, model.dofs())?;
        Ok(mass)
    }
}

/// Positions along an axis do not determine neighbours in space.
pub(crate) fn refuse_in_space(rule: &'static str, dofs: &[Dof], contacts: &[usize]) -> Result<(), ModelError> {
    match contacts.iter().find(|&&dof| dofs[dof].kind.is_spatial()) {
        Some(&dof) => Err(ModelError::StraightOnly { rule, dof }),
        None => Ok(()),
    }
}

/// Entries of `mass` that are in no row and no column of `gone` (ascending).
pub(crate) fn without(mass: &SparseMatrix, gone: &[usize]) -> Vec<Triplet> {
    let stays = |i: usize| gone.binary_search(&i).is_err();
    triplets(mass).filter(|&(i, j, _)| stays(i) && stays(j)).collect()
}

pub(crate) fn from_entries(n: usize, entries: &[Triplet]) -> Result<SparseMatrix, ModelError> {
    sparse_from_triplets(n, n, entries).map_err(ModelError::during("redistributed mass matrix"))
}

/// `Δm` and `Δs` that go with row and column `dof`.
struct Taken {
    mass: f64,
    moment: f64,
}

impl Taken {
    fn from(model: &StructuralModel, dof: usize, gone: &[usize]) -> Self {
        let dofs = model.dofs();
        let rho = positions(dofs, dofs[dof].kind);
        let mut taken = Self { mass: 0.0, moment: 0.0 };
        // The matrix is symmetric: column `dof` is its row, too.
        for (&j, &m) in model.mass().symbolic().row_idx_of_col_raw(dof).iter().zip(model.mass().val_of_col(dof)) {
            if gone.contains(&j) {
                continue;
            }
            taken.moment += m * rho[j];
            let same_kind = dofs[j].kind == dofs[dof].kind;
            taken.mass += if same_kind { m } else { 0.0 };
            if same_kind && j != dof {
                taken.mass += m;
                taken.moment += m * rho[dof];
            }
        }
        taken
    }
}

/// The nearest of `massive` on either side of `dof`, or the nearest two on the only side that has some.
fn neighbours(dofs: &[Dof], dof: usize, massive: &[usize]) -> Result<[usize; 2], ModelError> {
    let Dof { position, kind, .. } = dofs[dof];
    let offset = |i: usize| dofs[i].position - position;
    let mut near: Vec<usize> = massive.iter().copied().filter(|&i| dofs[i].kind == kind && offset(i) != 0.0).collect();
    near.sort_by(|&i, &j| offset(i).abs().total_cmp(&offset(j).abs()));
    near.dedup_by_key(|i| dofs[*i].position);
    let Some(&first) = near.first() else {
        return Err(ModelError::TooFewNeighbours { dof, position, kind, found: 0 });
    };
    let opposite = near.iter().find(|&&i| offset(i) * offset(first) < 0.0);
    match opposite.or(near.get(1)) {
        Some(&second) => Ok([first, second]),
        None => Err(ModelError::TooFewNeighbours { dof, position, kind, found: 1 }),
    }
}

pub(crate) fn check_definite(mass: &SparseMatrix, massive: &[usize], dofs: &[Dof]) -> Result<(), ModelError> {
    let block = select(mass, massive, massive).map_err(ModelError::during("redistributed mass matrix"))?;
    match SparseCholesky::factor(&block, "redistributed mass matrix") {
        Ok(_) => Ok(()),
        Err(LinalgError::NotPositiveDefinite { column, .. }) => {
            let Dof { position, kind, .. } = dofs[massive[column]];
            Err(ModelError::IndefiniteMass { dof: massive[column], position, kind })
        }
        Err(source) => Err(ModelError::Linalg { what: "redistributed mass matrix", source }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_chain::{chain, springs};
    use crate::{Contact, DofKind, MassProperties, Side};

    fn stops(dofs: &[usize]) -> Vec<Contact> {
        dofs.iter().map(|&dof| Contact::rigid(dof, Side::Positive, 0.1)).collect()
    }

    /// Consistent mass of unit elements, `[2 1; 1 2] / 6` each.
    fn consistent(n: usize) -> Vec<Triplet> {
        let mut entries = vec![(0, 0, 2.0 / 6.0)];
        for i in 1..n {
            let pairs = [(i - 1, i - 1, 2.0), (i, i, 2.0), (i - 1, i, 1.0), (i, i - 1, 1.0)];
            entries.extend(pairs.map(|(i, j, m)| (i, j, m / 6.0)));
        }
        entries
    }

    fn properties(mass: &SparseMatrix, model: &StructuralModel) -> MassProperties {
        MassProperties::of(mass, model.dofs(), DofKind::Axial)
    }

    #[test]
    fn dropping_leaves_no_entry_in_rows_and_columns_of_the_contacts() {
        let model = springs(6, 1.0, stops(&[5, 2]), &consistent(6));
        let mass = Drop.redistribute(&model).unwrap();
        assert!(triplets(&mass).all(|(i, j, _)| ![2, 5].contains(&i) && ![2, 5].contains(&j)));
        assert_eq!(mass[(0, 1)], model.mass()[(0, 1)]);
        assert_eq!(mass[(4, 4)], model.mass()[(4, 4)]);
    }

    #[test]
    fn moving_keeps_mass_and_centre_for_contacts_at_the_end_inside_and_next_to_each_other() {
        let lumped = (0..9).map(|i| (i, i, if i == 8 { 0.5 } else { 1.0 })).collect();
        for mass in [consistent(9), lumped] {
            for dofs in [&[8][..], &[4], &[3, 4], &[4, 4, 8], &[2, 5]] {
                let model = springs(9, 1.0, stops(dofs), &mass);
                let moved = Move.redistribute(&model).unwrap();
                assert!(triplets(&moved).all(|(i, j, _)| !dofs.contains(&i) && !dofs.contains(&j)));
                let (before, after) = (properties(model.mass(), &model), properties(&moved, &model));
                assert!((after.total / before.total - 1.0).abs() < 1e-14, "{dofs:?}");
                assert!((after.centre() / before.centre() - 1.0).abs() < 1e-14, "{dofs:?}");
            }
        }
    }

    #[test]
    fn an_interior_lumped_mass_goes_to_both_neighbours_in_equal_parts() {
        for unit in [1.0, 1e-6, 1e6] {
            let masses: Vec<Triplet> = (0..5).map(|i| (i, i, unit)).collect();
            let mass = Move.redistribute(&springs(5, 1.0, stops(&[2]), &masses)).unwrap();
            let expected = [1.0, 1.5, 0.0, 1.5, 1.0];
            for (i, m) in expected.iter().enumerate() {
                assert!((mass.get(i, i).copied().unwrap_or(0.0) / unit - m).abs() < 1e-15);
            }
        }
    }

    /// A node of another part may be at the same position: it is on neither side.
    #[test]
    fn a_mass_at_the_place_of_the_contact_is_no_neighbour() {
        let row = springs(6, 1.0, stops(&[2]), &(0..6).map(|i| (i, i, 1.0)).collect::<Vec<_>>());
        let mut dofs = row.dofs().to_vec();
        dofs[5].position = dofs[2].position;
        let model = StructuralModel::new(row.mass().clone(), row.stiffness().clone(), dofs, stops(&[2])).unwrap();
        let mass = Move.redistribute(&model).unwrap();
        let expected = [1.0, 1.5, 0.0, 1.5, 1.0, 1.0];
        (0..6).for_each(|i| assert_eq!(mass.get(i, i).copied().unwrap_or(0.0), expected[i], "{i}"));
    }

    #[test]
    fn a_heavy_end_cannot_be_moved_without_making_the_mass_indefinite() {
        let mass: Vec<_> = (0..5).map(|i| (i, i, if i == 4 { 3.0 } else { 1.0 })).collect();
        let error = Move.redistribute(&springs(5, 1.0, stops(&[4]), &mass)).unwrap_err();
        assert_eq!(error, ModelError::IndefiniteMass { dof: 2, position: 3.0, kind: DofKind::Axial });
    }

    #[test]
    fn a_contact_without_mass_has_nothing_to_move() {
        let model = springs(2, 1.0, stops(&[1]), &[(0, 0, 1.0)]);
        let mass = Move.redistribute(&model).unwrap();
        assert_eq!((mass[(0, 0)], mass.get(1, 1)), (1.0, None));
    }

    #[test]
    fn a_contact_without_two_neighbours_cannot_be_moved() {
        for (n, found) in [(1, 0), (2, 1)] {
            let error = Move.redistribute(&chain(n, stops(&[n - 1]))).unwrap_err();
            let position = n as f64;
            assert_eq!(error, ModelError::TooFewNeighbours { dof: n - 1, position, kind: DofKind::Axial, found });
        }
    }
}

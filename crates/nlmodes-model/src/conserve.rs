use nlmodes_linalg::{DenseLu, Mat, SparseMatrix, Triplet, bilinear, max_norm};

use crate::massless::contact_dofs;
use crate::redistribution::{check_definite, from_entries, refuse_in_space, without};
use crate::rigid::{positions, translation};
use crate::{Dof, MassRedistribution, ModelError, StructuralModel};

/// Largest fraction of its inertia that a degree of freedom may lose.
const LARGEST_LOSS: f64 = 0.7;

/// Distances of two nodes that differ by less than this, relatively, are equal to rounding: then both sides of a
/// contact participate, or none.
const EQUALLY_FAR: f64 = 1e-9;

/// The mass of a contact degree of freedom is moved to its neighbours such that total mass, centre of mass and moment
/// of inertia are conserved.
///
/// Removing row and column `d` of `M` removes mass, first and second moment of [`MassProperties`]: those of the kind of
/// `d`, `Δ(uᵀ M v)` for `u, v ∈ {r, ρ}`. They are restored as point masses and rotary inertias `δ_i` on the diagonal of
/// `M`, chosen for the least relative change of the inertias,
///
/// ```text
/// min Σ_i (δ_i/m_ii)²   subject to   Σ_i r_i² δ_i = Δm ,   Σ_i r_i ρ_i δ_i = Δs ,   Σ_i ρ_i² δ_i = ΔJ
/// ```
///
/// over the nodes next to the contact: as few as possible without any inertia decreasing by more than 70 % and with a
/// mass matrix that remains positive definite. For deflections the rotations of these nodes participate, including that
/// of the contact node.
///
/// Kept exactly, apart from rounding: the response to rigid motions. The idea of conserving these three is that of
/// Khenous, Laborde, Renard (2008), who minimise over the whole matrix; here the change is confined to the
/// neighbourhood of the contact, where the mode shapes hardly differ from a parabola.
///
/// [`MassProperties`]: crate::MassProperties
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Conserve;

impl MassRedistribution for Conserve {
    fn name(&self) -> &'static str {
        "conserve"
    }

    fn redistribute(&self, model: &StructuralModel) -> Result<SparseMatrix, ModelError> {
        let (n, contacts) = (model.dofs().len(), contact_dofs(model));
        refuse_in_space(self.name(), model.dofs(), &contacts)?;
        let mut entries = without(model.mass(), &contacts);
        let inertias: Vec<(usize, f64)> =
            entries.iter().filter(|e| e.0 == e.1 && e.2 > 0.0).map(|e| (e.0, e.2)).collect();
        let massive: Vec<usize> = inertias.iter().map(|i| i.0).collect();
        for (i, &dof) in contacts.iter().enumerate() {
            let moments = Moments::about(model.dofs(), dof);
            // Mass removed with previous contacts must not be moved twice.
            let before = moments.of(&from_entries(n, &without(model.mass(), &contacts[..i]))?);
            let after = moments.of(&from_entries(n, &without(model.mass(), &contacts[..=i]))?);
            let lost: Vec<f64> = before.iter().zip(after).map(|(b, a)| b - a).collect();
            if lost.iter().any(|l| *l != 0.0) {
                entries = moments.give_back(&entries, &lost, &inertias, &massive, model.dofs(), dof)?;
            }
        }
        from_entries(n, &entries)
    }
}

/// Rigid motions of the kind of a contact: translation `r`, and `ρ` about the contact.
struct Moments {
    r: Vec<f64>,
    rho: Vec<f64>,
}

impl Moments {
    fn about(dofs: &[Dof], contact: usize) -> Self {
        let Dof { position, kind, .. } = dofs[contact];
        let r = translation(dofs, kind);
        let rho = positions(dofs, kind).iter().zip(&r).map(|(rho, r)| rho - position * r).collect();
        Self { r, rho }
    }

    /// Mass, first and second moment about the contact.
    fn of(&self, mass: &SparseMatrix) -> [f64; 3] {
        [(&self.r, &self.r), (&self.r, &self.rho), (&self.rho, &self.rho)].map(|(u, v)| bilinear(u, mass, v))
    }

    /// Share of a unit inertia at degree of freedom `i` in the three, lengths over `length`.
    fn shares(&self, i: usize, length: f64) -> [f64; 3] {
        let (r, rho) = (self.r[i], self.rho[i] / length);
        [r * r, r * rho, rho * rho]
    }

    /// `entries` with the lost inertia restored at as few nodes around the contact as possible.
    fn give_back(
        &self,
        entries: &[Triplet],
        lost: &[f64],
        inertias: &[(usize, f64)],
        massive: &[usize],
        dofs: &[Dof],
        contact: usize,
    ) -> Result<Vec<Triplet>, ModelError> {
        let Dof { position, kind, .. } = dofs[contact];
        let distance = |i: usize| (dofs[i].position - position).abs();
        let moves = |i: usize| self.r[i] != 0.0 || self.rho[i] != 0.0;
        let mut takers: Vec<(usize, f64)> = inertias.iter().copied().filter(|t| moves(t.0)).collect();
        takers.sort_by(|a, b| distance(a.0).total_cmp(&distance(b.0)));
        let mut indefinite = None;
        for count in 1..=takers.len() {
            let farthest = distance(takers[count - 1].0);
            let is_whole_node = takers.get(count).is_none_or(|next| distance(next.0) > (1.0 + EQUALLY_FAR) * farthest);
            let change = is_whole_node.then(|| self.least_change(&takers[..count], lost, farthest));
            let Some(change) = change.flatten() else { continue };
            let given: Vec<Triplet> = entries.iter().copied().chain(change).collect();
            match check_definite(&from_entries(dofs.len(), &given)?, massive, dofs) {
                Ok(()) => return Ok(given),
                Err(error) => indefinite = Some(error),
            }
        }
        let too_few = ModelError::TooFewNeighbours { dof: contact, position, kind, found: takers.len() };
        Err(indefinite.unwrap_or(too_few))
    }

    /// Diagonal inertias that restore the lost ones; `None` if these degrees of freedom cannot take them, for instance
    /// if all of them are at the contact (`length` is zero, and the matrix has no finite entries).
    fn least_change(&self, takers: &[(usize, f64)], lost: &[f64], length: f64) -> Option<Vec<Triplet>> {
        let size = max_norm(takers.iter().map(|t| t.1 * self.shares(t.0, length)[0]));
        let gram = Mat::from_fn(3, 3, |a, b| {
            let product = |t: &(usize, f64)| {
                let shares = self.shares(t.0, length);
                (t.1 / size).powi(2) * shares[a] * shares[b]
            };
            takers.iter().map(product).sum()
        });
        let wanted = [lost[0], lost[1] / length, lost[2] / (length * length)];
        let mut multipliers = wanted.to_vec();
        DenseLu::factor(&gram).ok()?.solve_in_place(&mut multipliers);
        let change = |t: &(usize, f64)| {
            let shares = self.shares(t.0, length);
            let sum: f64 = shares.iter().zip(&multipliers).map(|(s, m)| s * m).sum();
            (t.0, t.0, (t.1 / size).powi(2) * sum)
        };
        let change: Vec<Triplet> = takers.iter().map(change).collect();
        let scale = max_norm(wanted);
        let is_met = (0..3).all(|a| {
            let found: f64 = change.iter().map(|c| c.2 * self.shares(c.0, length)[a]).sum();
            (found - wanted[a]).abs() <= 1e-12 * scale
        });
        let is_small = change.iter().zip(takers).all(|(c, t)| c.2 >= -LARGEST_LOSS * t.1);
        (is_met && is_small).then_some(change)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_chain::springs;
    use crate::{Contact, DofKind, MassProperties, Side};
    use nlmodes_linalg::triplets;

    fn stops(dofs: &[usize]) -> Vec<Contact> {
        dofs.iter().map(|&dof| Contact::rigid(dof, Side::Positive, 0.1)).collect()
    }

    /// Unit masses, half of one at the end.
    fn lumped(n: usize) -> Vec<Triplet> {
        (0..n).map(|i| (i, i, if i + 1 == n { 0.5 } else { 1.0 })).collect()
    }

    #[test]
    fn the_change_keeps_three_moments_and_is_the_least_of_those_that_do() {
        for contacts in [&[11][..], &[5], &[5, 6], &[2, 11]] {
            let model = springs(12, 1.0, stops(contacts), &lumped(12));
            let mass = Conserve.redistribute(&model).unwrap();
            let of = |mass| MassProperties::of(mass, model.dofs(), DofKind::Axial);
            let (before, after) = (of(model.mass()), of(&mass));
            assert!((after.total / before.total - 1.0).abs() < 1e-14, "{contacts:?}");
            assert!((after.first_moment / before.first_moment - 1.0).abs() < 1e-14, "{contacts:?}");
            assert!((after.moment_of_inertia / before.moment_of_inertia - 1.0).abs() < 1e-14, "{contacts:?}");
            assert!(contacts.iter().all(|&c| (0..12).all(|j| mass.get(c, j).copied().unwrap_or(0.0) == 0.0)));
        }
        // Least squares with a third difference as its null space: the change of equal masses has none.
        let model = springs(12, 1.0, stops(&[11]), &lumped(12));
        let mass = Conserve.redistribute(&model).unwrap();
        let change: Vec<f64> = (0..11).map(|i| mass[(i, i)] - 1.0).collect();
        let takers: Vec<f64> = change.iter().copied().filter(|c| c.abs() > 1e-15).collect();
        assert!(takers.len() > 3 && takers.len() < 10, "{change:?}");
        for four in takers.windows(4) {
            assert!((four[3] - 3.0 * four[2] + 3.0 * four[1] - four[0]).abs() < 1e-13, "{takers:?}");
        }
    }

    /// Nodes on either side of a contact are equally far from it up to rounding, which depends on the unit.
    #[test]
    fn the_change_is_the_same_in_any_unit_of_length() {
        let changed = |unit: f64| {
            let model = springs(12, 1.0, stops(&[6]), &lumped(12));
            let dofs: Vec<Dof> = model.dofs().iter().map(|dof| Dof { position: unit * dof.position, ..*dof }).collect();
            let (mass, stiffness) = (model.mass().clone(), model.stiffness().clone());
            let model = StructuralModel::new(mass, stiffness, dofs, stops(&[6])).unwrap();
            let mass = Conserve.redistribute(&model).unwrap();
            (0..12).map(|i| mass.get(i, i).copied().unwrap_or(0.0)).collect::<Vec<f64>>()
        };
        let expected = changed(1.0);
        for unit in [0.1, 0.3, 0.7, 1.0 / 3.0, 12.34, 1e-3, 7e5] {
            assert!(changed(unit).iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-9), "{unit}");
        }
    }

    #[test]
    fn no_inertia_loses_more_than_its_share() {
        let model = springs(12, 1.0, stops(&[11]), &lumped(12));
        let mass = Conserve.redistribute(&model).unwrap();
        assert!((0..11).all(|i| mass[(i, i)] >= 1.0 - LARGEST_LOSS));
    }

    #[test]
    fn what_is_given_back_goes_to_the_nodes_around_the_contact() {
        for contact in [11, 7] {
            let model = springs(12, 1.0, stops(&[contact]), &lumped(12));
            let mass = Conserve.redistribute(&model).unwrap();
            let change = |i: usize| (mass.get(i, i).copied().unwrap_or(0.0) - model.mass()[(i, i)]).abs();
            let changed: Vec<usize> = (0..12).filter(|&i| i != contact && change(i) > 1e-12).collect();
            let reach = changed.iter().map(|i| i.abs_diff(contact)).max().unwrap();
            let left = (0..12).filter(|&i| i != contact && i.abs_diff(contact) > reach).count();
            assert!(left > 2 && changed.len() + left >= 10, "{contact}: {changed:?}");
        }
    }

    #[test]
    fn a_contact_without_mass_has_nothing_to_give_back() {
        let model = springs(3, 1.0, stops(&[2]), &[(0, 0, 1.0), (1, 1, 1.0)]);
        let mass = Conserve.redistribute(&model).unwrap();
        assert_eq!((mass[(0, 0)], mass[(1, 1)], mass.get(2, 2)), (1.0, 1.0, None));
    }

    /// A transverse mass next to the contact cannot take any of it, and is not counted.
    #[test]
    fn what_a_contact_does_not_move_is_no_neighbour() {
        let along = springs(3, 1.0, stops(&[2]), &lumped(3));
        let beside = |a: &SparseMatrix| from_entries(4, &triplets(a).chain([(3, 3, 1.0)]).collect::<Vec<_>>()).unwrap();
        let across = Dof { node: 3, position: 2.5, kind: DofKind::Deflection };
        let dofs: Vec<Dof> = along.dofs().iter().copied().chain([across]).collect();
        let model = StructuralModel::new(beside(along.mass()), beside(along.stiffness()), dofs, stops(&[2])).unwrap();
        let error = Conserve.redistribute(&model).unwrap_err();
        assert_eq!(error, ModelError::TooFewNeighbours { dof: 2, position: 3.0, kind: DofKind::Axial, found: 2 });
    }

    #[test]
    fn a_chain_that_is_too_short_is_refused() {
        let error = Conserve.redistribute(&springs(3, 1.0, stops(&[2]), &lumped(3))).unwrap_err();
        let position = 3.0;
        assert_eq!(error, ModelError::TooFewNeighbours { dof: 2, position, kind: DofKind::Axial, found: 2 });
    }
}

use nlmodes_linalg::{Mat, SparseMatrix, Triplet, max_norm, multiply, sparse_from_triplets, triplets};

use crate::{DofKind, LinearModes, MassRedistribution, ModelError, StructuralModel, linear_modes};

/// Maximum number of degrees of freedom that participate in modes with imposed frequencies: their stiffness matrix is
/// full.
pub const MAX_IMPOSED_DOFS: usize = 2000;
/// A mode has no motion in a kind of degree of freedom if its components are below this fraction of the largest.
const REST: f64 = 1e-9;
/// A mode is a rigid-body motion if its frequency is below this fraction of the highest one considered.
const RIGID: f64 = 1e-6;

/// A structure whose lowest modes have imposed frequencies, as of a measurement.
///
/// With the linear modes `K φ_k = ω_k² M φ_k`, with open contacts and the mass of the method, and the imposed
/// frequencies `ω'_k`, the stiffness becomes
///
/// ```text
/// K' = K + Σ_k M φ_k (ω'_k² − ω_k²) φ_kᵀ M
/// ```
///
/// so that `K' φ_k = ω'_k² M φ_k`, and all other modes are unchanged. Mass and shapes are those of the finite elements,
/// and so is the static flexibility of the other modes, in particular that of a massless contact node: `M φ_k` has no
/// entry there, and `K_NN`, `K_NL` do not change. Nevertheless the model is a modal one: there need not be a stiffness
/// distribution along the structure with this `K'`, which couples all degrees of freedom that the modes move.
#[derive(Debug, Clone)]
pub struct ImposedFrequencies {
    /// The structure with `K'`; its mass and contacts are unchanged.
    pub model: StructuralModel,
    /// Original angular eigenfrequencies `ω_k` of the modes, rad/s.
    pub own: Vec<f64>,
    /// Their numbers among all linear modes of the original structure, from 0.
    pub numbers: Vec<usize>,
}

impl StructuralModel {
    /// Imposes the angular frequencies `omega` (rad/s, ascending) on the lowest modes in which degrees of freedom of
    /// this kind move: there may be other modes between the bending modes of a beam. `rule` is applied to the mass of
    /// the contacts first; the modes are those with the redistributed mass.
    ///
    /// # Errors
    /// [`ModelError::ImposedFrequency`] for one that is not positive or not above the previous one,
    /// [`ModelError::TooManyImposed`], [`ModelError::ImposedAboveNext`] if the last one exceeds that of the next mode,
    /// which is kept, [`ModelError::ImposedOnRigidBody`], [`ModelError::ImposedSize`] beyond [`MAX_IMPOSED_DOFS`]; and
    /// the errors of `rule` and the eigenproblem.
    ///
    /// # Example
    /// Two unit masses between three unit springs, with the second mode moved from √3 to 2 rad/s: the first mode and
    /// the shapes are unchanged.
    /// ```
    /// use nlmodes_linalg::sparse_from_triplets;
    /// use nlmodes_model::{Dof, DofKind, StructuralModel, linear_modes};
    ///
    /// let k = sparse_from_triplets(2, 2, &[(0, 0, 2.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 2.0)])?;
    /// let m = sparse_from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0)])?;
    /// let dofs = [1.0, 2.0].map(|position| Dof { node: 0, position, kind: DofKind::Axial }).to_vec();
    /// let imposed = StructuralModel::new(m, k, dofs, vec![])?.with_frequencies(None, DofKind::Axial, &[1.0, 2.0])?;
    /// assert!((imposed.own[1] - 3f64.sqrt()).abs() < 1e-14);
    /// let modes = linear_modes(imposed.model.mass(), imposed.model.stiffness(), 2)?;
    /// assert!((modes.omega[0] - 1.0).abs() < 1e-14 && (modes.omega[1] - 2.0).abs() < 1e-14);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_frequencies(
        &self,
        rule: Option<&dyn MassRedistribution>,
        kind: DofKind,
        omega: &[f64],
    ) -> Result<ImposedFrequencies, ModelError> {
        check_ascending(omega)?;
        let redistributed = rule.map(|rule| rule.redistribute(self)).transpose()?;
        let mass = redistributed.as_ref().unwrap_or(self.mass());
        let (modes, numbers, next) = self.lowest_of_kind(mass, kind, omega.len())?;
        let highest = max_norm(modes.omega.iter().copied());
        if let Some(&k) = numbers.iter().find(|&&k| modes.omega[k] <= RIGID * highest) {
            return Err(ModelError::ImposedOnRigidBody { mode: k + 1 });
        }
        if let (Some(next), Some(&last)) = (next.map(|k| modes.omega[k]), omega.last())
            && last >= next
        {
            return Err(ModelError::ImposedAboveNext { imposed: last, next });
        }
        let own: Vec<f64> = numbers.iter().map(|&k| modes.omega[k]).collect();
        let inertia: Vec<Vec<f64>> = numbers.iter().map(|&k| self.inertia(mass, &modes.shapes, k)).collect();
        let change: Vec<f64> = omega.iter().zip(&own).map(|(new, old)| (new - old) * (new + old)).collect();
        let stiffness = updated(self.stiffness(), &inertia, &change)?;
        let model = self.with_stiffness(stiffness)?;
        Ok(ImposedFrequencies { model, own, numbers })
    }

    /// Numbers, from 0, of the lowest `count` linear modes in which degrees of freedom of this kind move; `rule` is
    /// applied to the mass of the contacts first.
    ///
    /// # Errors
    /// [`ModelError::TooManyImposed`]; and the errors of `rule` and the eigenproblem.
    pub fn modes_of_kind(
        &self,
        rule: Option<&dyn MassRedistribution>,
        kind: DofKind,
        count: usize,
    ) -> Result<Vec<usize>, ModelError> {
        let redistributed = rule.map(|rule| rule.redistribute(self)).transpose()?;
        let (_, numbers, _) = self.lowest_of_kind(redistributed.as_ref().unwrap_or(self.mass()), kind, count)?;
        Ok(numbers)
    }

    /// Modes, the numbers of the lowest of this kind, and that of the next one.
    fn lowest_of_kind(
        &self,
        mass: &SparseMatrix,
        kind: DofKind,
        count: usize,
    ) -> Result<(LinearModes, Vec<usize>, Option<usize>), ModelError> {
        let size = self.dofs().len();
        // There are modes of other kinds in between: twice the number is nearly always enough.
        let mut wanted = (2 * count + 4).min(size);
        loop {
            let modes = linear_modes(mass, self.stiffness(), wanted)?;
            let mut of_kind = (0..modes.omega.len()).filter(|&k| self.moves(&modes.shapes, k, kind));
            let numbers: Vec<usize> = of_kind.by_ref().take(count).collect();
            let next = of_kind.next();
            let is_all = wanted == size;
            if next.is_none() && !is_all {
                wanted = (2 * wanted).min(size);
                continue;
            }
            if numbers.len() < count {
                return Err(ModelError::TooManyImposed { wanted: count, found: numbers.len(), kind });
            }
            return Ok((modes, numbers, next));
        }
    }

    fn moves(&self, shapes: &Mat<f64>, k: usize, kind: DofKind) -> bool {
        self.largest(shapes, k, |of| of == kind) > REST * self.largest(shapes, k, |_| true)
    }

    /// Largest component of mode `k` among these kinds.
    fn largest(&self, shapes: &Mat<f64>, k: usize, of: impl Fn(DofKind) -> bool) -> f64 {
        let components = self.dofs().iter().enumerate().filter(|(_, dof)| of(dof.kind));
        max_norm(components.map(|(i, _)| shapes[(i, k)]))
    }

    /// `M φ_k`, without rounding errors in the kinds in which the mode has no motion, which would couple them.
    fn inertia(&self, mass: &SparseMatrix, shapes: &Mat<f64>, k: usize) -> Vec<f64> {
        let rests = DofKind::ALL.map(|kind| (!self.moves(shapes, k, kind)).then_some(kind));
        let component = |i: usize| if rests.contains(&Some(self.dofs()[i].kind)) { 0.0 } else { shapes[(i, k)] };
        let shape: Vec<f64> = (0..shapes.nrows()).map(component).collect();
        multiply(mass, &shape)
    }
}

fn check_ascending(omega: &[f64]) -> Result<(), ModelError> {
    let mut below = 0.0;
    for (index, &value) in omega.iter().enumerate() {
        if !(value.is_finite() && value > below) {
            return Err(ModelError::ImposedFrequency { index, value, below });
        }
        below = value;
    }
    Ok(())
}

/// `K + Σ_k u_k c_k u_kᵀ`.
fn updated(stiffness: &SparseMatrix, inertia: &[Vec<f64>], change: &[f64]) -> Result<SparseMatrix, ModelError> {
    let n = stiffness.nrows();
    let moved: Vec<usize> = (0..n).filter(|&i| inertia.iter().any(|u| u[i] != 0.0)).collect();
    if moved.len() > MAX_IMPOSED_DOFS {
        return Err(ModelError::ImposedSize { dofs: moved.len(), limit: MAX_IMPOSED_DOFS });
    }
    let mut entries: Vec<Triplet> = triplets(stiffness).collect();
    for &j in &moved {
        for &i in &moved {
            // In the same order for (i, j) and (j, i), so that the sum is exactly symmetric.
            entries.push((i, j, inertia.iter().zip(change).map(|(u, c)| c * (u[i] * u[j])).sum()));
        }
    }
    sparse_from_triplets(n, n, &entries).map_err(ModelError::during("stiffness with imposed frequencies"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_chain::chain;
    use crate::{Contact, Dof, Drop, MasslessContactModel, Move, Side, held_modes};

    const N: usize = 12;

    fn stopped() -> StructuralModel {
        chain(N, vec![Contact::rigid(N - 1, Side::Positive, 0.1)])
    }

    /// Closed form of the chain without its end mass, `2 sin((2r − 1) π / (4N − 2))`.
    fn own(r: usize) -> f64 {
        2.0 * ((2 * r - 1) as f64 * std::f64::consts::PI / (4 * N - 2) as f64).sin()
    }

    #[test]
    fn only_the_imposed_frequencies_change_and_no_shape_does() {
        let imposed = stopped().with_frequencies(Some(&Drop), DofKind::Axial, &[0.1, 0.45, 0.7]).unwrap();
        assert_eq!(imposed.numbers, [0, 1, 2]);
        imposed.own.iter().zip(1..).for_each(|(found, r)| assert!((found / own(r) - 1.0).abs() < 1e-12));
        let massless = MasslessContactModel::new(&imposed.model, &Drop).unwrap();
        let before = MasslessContactModel::new(&stopped(), &Drop).unwrap();
        let [new, old] = [&massless, &before].map(|m| linear_modes(m.mass(), m.stiffness(), N).unwrap());
        let expected = [0.1, 0.45, 0.7].into_iter().chain((4..N).map(own));
        for (k, expected) in expected.enumerate() {
            assert!((new.omega[k] / expected - 1.0).abs() < 1e-12, "mode {k}");
            let shift = (0..N).map(|i| (new.shapes[(i, k)] - old.shapes[(i, k)]).abs()).fold(0.0, f64::max);
            assert!(shift < 1e-11, "mode {k}: {shift}");
        }
    }

    #[test]
    fn the_contact_node_keeps_its_statics() {
        let at = 5;
        let model = chain(N, vec![Contact::rigid(at, Side::Positive, 0.1)]);
        for rule in [&Drop as &dyn MassRedistribution, &Move] {
            let imposed = model.with_frequencies(Some(rule), DofKind::Axial, &[0.2]).unwrap();
            let [new, old] = [&imposed.model, &model].map(|model| MasslessContactModel::new(model, rule).unwrap());
            assert_eq!((new.k_nn(), new.k_ln(), new.mass().val()), (old.k_nn(), old.k_ln(), old.mass().val()));
            // The flexibility there is the sum of those of all modes, φ²/ω², one of which has changed, and that of the
            // node.
            let flexibility = |model: &MasslessContactModel| {
                let factor = nlmodes_linalg::SparseCholesky::factor(model.stiffness(), "stiffness").unwrap();
                let mut x = vec![0.0; N];
                x[at] = 1.0;
                factor.solve_in_place(&mut x);
                x[at]
            };
            let modes = linear_modes(old.mass(), old.stiffness(), 1).unwrap();
            let φ = modes.shapes[(at, 0)];
            let expected = φ * φ * (1.0 / 0.04 - 1.0 / modes.omega[0].powi(2));
            assert!((flexibility(&new) - flexibility(&old) - expected).abs() < 1e-10 * flexibility(&old));
        }
    }

    #[test]
    fn held_modes_follow_the_secular_equation() {
        // With the contact fixed, 1/K_NN + Σ_k φ_k(N)² λ/(ω_k² (ω_k² − λ)) + Σ_k φ_k²/ω_k² = 0: the dynamic flexibility
        // there vanishes.
        let imposed = stopped().with_frequencies(Some(&Drop), DofKind::Axial, &[0.2, 0.5]).unwrap();
        let massless = MasslessContactModel::new(&imposed.model, &Drop).unwrap();
        let before = MasslessContactModel::new(&stopped(), &Drop).unwrap();
        let modes = linear_modes(before.mass(), before.stiffness(), N).unwrap();
        let k_nn = before.k_nn()[(0, 0)];
        for held in held_modes(&massless, N).unwrap().omega {
            let mut terms = vec![1.0 / k_nn];
            for k in 0..N - 1 {
                let omega = [0.2, 0.5].get(k).copied().unwrap_or(modes.omega[k]);
                terms.push(modes.shapes[(N - 1, k)].powi(2) / (omega * omega - held * held));
            }
            let size: f64 = terms.iter().map(|t| t.abs()).sum();
            assert!(terms.iter().sum::<f64>().abs() < 1e-9 * size, "{held}");
        }
    }

    #[test]
    fn what_cannot_be_imposed_is_refused() {
        let refused = |omega: &[f64]| stopped().with_frequencies(Some(&Drop), DofKind::Axial, omega).unwrap_err();
        assert_eq!(refused(&[-1.0]), ModelError::ImposedFrequency { index: 0, value: -1.0, below: 0.0 });
        assert_eq!(refused(&[0.3, 0.2]), ModelError::ImposedFrequency { index: 1, value: 0.2, below: 0.3 });
        assert!(matches!(refused(&[f64::NAN]), ModelError::ImposedFrequency { index: 0, .. }));
        let ascending: Vec<f64> = (1..=N).map(|k| k as f64).collect();
        let kind = DofKind::Axial;
        assert_eq!(refused(&ascending), ModelError::TooManyImposed { wanted: N, found: N - 1, kind });
        assert!(matches!(refused(&[0.5]), ModelError::ImposedAboveNext { imposed: 0.5, .. }));
        let across = stopped().with_frequencies(None, DofKind::Deflection, &[0.1]).unwrap_err();
        assert_eq!(across, ModelError::TooManyImposed { wanted: 1, found: 0, kind: DofKind::Deflection });
    }

    #[test]
    fn the_unit_of_mass_does_not_matter() {
        for unit in [1e6, 1e-6] {
            let mass: Vec<_> = (0..N).map(|i| (i, i, unit)).collect();
            let heavy = crate::test_chain::springs(N, 1.0, vec![], &mass);
            let wanted = [0.1, 0.4].map(|omega: f64| omega / unit.sqrt());
            let imposed = heavy.with_frequencies(None, DofKind::Axial, &wanted).unwrap();
            let modes = linear_modes(imposed.model.mass(), imposed.model.stiffness(), 2).unwrap();
            modes.omega.iter().zip(wanted).for_each(|(found, wanted)| assert!((found / wanted - 1.0).abs() < 1e-11));
            assert_eq!(imposed.numbers, [0, 1]);
        }
    }

    /// Masses along the axis, and as many across it on springs of 1.7: modes of both alternate.
    #[test]
    fn what_moves_in_another_direction_keeps_its_stiffness_to_the_last_digit() {
        let along = chain(N, vec![]);
        let twice = |a: &SparseMatrix, factor: f64| {
            let both = |(i, j, v)| [(i, j, v), (i + N, j + N, factor * v)];
            sparse_from_triplets(2 * N, 2 * N, &triplets(a).flat_map(both).collect::<Vec<_>>()).unwrap()
        };
        let across = along.dofs().iter().map(|dof| Dof { kind: DofKind::Deflection, ..*dof });
        let dofs: Vec<Dof> = along.dofs().iter().copied().chain(across).collect();
        let model =
            StructuralModel::new(twice(along.mass(), 1.0), twice(along.stiffness(), 1.7), dofs, vec![]).unwrap();
        // Of the chain with all its masses, and √1.7 times as high across: modes 0 and 1, 2 and 3 alternate.
        let own = |r: usize| 2.0 * ((2 * r - 1) as f64 * std::f64::consts::PI / (4 * N + 2) as f64).sin();
        let imposed = model.with_frequencies(None, DofKind::Deflection, &[0.2, 0.5]).unwrap();
        assert_eq!(imposed.numbers, [1, 3]);
        let expected = [1, 2].map(|r| 1.7_f64.sqrt() * own(r));
        imposed.own.iter().zip(expected).for_each(|(found, own)| assert!((found / own - 1.0).abs() < 1e-12));
        let kept = |i: usize, j: usize| i < N || j < N;
        let of = |model: &StructuralModel| -> Vec<Triplet> {
            triplets(model.stiffness()).filter(|(i, j, _)| kept(*i, *j)).collect()
        };
        assert_eq!(of(&imposed.model), of(&model));
    }

    #[test]
    fn messages_have_numbers_from_one_and_hertz() {
        let error = stopped().with_frequencies(None, DofKind::Axial, &[std::f64::consts::TAU * 0.01, 0.0]).unwrap_err();
        let text = "imposed frequency 2 is 0 Hz; expected more than 0.01 Hz, frequencies ascend";
        assert_eq!(error.to_string(), text);
    }

    #[test]
    fn a_rigid_body_motion_gets_no_frequency() {
        let mass: Vec<_> = (0..5).map(|i| (i, i, 1.0)).collect();
        let free = crate::test_chain::springs(5, 0.0, vec![], &mass);
        let error = free.with_frequencies(None, DofKind::Axial, &[0.1]).unwrap_err();
        assert_eq!(error, ModelError::ImposedOnRigidBody { mode: 1 });
    }

    #[test]
    fn large_structures_are_refused() {
        // The end has no mass and does not participate.
        let n = MAX_IMPOSED_DOFS + 1;
        let masses: Vec<_> = (0..n).map(|i| (i, i, 1.0)).collect();
        let structure = crate::test_chain::springs(n + 1, 1.0, vec![], &masses);
        let error = structure.with_frequencies(None, DofKind::Axial, &[1e-4]).unwrap_err();
        assert_eq!(error, ModelError::ImposedSize { dofs: n, limit: MAX_IMPOSED_DOFS });
    }
}

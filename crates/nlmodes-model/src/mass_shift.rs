use crate::{MasslessContactModel, ModelError, StructuralModel, linear_modes};

/// Effect of massless contacts on the frequency of a linear mode.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct MassShift {
    /// Number of the mode, from 1.
    pub mode: usize,
    /// Its angular frequency with all of the mass, contacts open, rad/s.
    pub with_mass: f64,
    /// That of the mode of the same number with massless contacts, from which a nonlinear mode starts, rad/s.
    pub without_mass: f64,
}

impl MassShift {
    /// Compares the linear modes of this number (from 1); `None` if either structure has no such mode, or it is a
    /// rigid-body mode.
    ///
    /// # Errors
    /// [`ModelError::Linalg`] if an eigenproblem cannot be solved.
    pub fn of(
        model: &StructuralModel,
        massless: &MasslessContactModel,
        mode: usize,
    ) -> Result<Option<Self>, ModelError> {
        let omega = |mass, stiffness| Ok::<_, ModelError>(linear_modes(mass, stiffness, mode)?.omega);
        let with_mass = omega(model.mass(), model.stiffness())?;
        Ok(Self::between(&with_mass, &omega(massless.mass(), massless.stiffness())?, mode))
    }

    /// Compares known angular frequencies (rad/s, ascending) of the structure with and without that mass.
    pub fn between(with_mass: &[f64], without_mass: &[f64], mode: usize) -> Option<Self> {
        let place = mode.checked_sub(1)?;
        let (with_mass, without_mass) = (*with_mass.get(place)?, *without_mass.get(place)?);
        (with_mass > 0.0 && without_mass > 0.0).then_some(Self { mode, with_mass, without_mass })
    }

    /// Relative change of the frequency.
    pub fn relative(&self) -> f64 {
        self.without_mass / self.with_mass - 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_chain::springs;
    use crate::{Contact, Drop, Side};
    use std::f64::consts::PI;

    #[test]
    fn the_shift_of_a_chain_that_loses_its_last_mass_is_that_of_the_closed_form_in_any_unit() {
        let n = 12;
        for (mass, stiffness) in [(1.0, 1.0), (1e-3, 1.0), (1.0, 1e9)] {
            let masses: Vec<_> = (0..n).map(|i| (i, i, mass)).collect();
            let unit = springs(n, 1.0, vec![Contact::rigid(n - 1, Side::Positive, 0.1)], &masses);
            let k: Vec<_> = nlmodes_linalg::triplets(unit.stiffness()).map(|(i, j, k)| (i, j, stiffness * k)).collect();
            let k = nlmodes_linalg::sparse_from_triplets(n, n, &k).unwrap();
            let model =
                StructuralModel::new(unit.mass().clone(), k, unit.dofs().to_vec(), unit.contacts().to_vec()).unwrap();
            let massless = MasslessContactModel::new(&model, &Drop).unwrap();
            for mode in 1..n {
                let shift = MassShift::of(&model, &massless, mode).unwrap().unwrap();
                let of_chain = |n: usize| ((2 * mode - 1) as f64 * PI / (4 * n + 2) as f64).sin();
                // One mass less, and its spring does no work.
                let expected = of_chain(n - 1) / of_chain(n) - 1.0;
                assert!((shift.relative() - expected).abs() < 1e-11, "{mode}: {} {expected}", shift.relative());
            }
            assert_eq!(MassShift::of(&model, &massless, n).unwrap(), None);
            assert_eq!(MassShift::of(&model, &massless, 0).unwrap(), None);
        }
    }

    #[test]
    fn known_frequencies_are_compared_however_low_they_are_and_rigid_motions_are_not() {
        let relative =
            |with: &[f64], without: &[f64], mode| MassShift::between(with, without, mode).map(|shift| shift.relative());
        assert_eq!(relative(&[1e-3, 2e-3], &[2e-3, 5e-3], 2), Some(1.5));
        for (with, without) in [([0.0, 2.0], [3.0, 4.0]), ([1.0, 2.0], [0.0, 4.0])] {
            assert_eq!((relative(&with, &without, 1), relative(&with, &without, 3)), (None, None));
        }
    }

    #[test]
    fn a_contact_without_mass_shifts_nothing() {
        let masses: Vec<_> = (0..5).map(|i| (i, i, if i == 4 { 0.0 } else { 1.0 })).collect();
        let model = springs(5, 1.0, vec![Contact::rigid(4, Side::Positive, 0.1)], &masses);
        let massless = MasslessContactModel::new(&model, &Drop).unwrap();
        let shift = MassShift::of(&model, &massless, 1).unwrap().unwrap();
        assert!(shift.relative().abs() < 1e-14);
    }
}

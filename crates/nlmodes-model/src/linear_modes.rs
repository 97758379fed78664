use std::sync::{Mutex, PoisonError};

use nlmodes_linalg::{Mat, SparseMatrix, lowest_modes};

use crate::{MasslessContactModel, ModelError};

/// Linear modes `K φ_r = ω_r² M φ_r`, ascending, mass-normalised.
#[derive(Debug, Clone)]
pub struct LinearModes {
    /// Angular eigenfrequencies `ω_0,r`, rad/s; zero for rigid-body modes, up to rounding.
    pub omega: Vec<f64>,
    /// Shapes, one per column, in 1/√kg for displacements: n × modes. Massless degrees of freedom follow statically.
    /// The largest component of each is positive.
    pub shapes: Mat<f64>,
}

/// Lowest `count` modes of the structure with mass `M` and stiffness `K` and all contacts open.
///
/// Massless contact degrees of freedom are allowed; they follow the others statically, `q_N = −K_NN⁻¹ K_NL q_L`, which
/// is eq. (13) without contact forces. Fewer modes are returned if the structure has fewer degrees of freedom with
/// mass.
///
/// # Errors
/// [`ModelError::Linalg`] if the eigenproblem cannot be solved.
pub fn linear_modes(mass: &SparseMatrix, stiffness: &SparseMatrix, count: usize) -> Result<LinearModes, ModelError> {
    let modes = lowest_modes(stiffness, mass, count).map_err(ModelError::during("linear modes"))?;
    Ok(LinearModes { omega: modes.eigenvalues.iter().map(|λ| λ.sqrt()).collect(), shapes: modes.vectors })
}

/// Lowest `count` modes of a model with all contacts open, those of [`linear_modes`] for its mass and stiffness; shapes
/// are n × modes.
///
/// The model and its clones cache the modes: the eigenproblem is solved again only if more modes are requested.
///
/// # Errors
/// As [`linear_modes`].
pub fn open_modes(model: &MasslessContactModel, count: usize) -> Result<LinearModes, ModelError> {
    model.known.open.lowest(count, |count| linear_modes(model.mass(), model.stiffness(), count))
}

/// Lowest `count` fixed-interface modes, with the contact degrees of freedom fixed, `K_LL φ_k = λ_k M̄_LL φ_k`; shapes
/// are n_L × modes.
///
/// They diagonalise the dynamic stiffness `H_LL,n` of eq. (9): `H_LL,n⁻¹ = Σ_k φ_k φ_kᵀ / (λ_k − n²ω²)`. As `q_N = 0`,
/// `K_NN` does not enter. Cached like [`open_modes`].
///
/// # Errors
/// As [`linear_modes`].
pub fn held_modes(model: &MasslessContactModel, count: usize) -> Result<LinearModes, ModelError> {
    model.known.held.lowest(count, |count| linear_modes(model.m_ll(), model.k_ll(), count))
}

/// The modes of a model that were computed so far.
#[derive(Debug, Default)]
pub(crate) struct KnownModes {
    open: Known,
    held: Known,
}

/// The lowest modes of one eigenproblem, at most the requested number; if there are fewer, these are all.
#[derive(Debug, Default)]
struct Known(Mutex<Option<(usize, LinearModes)>>);

impl Known {
    fn lowest(
        &self,
        count: usize,
        solve: impl FnOnce(usize) -> Result<LinearModes, ModelError>,
    ) -> Result<LinearModes, ModelError> {
        // A thread that panicked left either the previous modes or none.
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match known.as_ref() {
            Some((asked, modes)) if count <= *asked => Ok(modes.lowest(count)),
            _ => {
                let modes = solve(count)?;
                *known = Some((count, modes.clone()));
                Ok(modes)
            }
        }
    }
}

impl LinearModes {
    /// The lowest `count` of them, or all if there are fewer.
    pub fn lowest(&self, count: usize) -> Self {
        let count = count.min(self.omega.len());
        Self { omega: self.omega[..count].to_vec(), shapes: self.shapes.subcols(0, count).to_owned() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_chain::chain;
    use crate::{Contact, Drop, Side};
    use std::f64::consts::PI;

    #[test]
    fn dropping_the_end_mass_shortens_the_chain_by_one() {
        let n = 12;
        let model = chain(n, vec![Contact::rigid(n - 1, Side::Positive, 0.0)]);
        let massless = MasslessContactModel::new(&model, &Drop).unwrap();
        let open = linear_modes(massless.mass(), massless.stiffness(), 20).unwrap();
        assert_eq!(open.omega.len(), n - 1);
        for (r, omega) in open.omega.iter().enumerate() {
            let expected = 2.0 * ((2 * r + 1) as f64 * PI / (4 * n - 2) as f64).sin();
            assert!((omega / expected - 1.0).abs() < 1e-12);
            // The massless end follows its neighbour.
            assert!((open.shapes[(n - 1, r)] - open.shapes[(n - 2, r)]).abs() < 1e-13);
        }
    }

    #[test]
    fn clones_keep_modes_and_more_of_them_are_solved_for() {
        let model = chain(12, vec![Contact::rigid(11, Side::Positive, 0.0)]);
        let massless = MasslessContactModel::new(&model, &Drop).unwrap();
        for (kept, count) in [(massless.clone(), 3), (massless.clone(), 2), (massless.clone(), 7), (massless, 20)] {
            for (modes, m, k) in [
                (open_modes(&kept, count), kept.mass(), kept.stiffness()),
                (held_modes(&kept, count), kept.m_ll(), kept.k_ll()),
            ] {
                let (modes, expected) = (modes.unwrap(), linear_modes(m, k, count).unwrap());
                assert_eq!(modes.omega.len(), count.min(11));
                assert_eq!(modes.shapes.ncols(), count.min(11));
                assert!(modes.omega.iter().zip(&expected.omega).all(|(a, b)| (a / b - 1.0).abs() < 1e-12));
                assert!((modes.shapes - expected.shapes).norm_max() < 1e-10);
            }
        }
    }

    #[test]
    fn held_modes_are_those_of_the_chain_between_two_walls() {
        let n = 12;
        let model = chain(n, vec![Contact::rigid(n - 1, Side::Positive, 0.0)]);
        let held = held_modes(&MasslessContactModel::new(&model, &Drop).unwrap(), n).unwrap();
        assert_eq!((held.omega.len(), held.shapes.nrows()), (n - 1, n - 1));
        for (r, omega) in held.omega.iter().enumerate() {
            let expected = 2.0 * ((r + 1) as f64 * PI / (2 * n) as f64).sin();
            assert!((omega / expected - 1.0).abs() < 1e-12);
        }
    }
}

use nlmodes_linalg::{Mat, SparseMatrix, lowest_modes};

use crate::{MasslessContactModel, ModelError};

/// Linear modes `K φ_r = ω_r² M φ_r`, ascending, mass-normalised.
#[derive(Debug, Clone)]
pub struct LinearModes {
    /// Angular eigenfrequencies `ω_0,r`, rad/s; zero for rigid-body modes, up to rounding.
    pub omega: Vec<f64>,
    /// Shapes, one a column, in 1/√kg for displacements: n × modes. Massless degrees of freedom follow statically. The
    /// largest component of each is positive.
    pub shapes: Mat<f64>,
}

/// Lowest `count` modes of the structure with mass `M` and stiffness `K` and all contacts open.
///
/// Massless contact degrees of freedom are allowed; they follow the others statically, `q_N = −K_NN⁻¹ K_NL q_L`, which is
/// eq. (13) without contact forces. Fewer modes come back if the structure has fewer massive degrees of freedom.
///
/// # Errors
/// [`ModelError::Linalg`] if the eigenproblem cannot be solved.
pub fn linear_modes(mass: &SparseMatrix, stiffness: &SparseMatrix, count: usize) -> Result<LinearModes, ModelError> {
    let modes = lowest_modes(stiffness, mass, count).map_err(ModelError::during("linear modes"))?;
    Ok(LinearModes { omega: modes.eigenvalues.iter().map(|λ| λ.sqrt()).collect(), shapes: modes.vectors })
}

/// Lowest `count` modes with the contact degrees of freedom held, `K_LL φ_k = λ_k M̄_LL φ_k`; shapes are n_L × modes.
///
/// They diagonalise the dynamic stiffness `H_LL,n` of eq. (9): `H_LL,n⁻¹ = Σ_k φ_k φ_kᵀ / (λ_k − n²ω²)`. As `q_N = 0`, `K_NN`
/// does not enter.
///
/// # Errors
/// As [`linear_modes`].
pub fn held_modes(model: &MasslessContactModel, count: usize) -> Result<LinearModes, ModelError> {
    linear_modes(model.m_ll(), model.k_ll(), count)
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

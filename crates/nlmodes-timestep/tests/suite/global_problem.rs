use std::f64::consts::TAU;

use nlmodes_linalg::{DenseLu, Mat};
use nlmodes_model::MasslessContactModel;

/// The contact forces of all samples of a period as one linear complementarity problem (end of Section 2.2).
///
/// ```text
/// K_NN q_N(t_j) − Σ_l K_NN 𝒯_jl q_N(t_l) = W λ(t_j)                      eqs. (8), (13), (14)
/// 𝒯_jl = (1/N_t) Re Σ_{n=0}^{N_h} c_n T_n e^{in(τ_j − τ_l)}
/// 0 ≤ λ ⊥ 𝒜 λ + g₀ ≥ 0                                                                                     eq. (11)
/// ```
///
/// with `T_n = K_NN⁻¹ K_NL (K_LL − n²ω² M_LL)⁻¹ K_LN`, `c_0 = 1` and `c_n = 2`. Its solutions are those of the sampled
/// method at the frequency ω. It has `N_t` times the number of contacts as unknowns and is not positive definite, so it
/// is used to check solutions of small systems.
pub struct GlobalContactProblem {
    /// `𝒜`, m/N; sample after sample, c × N_t rows and columns.
    matrix: Mat<f64>,
    /// Gaps at rest, m, repeated for each sample.
    gaps: Vec<f64>,
}

impl GlobalContactProblem {
    /// Assembles it from dense factorisations of the dynamic stiffness of each harmonic.
    pub fn new(model: &MasslessContactModel, omega: f64, harmonics: usize, samples: usize) -> Self {
        assert!(samples > 2 * harmonics, "two samples a harmonic and one more");
        let k_nn = DenseLu::factor(model.k_nn()).unwrap();
        let transfers: Vec<Mat<f64>> = (0..=harmonics).map(|n| transfer(model, &k_nn, n as f64 * omega)).collect();
        let n = model.k_nn().nrows();
        let blocks: Vec<Mat<f64>> = (0..samples).map(|shift| block(&transfers, shift, samples)).collect();
        let system = Mat::from_fn(n * samples, n * samples, |row, column| {
            let (j, l) = (row / n, column / n);
            let own = if row == column { 1.0 } else { 0.0 };
            own - blocks[(j + samples - l) % samples][(row % n, column % n)]
        });
        let lu = DenseLu::factor(&system).unwrap();
        let c = model.contacts().len();
        let compliance = k_nn.solve_columns(model.w());
        let load = Mat::from_fn(n * samples, c * samples, |row, column| {
            if row / n == column / c { compliance[(row % n, column % c)] } else { 0.0 }
        });
        let response = lu.solve_columns(&load);
        let (w, stops) = (model.w(), model.stop_compliance());
        let matrix = Mat::from_fn(c * samples, c * samples, |row, column| {
            let (j, i) = (row / c, row % c);
            let own = if row == column { stops[i] } else { 0.0 };
            own + (0..n).map(|d| w[(d, i)] * response[(j * n + d, column)]).sum::<f64>()
        });
        let gaps = (0..samples).flat_map(|_| model.contacts().iter().map(|c| c.gap)).collect();
        Self { matrix, gaps }
    }

    /// Gaps `𝒜 λ + g₀` of the forces `lambda` (c × N_t, sample after sample), m.
    fn gaps_of(&self, lambda: &[f64]) -> Vec<f64> {
        assert_eq!(lambda.len(), self.gaps.len());
        let row = |i: usize| lambda.iter().enumerate().map(|(j, λ)| self.matrix[(i, j)] * λ).sum::<f64>();
        (0..self.gaps.len()).map(|i| self.gaps[i] + row(i)).collect()
    }

    /// Largest `|min(λ/λ_max, g/g_max)|` over all samples and contacts: zero for a solution.
    pub fn violation(&self, lambda: &[f64]) -> f64 {
        let gaps = self.gaps_of(lambda);
        let largest = |x: &[f64]| x.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
        let (force, gap) = (largest(lambda), largest(&gaps));
        lambda.iter().zip(&gaps).fold(0.0, |m: f64, (λ, g)| m.max((λ / force).min(g / gap).abs()))
    }
}

/// `T_n = K_NN⁻¹ K_NL (K_LL − ν² M_LL)⁻¹ K_LN`.
fn transfer(model: &MasslessContactModel, k_nn: &DenseLu, nu: f64) -> Mat<f64> {
    let (k, m) = (model.k_ll().to_dense(), model.m_ll().to_dense());
    let stiffness = Mat::from_fn(k.nrows(), k.ncols(), |i, j| k[(i, j)] - nu * nu * m[(i, j)]);
    let lu = DenseLu::factor(&stiffness).unwrap();
    k_nn.solve_columns(&(model.k_ln().transpose() * lu.solve_columns(model.k_ln())))
}

/// `𝒯` between two samples that are `shift` apart.
fn block(transfers: &[Mat<f64>], shift: usize, samples: usize) -> Mat<f64> {
    let size = transfers[0].nrows();
    let weight = |n: usize| {
        let phase = TAU * ((n * shift) % samples) as f64 / samples as f64;
        if n == 0 { 1.0 } else { 2.0 * phase.cos() }
    };
    Mat::from_fn(size, size, |i, j| {
        transfers.iter().enumerate().map(|(n, t)| weight(n) * t[(i, j)]).sum::<f64>() / samples as f64
    })
}

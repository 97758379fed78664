use std::ops::Range;

use nlmodes_linalg::{Mat, add_product};

use nlmodes_reduction::{HeldMode, HeldModes};

use crate::condensed::ResidualMass;

/// Held modes laid out for the sums over all of them that each harmonic needs.
///
/// ```text
/// S_1 = Σ_k G_k/(λ_k (λ_k − ν²)) ,   S_2 = Σ_k G_k/(λ_k − ν²)² ,   S_3 = Σ_k G_k/(λ_k − ν²)³ ,   G_k = g_kᵀ g_k
/// ```
///
/// `K_NN⁻¹ ν² S_1` and `K_NN⁻¹ S_2` are what the modes give to `T` and to its slope; with `S_2` and `S_3` the kinetic
/// energy is a quadratic form of `q_N` and needs no second pass over the modes.
#[derive(Debug, Clone)]
pub(crate) struct HeldSums {
    pub lambda: Vec<f64>,
    pub inverse_lambda: Vec<f64>,
    /// `g_k` of all modes for one contact coordinate after the other.
    couplings: Vec<f64>,
    /// `(i, j)`, i ≥ j, and `g_i g_j` of all modes.
    pairs: Vec<(usize, usize, Vec<f64>)>,
    /// `K_NN⁻¹`, row-major.
    pub k_nn_inverse: Vec<f64>,
    /// `T_0`, the share `K_NN⁻¹ R` of the modes not computed, and the next one, row-major.
    pub t0: Vec<f64>,
    pub residual_transfer: Vec<f64>,
    pub next_transfer: Vec<f64>,
    /// Of each mode, all that have its frequency.
    pub same: Vec<Range<usize>>,
}

/// The sums at one squared frequency, n_N × n_N, row-major and symmetric.
#[derive(Debug, Clone)]
pub(crate) struct Sums {
    pub s1: Vec<f64>,
    pub s2: Vec<f64>,
    pub s3: Vec<f64>,
    /// `1/(λ (λ − ν²))`, `1/(λ − ν²)²` and `1/(λ − ν²)³` of all modes.
    weights: [Vec<f64>; 3],
}

impl Sums {
    pub fn new(n: usize) -> Self {
        let zero = vec![0.0; n * n];
        Self { s1: zero.clone(), s2: zero.clone(), s3: zero, weights: Default::default() }
    }

    pub fn clear(&mut self) {
        [&mut self.s1, &mut self.s2, &mut self.s3].into_iter().for_each(|s| s.fill(0.0));
    }
}

impl HeldSums {
    pub fn new(modes: &[HeldMode], k_nn_inverse: &Mat<f64>, t0: &Mat<f64>, residual: &ResidualMass) -> Self {
        let n = k_nn_inverse.nrows();
        let products = |i: usize, j: usize| modes.iter().map(|m| m.g[i] * m.g[j]).collect();
        Self {
            lambda: modes.iter().map(|m| m.lambda).collect(),
            inverse_lambda: modes.iter().map(|m| 1.0 / m.lambda).collect(),
            couplings: (0..n).flat_map(|d| modes.iter().map(move |m| m.g[d])).collect(),
            pairs: (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|(i, j)| (i, j, products(i, j))).collect(),
            k_nn_inverse: row_major(k_nn_inverse),
            t0: row_major(t0),
            residual_transfer: row_major(&residual.transfer),
            next_transfer: row_major(&residual.next_transfer),
            same: (0..modes.len()).map(|p| repeated(modes, p)).collect(),
        }
    }

    /// The sums at `nu2` over all modes but those of `without`.
    pub fn at(&self, nu2: f64, without: &Range<usize>, out: &mut Sums) {
        if let [(_, _, squares)] = self.pairs.as_slice() {
            let (low, high) = (..without.start, without.end..);
            let below = weighted(&self.lambda[low], &self.inverse_lambda[low], &squares[low], nu2);
            let above = weighted(&self.lambda[high.clone()], &self.inverse_lambda[high.clone()], &squares[high], nu2);
            (out.s1[0], out.s2[0], out.s3[0]) = (below[0] + above[0], below[1] + above[1], below[2] + above[2]);
            return;
        }
        self.set_weights(nu2, without, &mut out.weights);
        let n = self.size();
        for (i, j, products) in &self.pairs {
            let [a, b, c] = three_products(products, &out.weights);
            for at in [i * n + j, j * n + i] {
                (out.s1[at], out.s2[at], out.s3[at]) = (a, b, c);
            }
        }
    }

    fn set_weights(&self, nu2: f64, without: &Range<usize>, weights: &mut [Vec<f64>; 3]) {
        let n_modes = self.lambda.len();
        weights.iter_mut().for_each(|w| w.resize(n_modes, 0.0));
        let [w1, w2, w3] = weights;
        for k in 0..n_modes {
            let inverse = 1.0 / (self.lambda[k] - nu2);
            w1[k] = inverse * self.inverse_lambda[k];
            w2[k] = inverse * inverse;
            w3[k] = w2[k] * inverse;
        }
        [w1, w2, w3].into_iter().for_each(|w| w[without.clone()].fill(0.0));
    }

    /// `g_k q` of all modes.
    pub fn couple(&self, q: &[f64], to: &mut [f64]) {
        to.fill(0.0);
        for (column, q) in self.couplings.chunks_exact(to.len().max(1)).zip(q) {
            to.iter_mut().zip(column).for_each(|(to, g)| *to += g * q);
        }
    }

    /// `to += factor K_NN⁻¹ S`, row-major.
    pub fn add_static_response(&self, factor: f64, s: &[f64], to: &mut [f64]) {
        let n = self.size();
        add_product(factor, &self.k_nn_inverse, s, to, [n, n, n], n);
    }

    /// Number of contact coordinates.
    pub fn size(&self) -> usize {
        self.k_nn_inverse.len().isqrt()
    }
}

/// Partial sums that the compiler puts side by side.
const LANES: usize = 4;

/// `Σ g/(λ (λ − ν²))`, `Σ g/(λ − ν²)²`, `Σ g/(λ − ν²)³`.
fn weighted(lambda: &[f64], inverse_lambda: &[f64], g: &[f64], nu2: f64) -> [f64; 3] {
    let (mut s1, mut s2, mut s3) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
    let chunks = lambda.as_chunks::<LANES>().0.iter().zip(inverse_lambda.as_chunks::<LANES>().0);
    for ((lambda, inverse_lambda), g) in chunks.zip(g.as_chunks::<LANES>().0) {
        for l in 0..LANES {
            let inverse = 1.0 / (lambda[l] - nu2);
            let share = g[l] * inverse;
            let square = share * inverse;
            s1[l] += share * inverse_lambda[l];
            s2[l] += square;
            s3[l] += square * inverse;
        }
    }
    for k in lambda.len() / LANES * LANES..lambda.len() {
        let inverse = 1.0 / (lambda[k] - nu2);
        let square = g[k] * inverse * inverse;
        s1[0] += g[k] * inverse * inverse_lambda[k];
        s2[0] += square;
        s3[0] += square * inverse;
    }
    [s1, s2, s3].map(|s| (s[0] + s[1]) + (s[2] + s[3]))
}

/// The products of `p` with each of the weights.
fn three_products(p: &[f64], weights: &[Vec<f64>; 3]) -> [f64; 3] {
    let mut sums = [[0.0; LANES]; 3];
    let [a, b, c] = weights.each_ref().map(|w| w.as_chunks::<LANES>().0);
    for (((p, a), b), c) in p.as_chunks::<LANES>().0.iter().zip(a).zip(b).zip(c) {
        for l in 0..LANES {
            sums[0][l] += p[l] * a[l];
            sums[1][l] += p[l] * b[l];
            sums[2][l] += p[l] * c[l];
        }
    }
    for k in p.len() / LANES * LANES..p.len() {
        sums.iter_mut().zip(weights).for_each(|(s, w)| s[0] += p[k] * w[k]);
    }
    sums.map(|s| (s[0] + s[1]) + (s[2] + s[3]))
}

/// All modes with the frequency of mode `p`.
fn repeated(modes: &[HeldMode], p: usize) -> Range<usize> {
    let same = |k: &usize| (modes[*k].lambda / modes[p].lambda - 1.0).abs() <= 4.0 * HeldModes::REPEATED;
    let before = (0..p).rev().take_while(same).count();
    p - before..p + 1 + (p + 1..modes.len()).take_while(same).count()
}

fn row_major(m: &Mat<f64>) -> Vec<f64> {
    (0..m.nrows()).flat_map(|i| (0..m.ncols()).map(move |j| m[(i, j)])).collect()
}

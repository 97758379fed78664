use std::ops::Range;

use nlmodes_linalg::Mat;

use crate::CondensedStructure;
use crate::condensed::{HeldMode, REPEATED};

/// The linear structure at one harmonic: `A b_n = B q_N,n`, a form of eq. (8) without poles.
///
/// `b_n = T(ν²) q_N,n` has a pole at each eigenfrequency `λ_p` of the held structure, where `q_N,n` vanishes while `b_n` stays
/// finite. With the more resonant mode `p` of the two around `ν²` apart, `T = F + h_p g_p/δ`, `δ = λ_p − ν²`, multiplication by the regular matrix
///
/// ```text
/// A = I − (1 − α) h_p g_p / s_p ,   B = A F + β h_p g_p / s_p ,   α = δ/√(δ² + s_p²) ,   β = s_p/√(δ² + s_p²)
/// ```
///
/// gives coefficients that stay near one and pass smoothly through the pole. Several modes with the same frequency have
/// `g_i h_j = 0` and add up. The sign of `det A`, carried by α and β of one mode, follows the number of poles below `ν²`, so that it does
/// not jump where another mode becomes the more resonant one.
///
/// All matrices are row-major, n_N × n_N; derivatives are with respect to `ν²`.
#[derive(Debug, Clone, Default)]
pub(crate) struct Plane {
    pub a: Vec<f64>,
    pub b: Vec<f64>,
    pub da: Vec<f64>,
    pub db: Vec<f64>,
    /// `F` and its derivative.
    pub f: Vec<f64>,
    pub df: Vec<f64>,
    /// The modes that are kept apart: one, or all with the same frequency; empty for the mean.
    pub poles: Range<usize>,
    /// Whether the modes that were not computed answer with the term in `ν⁴` too.
    pub with_next_term: bool,
}

impl Plane {
    pub fn new(n: usize) -> Self {
        let zero = vec![0.0; n * n];
        Self {
            a: zero.clone(),
            b: zero.clone(),
            da: zero.clone(),
            db: zero.clone(),
            f: zero.clone(),
            df: zero,
            poles: 0..0,
            with_next_term: false,
        }
    }

    /// The mean: `A = I`, `B = T_0`.
    pub fn set_static(&mut self, structure: &CondensedStructure) {
        let n = structure.n_contact_dofs();
        identity(&mut self.a, n);
        write(&mut self.f, &structure.t0);
        self.b.copy_from_slice(&self.f);
        for m in [&mut self.da, &mut self.db, &mut self.df] {
            m.fill(0.0);
        }
        self.poles = 0..0;
    }

    /// The harmonic with squared angular frequency `nu2`.
    pub fn set(&mut self, structure: &CondensedStructure, nu2: f64) {
        let n = structure.n_contact_dofs();
        let modes = &structure.modes;
        let passed = modes.partition_point(|m| m.lambda < nu2);
        let resonance = |k: &usize| modes[*k].s / (modes[*k].lambda - nu2).abs();
        let neighbours = passed.saturating_sub(1)..(passed + 1).min(modes.len());
        let nearest = neighbours.max_by(|i, j| resonance(i).total_cmp(&resonance(j)));
        let Some(nearest) = nearest else { return self.set_static(structure) };
        self.poles = repeated(modes, nearest);
        self.regular_part(structure, nu2);
        identity(&mut self.a, n);
        [&mut self.da, &mut self.b, &mut self.db].into_iter().for_each(|m| m.fill(0.0));
        let below = self.poles.clone().filter(|&p| modes[p].lambda < nu2).count();
        // Each pole passed turns the sign of det(I − T …); with those of δ it keeps its own.
        let mut sign = if (passed + below) % 2 == 0 { 1.0 } else { -1.0 };
        for mode in &modes[self.poles.clone()] {
            let delta = mode.lambda - nu2;
            let rho = delta.hypot(mode.s);
            let (alpha, beta) = (sign * delta / rho, sign * mode.s / rho);
            // d/dν² = −d/dδ
            let (d_alpha, d_beta) = (-beta * mode.s / (rho * rho), beta * delta / (rho * rho));
            for i in 0..n {
                for j in 0..n {
                    let e = mode.h[i] * mode.g[j] / mode.s;
                    self.a[i * n + j] -= (1.0 - alpha) * e;
                    self.da[i * n + j] += d_alpha * e;
                    self.b[i * n + j] += beta * e;
                    self.db[i * n + j] += d_beta * e;
                }
            }
            sign = 1.0;
        }
        for i in 0..n {
            for k in 0..n {
                let (a, da) = (self.a[i * n + k], self.da[i * n + k]);
                for j in 0..n {
                    self.b[i * n + j] += a * self.f[k * n + j];
                    self.db[i * n + j] += da * self.f[k * n + j] + a * self.df[k * n + j];
                }
            }
        }
    }

    /// `F = T − Σ_p h_p g_p/(λ_p − ν²)` and its derivative; the terms of the poles leave only their static share.
    fn regular_part(&mut self, structure: &CondensedStructure, nu2: f64) {
        let n = structure.n_contact_dofs();
        write(&mut self.f, &structure.t0);
        write(&mut self.df, &structure.residual.transfer);
        self.f.iter_mut().zip(&self.df).for_each(|(f, slope)| *f += nu2 * slope);
        if self.with_next_term {
            for i in 0..n {
                for j in 0..n {
                    let next = structure.residual.next_transfer[(i, j)];
                    self.f[i * n + j] += nu2 * nu2 * next;
                    self.df[i * n + j] += 2.0 * nu2 * next;
                }
            }
        }
        for (k, mode) in structure.modes.iter().enumerate() {
            let (value, slope) = if self.poles.contains(&k) {
                (-1.0 / mode.lambda, 0.0)
            } else {
                let inverse = 1.0 / (mode.lambda - nu2);
                (nu2 / mode.lambda * inverse, inverse * inverse)
            };
            for i in 0..n {
                for j in 0..n {
                    let hg = mode.h[i] * mode.g[j];
                    self.f[i * n + j] += value * hg;
                    self.df[i * n + j] += slope * hg;
                }
            }
        }
    }
}

/// All modes with the frequency of mode `p`.
fn repeated(modes: &[HeldMode], p: usize) -> Range<usize> {
    let same = |k: &usize| (modes[*k].lambda / modes[p].lambda - 1.0).abs() <= 4.0 * REPEATED;
    let before = (0..p).rev().take_while(same).count();
    p - before..p + 1 + (p + 1..modes.len()).take_while(same).count()
}

fn identity(m: &mut [f64], n: usize) {
    m.fill(0.0);
    (0..n).for_each(|i| m[i * n + i] = 1.0);
}

fn write(to: &mut [f64], from: &Mat<f64>) {
    let n = from.ncols();
    for i in 0..from.nrows() {
        for j in 0..n {
            to[i * n + j] = from[(i, j)];
        }
    }
}

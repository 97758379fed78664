use nlmodes_linalg::Mat;

use crate::CondensedStructure;

/// The linear structure at one harmonic: `A b_n = B q_N,n`, a form of eq. (8) without poles.
///
/// `b_n = T(ν²) q_N,n` has a pole at each eigenfrequency `λ_p` of the held structure, where `q_N,n` vanishes while `b_n` stays
/// finite. With the most resonant mode `p` apart, `T = F + h_p g_p/δ`, `δ = λ_p − ν²`, multiplication by the regular matrix
///
/// ```text
/// A = I − (1 − α) h_p g_p / s_p ,   B = A F + β h_p g_p / s_p ,   α = δ/√(δ² + s_p²) ,   β = s_p/√(δ² + s_p²)
/// ```
///
/// gives coefficients that stay near one and pass smoothly through the pole. The sign of the row follows the number of poles
/// below `p`, so that `det A` is continuous from pole to pole.
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
    /// The most resonant mode, where there is any.
    pub pole: Option<usize>,
}

impl Plane {
    pub fn new(n: usize) -> Self {
        let zero = vec![0.0; n * n];
        Self { a: zero.clone(), b: zero.clone(), da: zero.clone(), db: zero.clone(), f: zero.clone(), df: zero, pole: None }
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
        self.pole = None;
    }

    /// The harmonic with squared angular frequency `nu2`.
    pub fn set(&mut self, structure: &CondensedStructure, nu2: f64) {
        let n = structure.n_contact_dofs();
        let modes = &structure.modes;
        let resonance = |k: &usize| modes[*k].s / (modes[*k].lambda - nu2).abs();
        self.pole = (0..modes.len()).max_by(|i, j| resonance(i).total_cmp(&resonance(j)));
        let Some(p) = self.pole else { return self.set_static(structure) };
        self.regular_part(structure, nu2, p);
        let (mode, delta) = (&modes[p], modes[p].lambda - nu2);
        let rho = delta.hypot(mode.s);
        let (alpha, beta) = (delta / rho, mode.s / rho);
        // d/dν² = −d/dδ
        let (d_alpha, d_beta) = (-mode.s * mode.s / rho.powi(3), mode.s * delta / rho.powi(3));
        let sign = if p % 2 == 0 { 1.0 } else { -1.0 };
        for i in 0..n {
            for j in 0..n {
                let e = mode.h[i] * mode.g[j] / mode.s;
                let unit = if i == j { 1.0 } else { 0.0 };
                self.a[i * n + j] = sign * (unit - (1.0 - alpha) * e);
                self.da[i * n + j] = sign * d_alpha * e;
                self.b[i * n + j] = sign * beta * e;
                self.db[i * n + j] = sign * d_beta * e;
            }
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

    /// `F = T − h_p g_p/(λ_p − ν²)` and its derivative; the term of mode p leaves only its static share.
    fn regular_part(&mut self, structure: &CondensedStructure, nu2: f64, p: usize) {
        let n = structure.n_contact_dofs();
        write(&mut self.f, &structure.t0);
        self.df.fill(0.0);
        for (k, mode) in structure.modes.iter().enumerate() {
            let (value, slope) = if k == p {
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

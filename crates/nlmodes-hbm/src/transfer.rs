use std::ops::Range;

use crate::CondensedStructure;
use crate::held_sums::Sums;

/// Size of a row of `A − B` below which it is rounding.
const SMALLEST_ROW: f64 = 1e-9;

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
#[derive(Debug, Clone)]
pub(crate) struct Plane {
    pub a: Vec<f64>,
    pub b: Vec<f64>,
    pub da: Vec<f64>,
    pub db: Vec<f64>,
    /// `A − B`, by which harmonics without contact are held. Beside a contact node that is much stiffer than the structure it is small: for one
    /// contact degree of freedom it is summed up of small numbers, not taken as a difference of large ones.
    pub d: Vec<f64>,
    /// `F` and its derivative.
    pub f: Vec<f64>,
    pub df: Vec<f64>,
    /// Sums over the modes that are not kept apart.
    pub sums: Sums,
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
            d: zero.clone(),
            f: zero.clone(),
            df: zero,
            sums: Sums::new(n),
            poles: 0..0,
            with_next_term: false,
        }
    }

    /// The mean: `A = I`, `B = T_0`.
    pub fn set_static(&mut self, structure: &CondensedStructure) {
        let n = structure.n_contact_dofs();
        identity(&mut self.a, n);
        self.f.copy_from_slice(&structure.sums.t0);
        self.b.copy_from_slice(&self.f);
        for m in [&mut self.da, &mut self.db, &mut self.df] {
            m.fill(0.0);
        }
        self.take_difference();
        self.sums.clear();
        self.poles = 0..0;
    }

    fn take_difference(&mut self) {
        self.d.iter_mut().zip(self.a.iter().zip(&self.b)).for_each(|(d, (a, b))| *d = a - b);
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
        self.poles = structure.sums.same[nearest].clone();
        if n == 1 && self.poles.len() == 1 && !self.with_next_term {
            return self.set_scalars(structure, nu2, passed);
        }
        self.regular_part(structure, nu2);
        self.take_poles_out(structure, nu2, passed);
        // B = A F + β …, and its slope.
        for i in 0..n {
            for k in 0..n {
                let (a, da) = (self.a[i * n + k], self.da[i * n + k]);
                let (f, df) = (&self.f[k * n..(k + 1) * n], &self.df[k * n..(k + 1) * n]);
                let rows = self.b[i * n..(i + 1) * n].iter_mut().zip(&mut self.db[i * n..(i + 1) * n]);
                for ((b, db), (f, df)) in rows.zip(f.iter().zip(df)) {
                    *b += a * f;
                    *db += da * f + a * df;
                }
            }
        }
        self.take_difference();
    }

    /// What is large for row `d` of `A − B`, by which harmonics without contact are held: itself, or what a change of `ν²` by its own size
    /// makes of it where it vanishes, in resonance. Beside a contact node that is much stiffer than the structure both are small.
    pub fn size_of_row(&self, d: usize, nu2: f64) -> f64 {
        if let ([d], [da], [db]) = (&*self.d, &*self.da, &*self.db) {
            return (d.abs() + nu2 * (da - db).abs()).clamp(SMALLEST_ROW, 1.0);
        }
        let n = self.a.len().isqrt();
        let row = d * n..(d + 1) * n;
        let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>();
        let size =
            self.d[row.clone()].iter().map(|d| d.abs()).sum::<f64>() + nu2 * sum(&self.da[row.clone()], &self.db[row]);
        size.clamp(SMALLEST_ROW, 1.0)
    }

    /// The same for one contact degree of freedom, where `h g = s`, in a fraction of the instructions.
    fn set_scalars(&mut self, structure: &CondensedStructure, nu2: f64, passed: usize) {
        let (sums, mode) = (&structure.sums, &structure.modes[self.poles.start]);
        sums.at(nu2, &self.poles, &mut self.sums);
        let (static_response, slope) = (sums.k_nn_inverse[0], sums.residual_transfer[0]);
        // F = T_0 + …, of which 1 − F is small beside a stiff contact node.
        let moving = nu2 * (slope + static_response * self.sums.s1[0]) - mode.s / mode.lambda;
        let (f, rest) = (sums.t0[0] + moving, (1.0 - sums.t0[0]) - moving);
        let df = slope + static_response * self.sums.s2[0];
        let below = usize::from(mode.lambda < nu2);
        let sign = if (passed + below).is_multiple_of(2) { 1.0 } else { -1.0 };
        let delta = mode.lambda - nu2;
        let inverse = 1.0 / (delta * delta + mode.s * mode.s).sqrt();
        let (alpha, beta) = (sign * delta * inverse, sign * mode.s * inverse);
        let turn = mode.s * inverse * inverse;
        let (d_alpha, d_beta) = (-beta * turn, alpha * turn);
        (self.f[0], self.df[0], self.a[0], self.da[0]) = (f, df, alpha, d_alpha);
        (self.b[0], self.db[0]) = (beta + alpha * f, d_beta + d_alpha * f + alpha * df);
        self.d[0] = alpha * rest - beta;
    }

    /// `A`, and `B` but for `A F`.
    fn take_poles_out(&mut self, structure: &CondensedStructure, nu2: f64, passed: usize) {
        let (n, modes) = (structure.n_contact_dofs(), &structure.modes);
        let below = self.poles.clone().filter(|&p| modes[p].lambda < nu2).count();
        // Each pole passed turns the sign of det(I − T …); with those of δ it keeps its own.
        let mut sign = if (passed + below).is_multiple_of(2) { 1.0 } else { -1.0 };
        identity(&mut self.a, n);
        for number in 0..n * n {
            (self.da[number], self.b[number], self.db[number]) = (0.0, 0.0, 0.0);
        }
        for p in self.poles.clone() {
            let (delta, s) = (modes[p].lambda - nu2, modes[p].s);
            let rho = (delta * delta + s * s).sqrt();
            let (alpha, beta) = (sign * delta / rho, sign * s / rho);
            // d/dν² = −d/dδ
            let (d_alpha, d_beta) = (-beta * s / (rho * rho), beta * delta / (rho * rho));
            for (at, e) in structure.sums.directions[p * n * n..(p + 1) * n * n].iter().enumerate() {
                self.a[at] -= (1.0 - alpha) * e;
                self.da[at] += d_alpha * e;
                self.b[at] += beta * e;
                self.db[at] += d_beta * e;
            }
            sign = 1.0;
        }
    }

    /// `F = T − Σ_p h_p g_p/(λ_p − ν²)` and its derivative; the terms of the poles leave only their static share.
    fn regular_part(&mut self, structure: &CondensedStructure, nu2: f64) {
        let (n, sums) = (structure.n_contact_dofs(), &structure.sums);
        self.df.copy_from_slice(&sums.residual_transfer);
        self.f.iter_mut().zip(&sums.t0).zip(&self.df).for_each(|((f, t0), slope)| *f = t0 + nu2 * slope);
        if self.with_next_term {
            let both = self.f.iter_mut().zip(&mut self.df).zip(&sums.next_transfer);
            both.for_each(|((f, df), next)| {
                *f += nu2 * nu2 * next;
                *df += 2.0 * nu2 * next;
            });
        }
        sums.at(nu2, &self.poles, &mut self.sums);
        sums.add_static_response(nu2, &self.sums.s1, &mut self.f);
        sums.add_static_response(1.0, &self.sums.s2, &mut self.df);
        for p in self.poles.clone() {
            let weight = structure.modes[p].s / structure.modes[p].lambda;
            let direction = &sums.directions[p * n * n..(p + 1) * n * n];
            self.f.iter_mut().zip(direction).for_each(|(f, e)| *f -= weight * e);
        }
    }
}

fn identity(m: &mut [f64], n: usize) {
    m.iter_mut().enumerate().for_each(|(at, m)| *m = if at % (n + 1) == 0 { 1.0 } else { 0.0 });
}

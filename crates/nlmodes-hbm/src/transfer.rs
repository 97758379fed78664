use std::ops::Range;

use crate::condensed::Held;
use crate::held_sums::Sums;

/// Size of a row of `A − B` below which it is rounding.
const SMALLEST_ROW: f64 = 1e-9;

/// The linear structure at one harmonic: `A b_n = B q_N,n`, a form of eq. (8) without poles.
///
/// `b_n = T(ν²) q_N,n` has a pole at each eigenfrequency `λ_p` of the held structure, where `q_N,n` vanishes while
/// `b_n` stays finite. With the more resonant mode `p` of the two around `ν²` apart, `T = F + h_p g_p/δ`,
/// `δ = λ_p − ν²`, multiplication by the regular matrix
///
/// ```text
/// A = I − (1 − α) h_p g_p / s_p ,   B = A F + β h_p g_p / s_p ,   α = δ/√(δ² + s_p²) ,   β = s_p/√(δ² + s_p²)
/// ```
///
/// gives coefficients that stay near one and pass smoothly through the pole. Several modes with the same frequency have
/// `g_i h_j = 0` and add up. The sign of `det A`, carried by α and β of one mode, follows the number of poles below
/// `ν²`, so that it does not jump where another mode becomes the more resonant one.
///
/// All matrices are row-major, n_N × n_N; derivatives are with respect to `ν²`.
#[derive(Debug, Clone)]
pub(crate) struct Plane {
    pub a: Vec<f64>,
    pub b: Vec<f64>,
    pub da: Vec<f64>,
    pub db: Vec<f64>,
    /// `A − B`, by which harmonics without contact are held. Beside a contact node that is much stiffer than the
    /// structure it is small: for one contact degree of freedom it is summed up of small numbers, not taken as a
    /// difference of large ones.
    pub d: Vec<f64>,
    /// `F` and its derivative.
    pub f: Vec<f64>,
    pub df: Vec<f64>,
    /// `g_p F` and its derivative of the pole under way.
    g_f: Vec<[f64; 2]>,
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
            g_f: vec![[0.0; 2]; n],
            sums: Sums::new(n),
            poles: 0..0,
            with_next_term: false,
        }
    }

    /// The mean: `A = I`, `B = T_0`.
    pub fn set_static(&mut self, held: &Held) {
        let n = held.n_contact_dofs();
        identity(&mut self.a, n);
        self.f.copy_from_slice(&held.sums.t0);
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
    pub fn set(&mut self, held: &Held, nu2: f64) {
        let n = held.n_contact_dofs();
        let modes = &held.modes;
        let passed = modes.partition_point(|m| m.lambda < nu2);
        let resonance = |k: &usize| modes[*k].s / (modes[*k].lambda - nu2).abs();
        let neighbours = passed.saturating_sub(1)..(passed + 1).min(modes.len());
        let nearest = neighbours.max_by(|i, j| resonance(i).total_cmp(&resonance(j)));
        let Some(nearest) = nearest else { return self.set_static(held) };
        self.poles = held.sums.same[nearest].clone();
        if n == 1 && self.poles.len() == 1 && !self.with_next_term {
            return self.set_scalars(held, nu2, passed);
        }
        self.regular_part(held, nu2);
        self.take_poles_out(held, nu2, passed);
        self.take_difference();
    }

    /// What is large for row `d` of `A − B`, by which harmonics without contact are held: itself, or what a change of
    /// `ν²` by its own size makes of it where it vanishes, in resonance. Beside a contact node that is much stiffer
    /// than the structure both are small.
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
    fn set_scalars(&mut self, held: &Held, nu2: f64, passed: usize) {
        let (sums, mode) = (&held.sums, &held.modes[self.poles.start]);
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

    /// `A`, `B = A F + …` and their slopes: row `i` is that of `I` or `F` with `h_i` times a row of the mode.
    fn take_poles_out(&mut self, held: &Held, nu2: f64, passed: usize) {
        let (n, modes) = (held.n_contact_dofs(), &held.modes);
        let below = self.poles.clone().filter(|&p| modes[p].lambda < nu2).count();
        // Each pole passed turns the sign of det(I − T …); with those of δ it keeps its own.
        let mut sign = if (passed + below).is_multiple_of(2) { 1.0 } else { -1.0 };
        identity(&mut self.a, n);
        self.da.fill(0.0);
        self.b.copy_from_slice(&self.f);
        self.db.copy_from_slice(&self.df);
        for mode in &modes[self.poles.clone()] {
            let (delta, s) = (mode.lambda - nu2, mode.s);
            let rho = (delta * delta + s * s).sqrt();
            let (alpha, beta) = (sign * delta / rho, sign * s / rho);
            // d/dν² = −d/dδ
            let (d_alpha, d_beta) = (-beta * s / (rho * rho), beta * delta / (rho * rho));
            self.g_f.fill([0.0; 2]);
            for (g, (f, df)) in mode.g.iter().zip(self.f.chunks_exact(n).zip(self.df.chunks_exact(n))) {
                let rows = self.g_f.iter_mut().zip(f.iter().zip(df));
                rows.for_each(|(sum, (f, df))| (sum[0], sum[1]) = (sum[0] + g * f, sum[1] + g * df));
            }
            for (i, h) in mode.h.iter().enumerate() {
                let h = h / s;
                for (at, (g, [g_f, g_df])) in (i * n..).zip(mode.g.iter().zip(&self.g_f)) {
                    self.a[at] -= (1.0 - alpha) * h * g;
                    self.da[at] += d_alpha * h * g;
                    self.b[at] += h * (beta * g - (1.0 - alpha) * g_f);
                    self.db[at] += h * (d_beta * g + d_alpha * g_f - (1.0 - alpha) * g_df);
                }
            }
            sign = 1.0;
        }
    }

    /// `F = T − Σ_p h_p g_p/(λ_p − ν²)` and its derivative; the terms of the poles leave only their static share.
    fn regular_part(&mut self, held: &Held, nu2: f64) {
        let (n, sums) = (held.n_contact_dofs(), &held.sums);
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
        for mode in &held.modes[self.poles.clone()] {
            for (f, h) in self.f.chunks_exact_mut(n).zip(&mode.h) {
                f.iter_mut().zip(&mode.g).for_each(|(f, g)| *f -= h * g / mode.lambda);
            }
        }
    }
}

fn identity(m: &mut [f64], n: usize) {
    m.iter_mut().enumerate().for_each(|(at, m)| *m = if at % (n + 1) == 0 { 1.0 } else { 0.0 });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CondensedStructure;
    use nlmodes_linalg::sparse_from_triplets;
    use nlmodes_model::{Contact, Dof, DofKind, Drop, MasslessContactModel, Side, StructuralModel};

    /// Four masses in a row, springs between them and to both sides, and massless nodes before stops; with all of its
    /// held modes. Lengths and masses in the given units.
    fn chain(contacts: &[usize], [metre, kilogram]: [f64; 2]) -> CondensedStructure {
        let (n, spring) = (4 + contacts.len(), 2e4 * kilogram);
        let mut k: Vec<_> = (0..n).map(|i| (i, i, 0.5 * spring)).collect();
        for i in 1..n {
            k.extend([(i, i, spring), (i - 1, i - 1, spring), (i, i - 1, -spring), (i - 1, i, -spring)]);
        }
        let massive = (0..n).filter(|i| !contacts.contains(i));
        let m: Vec<_> = massive.map(|i| (i, i, (0.1 + 0.03 * i as f64) * kilogram)).collect();
        let dofs = (0..n).map(|node| Dof { node, position: metre * node as f64, kind: DofKind::Axial }).collect();
        let matrix = |entries: &[_]| sparse_from_triplets(n, n, entries).unwrap();
        let stops = contacts.iter().map(|&dof| Contact::rigid(dof, Side::Positive, 1e-3 * metre)).collect();
        let model = StructuralModel::new(matrix(&m), matrix(&k), dofs, stops).unwrap();
        CondensedStructure::new(MasslessContactModel::new(&model, &Drop).unwrap(), 4).unwrap()
    }

    fn structures() -> Vec<CondensedStructure> {
        let units = [[1.0, 1.0], [1e3, 1e-3]];
        units.iter().flat_map(|units| [chain(&[4], *units), chain(&[2], *units), chain(&[1, 5], *units)]).collect()
    }

    /// Those, and one with so many contacts that products go by blocks.
    fn with_many_contacts() -> Vec<CondensedStructure> {
        let contacts: Vec<usize> = (0..22).filter(|node| node % 6 != 3).collect();
        structures().into_iter().chain([chain(&contacts, [1.0, 1.0])]).collect()
    }

    /// Squared frequencies between and beside all poles, and beyond.
    fn frequencies(structure: &CondensedStructure) -> Vec<f64> {
        let lambda: Vec<f64> = structure.modes().iter().map(|m| m.lambda).collect();
        let beside = lambda.iter().flat_map(|l| [0.999, 0.9, 1.02, 1.13].map(|share| share * l));
        beside.chain([0.02 * lambda[0], 1.7 * lambda[lambda.len() - 1]]).collect()
    }

    fn at(structure: &CondensedStructure, nu2: f64, with_next_term: bool) -> Plane {
        let mut plane = Plane::new(structure.n_contact_dofs());
        plane.with_next_term = with_next_term;
        plane.set(&structure.held, nu2);
        plane
    }

    /// Entries of a plane, and their slopes.
    type Part<'a> = (fn(&Plane) -> &[f64], &'a [f64]);

    /// `A T = B` with `T` as the sum over the modes.
    #[test]
    fn the_form_without_poles_is_that_of_the_transfer() {
        for structure in with_many_contacts() {
            let n = structure.n_contact_dofs();
            for nu2 in frequencies(&structure) {
                let plane = at(&structure, nu2, false);
                let transfer = |i: usize, j: usize| {
                    let of = |m: &crate::HeldMode| nu2 / (m.lambda * (m.lambda - nu2)) * m.h[i] * m.g[j];
                    structure.held.sums.t0[i * n + j] + structure.modes().iter().map(of).sum::<f64>()
                };
                for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                    let terms: Vec<f64> = (0..n).map(|k| plane.a[i * n + k] * transfer(k, j)).collect();
                    let size = 1.0 + terms.iter().map(|t| t.abs()).sum::<f64>();
                    let error = (terms.iter().sum::<f64>() - plane.b[i * n + j]).abs() / size;
                    assert!(error < 1e-11, "{nu2}: {error:e}");
                    assert!((plane.d[i * n + j] - plane.a[i * n + j] + plane.b[i * n + j]).abs() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn its_slopes_and_sizes_are_those_by_differences() {
        for structure in with_many_contacts() {
            let n = structure.n_contact_dofs();
            for nu2 in frequencies(&structure) {
                let step = 1e-6 * nu2;
                let [low, plane, high] = [-step, 0.0, step].map(|step| at(&structure, nu2 + step, false));
                let by = |of: fn(&Plane) -> &[f64], at: usize| (of(&high)[at] - of(&low)[at]) / (2.0 * step);
                let parts: [Part<'_>; 3] = [(|p| &p.a, &plane.da), (|p| &p.b, &plane.db), (|p| &p.f, &plane.df)];
                for (of, slope) in parts {
                    for (number, slope) in slope.iter().enumerate() {
                        // Beside a pole, a thousandth away, third derivatives leave some 1e-6.
                        assert!(
                            (by(of, number) - slope).abs() * nu2 < 1e-4 * (1.0 + slope.abs() * nu2),
                            "{nu2} {number}"
                        );
                    }
                }
                for row in 0..n {
                    let own = |j: usize| plane.d[row * n + j].abs() + nu2 * by(|p| &p.d, row * n + j).abs();
                    let expected = (0..n).map(own).sum::<f64>().clamp(SMALLEST_ROW, 1.0);
                    let found = plane.size_of_row(row, nu2);
                    assert!((found / expected - 1.0).abs() < 1e-4, "{nu2} {row}: {found} {expected}");
                }
            }
        }
    }

    /// Where all modes are there nothing follows behind them, so that matrices and the way for one degree of freedom
    /// tell the same.
    #[test]
    fn one_degree_of_freedom_is_no_other_case() {
        for structure in structures().iter().filter(|structure| structure.n_contact_dofs() == 1) {
            for nu2 in frequencies(structure) {
                let [short, long] = [false, true].map(|with_next_term| at(structure, nu2, with_next_term));
                let numbers = |p: &Plane| [p.a[0], p.b[0], p.d[0], p.f[0], nu2 * p.da[0], nu2 * p.db[0], nu2 * p.df[0]];
                for (a, b) in numbers(&short).iter().zip(numbers(&long)) {
                    assert!((a - b).abs() < 1e-9 * (1.0 + a.abs()), "{nu2}: {a} {b}");
                }
            }
        }
    }

    /// `det A = ±α` of one pole: it changes its sign where a pole is passed, and nowhere else.
    #[test]
    fn the_sign_of_the_determinant_counts_the_poles_below() {
        for structure in structures() {
            for (nu2, with_next_term) in frequencies(&structure).iter().flat_map(|nu2| [(*nu2, false), (*nu2, true)]) {
                let plane = at(&structure, nu2, with_next_term);
                let determinant = match plane.a[..] {
                    [a] => a,
                    [a, b, c, d] => a * d - b * c,
                    _ => panic!("one or two degrees of freedom"),
                };
                let below = structure.modes().iter().filter(|m| m.lambda < nu2).count();
                assert_eq!(determinant > 0.0, below % 2 == 0, "{nu2}: {determinant} with {below} poles below");
            }
        }
    }
}

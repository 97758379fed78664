use std::sync::Arc;

use num_complex::Complex64;

use super::block::{HarmonicBlock, LinearResponse, dynamic_stiffness};
use super::directions::Directions;
use super::load::Load;
use super::operating_point::OperatingPoint;
use super::structure::ModalStructure;

/// The linear structure as the contacts see it: `x = u = Y η`, for few contacts and uncoupled modes. Contacts that
/// share a direction, such as stops that face each other, share a coordinate.
///
/// `u_n = Σ_k y_k w_k/D_k`, `w_k = y_kᵀ λ_n + p_k`, has a pole where an undamped mode is resonant. With the most
/// resonant mode p apart, `v = u − Σ_{k≠p} y_k w_k/D_k`, `ρ = √(|D_p|² + s_p²)` and the reflection `B` that brings
/// `y_p` to the first coordinate, the first row is multiplied by `D_p/ρ`:
///
/// ```text
/// α = y_pᵀ v/|y_p|²
/// r_0 = ±|y_p| (D_p α − w_p)/ρ ,   r_i = (B v)_i                        D_p/ρ may be 10⁻⁹: no row may hold both
/// η_p = [D̄_p w_p + s_p² α]/ρ²                                          also where D_p vanishes; η_k = w_k/D_k else
/// ```
///
/// A complex factor turns and stretches a pair of real rows, so that the determinant keeps its sign. Even motions have
/// one real row: there the signs of the other `D_k` go with it, and the sign does not jump where another mode becomes
/// the most resonant one.
pub(crate) struct ContactResponse {
    structure: Arc<ModalStructure>,
    coupling: Vec<f64>,
    /// Modes that move a contact.
    moving: Vec<usize>,
    directions: Directions,
    even: bool,
}

impl ContactResponse {
    pub fn new(structure: Arc<ModalStructure>, even: bool) -> Self {
        let coupling = (0..structure.n_modes()).map(|k| structure.coupling(k)).collect();
        let moving = (0..structure.n_modes()).filter(|&k| structure.moves_a_contact(k)).collect();
        let directions = Directions::of(&structure);
        Self { structure, coupling, moving, directions, even }
    }

    /// Number of coordinates.
    fn size(&self) -> usize {
        self.directions.first.len()
    }

    fn y(&self, i: usize, k: usize) -> f64 {
        self.structure.rows()[(self.directions.first[i], k)]
    }

    fn square(&self, k: usize) -> f64 {
        (0..self.size()).map(|i| self.y(i, k).powi(2)).sum()
    }

    /// Sum over contacts of `y_ik v_i`.
    fn along(&self, k: usize, v: &[Complex64]) -> Complex64 {
        v.iter().enumerate().map(|(i, v)| v * self.y(i, k)).sum()
    }
}

impl LinearResponse for ContactResponse {
    fn n_coordinates(&self) -> usize {
        self.size()
    }

    fn gap_row(&self, i: usize, j: usize) -> f64 {
        let (direction, factor) = self.directions.of_contact[i];
        if direction == j { factor } else { 0.0 }
    }

    fn of_mode(&self, k: usize) -> Vec<f64> {
        (0..self.size()).map(|i| self.y(i, k)).collect()
    }

    fn scale(&self, length: f64) -> f64 {
        length
    }

    fn evaluate(
        &self,
        n: usize,
        at: OperatingPoint,
        load: &Load,
        x: &[Complex64],
        force: &[Complex64],
        out: &mut HarmonicBlock,
    ) {
        let (c, m) = (self.size(), self.structure.n_modes());
        out.reset(c, m);
        let stiffness: Vec<_> = (0..m).map(|k| dynamic_stiffness(&self.structure, n, k, at)).collect();
        out.d.iter_mut().zip(&stiffness).for_each(|(d, s)| *d = s.0);
        let resonance = |k: usize| self.coupling[k] / stiffness[k].0.norm();
        let resonances = self.moving.iter().map(|&k| (k, resonance(k)));
        let pole = resonances.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k);
        let (mut v, mut dv) = (x.to_vec(), [0, 1, 2].map(|_| vec![Complex64::default(); c]));
        for k in (0..m).filter(|k| Some(*k) != pole) {
            let p = load.modal(n, k, at);
            let w = self.along(k, force) + p.value;
            if w == Complex64::default() && p.by.iter().all(|d| *d == Complex64::default()) && !self.moving.contains(&k)
            {
                continue;
            }
            let (d, dd) = stiffness[k];
            let eta = w / d;
            out.eta[k] = eta;
            let change = [(p.by[0] - eta * dd[0]) / d, (p.by[1] - eta * dd[1]) / d, p.by[2] / d];
            (0..3).for_each(|t| out.d_eta[t][k] = change[t]);
            for i in 0..c {
                v[i] -= eta * self.y(i, k);
                (0..3).for_each(|t| dv[t][i] -= change[t] * self.y(i, k));
                (0..c).for_each(|j| out.g[i * c + j] += self.y(i, k) * self.y(j, k) / d);
            }
        }
        match pole {
            Some(p) => self.apart(p, n, at, load, &stiffness[p], force, (&v, &dv), out),
            None => {
                out.residual.copy_from_slice(&v);
                out.d_residual.clone_from(&dv);
                (0..c).for_each(|i| out.l[i * c + i] = Complex64::ONE);
            }
        }
        if self.even {
            let others = self.moving.iter().filter(|k| Some(**k) != pole);
            let sign: f64 = others.map(|&k| stiffness[k].0.re.signum()).product();
            out.l[..c].iter_mut().chain(&mut out.g[..c]).for_each(|v| *v *= sign);
            out.residual[0] *= sign;
            out.d_residual.iter_mut().for_each(|d| d[0] *= sign);
        }
    }

    fn pull(&self, block: &HarmonicBlock, weights: &[Complex64]) -> (Vec<Complex64>, Vec<Complex64>) {
        let c = self.size();
        let (mut by_x, mut by_force) = (vec![Complex64::default(); c], vec![Complex64::default(); c]);
        let Some((p, rho2)) = block.pole else { return (by_x, by_force) };
        let share = self.coupling[p].powi(2) / (rho2 * self.square(p));
        (0..c).for_each(|i| {
            by_x[i] = weights[p] * share * self.y(i, p);
            by_force[i] = weights[p] * block.d[p].conj() / rho2 * self.y(i, p);
        });
        for &k in self.moving.iter().filter(|k| **k != p) {
            let across: f64 = (0..c).map(|i| self.y(i, p) * self.y(i, k)).sum();
            let weight = (weights[k] - weights[p] * share * across) / block.d[k];
            by_force.iter_mut().enumerate().for_each(|(i, b)| *b += weight * self.y(i, k));
        }
        (by_x, by_force)
    }
}

impl ContactResponse {
    /// The equations with mode `p` apart, from `v` and its derivatives.
    #[expect(clippy::too_many_arguments, reason = "one equation with all its symbols")]
    fn apart(
        &self,
        p: usize,
        n: usize,
        at: OperatingPoint,
        load: &Load,
        (d, dd): &(Complex64, [Complex64; 2]),
        force: &[Complex64],
        (v, dv): (&[Complex64], &[Vec<Complex64>; 3]),
        out: &mut HarmonicBlock,
    ) {
        let c = v.len();
        let (square, s2) = (self.square(p), self.coupling[p].powi(2));
        let rho2 = d.norm_sqr() + s2;
        let rho = rho2.sqrt();
        let load = load.modal(n, p, at);
        let w = self.along(p, force) + load.value;
        let alpha = self.along(p, v) / square;
        let zero = Complex64::default();
        out.pole = Some((p, rho2));
        out.eta[p] = (d.conj() * w + alpha * s2) / rho2;
        let turn = Turn::of((0..c).map(|i| self.y(i, p)).collect());
        turn.apply(v, &mut out.residual);
        out.residual[0] = (d * alpha - w) * (turn.length / rho);
        for t in 0..3 {
            let dd = if t < 2 { dd[t] } else { zero };
            let d_rho = (d.conj() * dd).re / rho;
            let d_alpha = self.along(p, &dv[t]) / square;
            let dw = load.by[t];
            turn.apply(&dv[t], &mut out.d_residual[t]);
            let change = dd * alpha + d * d_alpha - dw - (d * alpha - w) * (d_rho / rho);
            out.d_residual[t][0] = change * (turn.length / rho);
            out.d_eta[t][p] = (dd.conj() * w + d.conj() * dw + d_alpha * s2) / rho2 - out.eta[p] * (2.0 * d_rho / rho);
        }
        // G of the other modes so far, and L = I, are turned in the same way.
        let (mut column, mut turned) = (vec![zero; c], vec![zero; c]);
        for j in 0..c {
            (0..c).for_each(|i| column[i] = out.g[i * c + j]);
            turn.apply(&column, &mut turned);
            let along = self.along(p, &column) / square;
            (1..c).for_each(|i| out.g[i * c + j] = turned[i]);
            out.g[j] = (d * along + self.y(j, p)) * (turn.length / rho);
            column.fill(zero);
            column[j] = Complex64::ONE;
            turn.apply(&column, &mut turned);
            (1..c).for_each(|i| out.l[i * c + j] = turned[i]);
            out.l[j] = d * (self.y(j, p) / square * turn.length / rho);
        }
    }
}

/// The reflection that brings a direction `y` to the first coordinate, `B y = ±|y| e₀`, of either sign:
/// `B = β w wᵀ − I` with `w = y/|y| ± e₀`.
struct Turn {
    w: Vec<f64>,
    beta: f64,
    /// `±|y|`.
    length: f64,
}

impl Turn {
    fn of(y: Vec<f64>) -> Self {
        let size = y.iter().map(|y| y * y).sum::<f64>().sqrt();
        let sign = if y[0] < 0.0 { -1.0 } else { 1.0 };
        let mut w: Vec<f64> = y.iter().map(|y| y / size).collect();
        let beta = 1.0 / (1.0 + w[0].abs());
        w[0] += sign;
        Self { w, beta, length: sign * size }
    }

    fn apply(&self, v: &[Complex64], out: &mut [Complex64]) {
        let along: Complex64 = self.w.iter().zip(v).map(|(w, v)| v * *w).sum();
        let turned = self.w.iter().zip(v).map(|(w, v)| along * (self.beta * w) - v);
        out.iter_mut().zip(turned).for_each(|(out, v)| *out = v);
    }
}

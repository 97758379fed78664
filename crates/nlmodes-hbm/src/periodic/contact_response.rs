use std::sync::Arc;

use num_complex::Complex64;

use super::block::{Asked, HarmonicBlock, LinearResponse, ModalMotion, dynamic_stiffness};
use super::directions::Directions;
use super::load::{Load, Varied};
use super::mode_sums::{ModeSums, Sums};
use super::operating_point::OperatingPoint;
use super::structure::ModalStructure;

/// The linear structure as the contacts see it: `x = u = Y η`, for few contacts and uncoupled modes. Contacts that
/// share a direction, such as stops that face each other, share a coordinate.
///
/// Displacements of laws `v` are coordinates behind them. With the reactions `f` of the laws and the residual
/// flexibility `H` between the places of contacts and laws, but not between contacts, which the contact operator has,
///
/// ```text
/// u = Y η + H_uf f ,   v = R η + H_fu λ + H_ff f + a
/// ```
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
    /// `H` of these coordinates, row-major; empty without laws.
    residual: Vec<f64>,
    /// `y_k` of all modes, one mode after the other, with `|y_k|²`.
    rows: Vec<f64>,
    squares: Vec<f64>,
    turns: Vec<Turn>,
    /// For motions that are even in time.
    even: Option<ModeSums>,
}

/// What one mode, not the one apart, does: `η_k` with its derivatives with respect to ω, ξ and the level.
struct Answer {
    mode: usize,
    eta: Complex64,
    d_eta: [Complex64; 3],
    /// `1/D_k`.
    inverse: Complex64,
}

impl ContactResponse {
    pub fn new(structure: Arc<ModalStructure>, even: bool) -> Self {
        let modes = 0..structure.n_modes();
        let directions = Directions::of(&structure);
        let laws = structure.laws();
        let row = |k: usize| -> Vec<f64> {
            let contacts = directions.first.iter().map(|&i| structure.rows()[(i, k)]);
            contacts.chain(laws.iter().map(|law| law.modes[k])).collect()
        };
        let residual = residual(&structure, &directions);
        Self {
            coupling: modes.clone().map(|k| structure.coupling(k)).collect(),
            moving: modes.clone().filter(|&k| structure.moves_a_contact(k)).collect(),
            rows: modes.clone().flat_map(row).collect(),
            squares: modes.clone().map(|k| row(k).iter().map(|y| y.powi(2)).sum()).collect(),
            turns: modes.map(|k| Turn::of(row(k))).collect(),
            even: even.then(|| ModeSums::new(&structure, &directions.first, &residual)),
            residual,
            directions,
            structure,
        }
    }

    /// Number of coordinates.
    fn size(&self) -> usize {
        self.directions.first.len() + self.structure.laws().len()
    }

    /// Takes the static shares of laws off their displacements `v` and the derivatives: `H f̂` and what the load moves.
    fn take_static(
        &self,
        n: usize,
        at: OperatingPoint,
        drive: &Drive,
        v: &mut [Complex64],
        dv: &mut [Vec<Complex64>; 3],
    ) {
        if self.residual.is_empty() {
            return;
        }
        v.iter_mut().zip(self.residual.chunks(self.size())).for_each(|(v, row)| *v -= along(row, drive.force));
        let (first, contacts) = (self.directions.first.len(), self.structure.n_contacts());
        let Some(load) = drive.load else { return };
        for l in 0..self.structure.laws().len() {
            let moved = load.gap(n, contacts + l, at);
            v[first + l] -= moved.value;
            (0..3).for_each(|t| dv[t][first + l] -= moved.by[t]);
        }
    }

    /// `y_k`, c.
    fn row(&self, k: usize) -> &[f64] {
        &self.rows[k * self.size()..(k + 1) * self.size()]
    }

    /// The most resonant mode.
    fn pole(&self, n: usize, at: OperatingPoint) -> Option<usize> {
        let resonance = |k: usize| self.coupling[k].powi(2) / dynamic_stiffness(&self.structure, n, k, at).0.norm_sqr();
        let resonances = self.moving.iter().map(|&k| (k, resonance(k)));
        resonances.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
    }

    /// The answer of mode `k` to the contact forces and the load.
    fn answer(&self, k: usize, n: usize, at: OperatingPoint, drive: &Drive) -> Answer {
        let (p, (d, dd)) = (drive.of(k, n, at), dynamic_stiffness(&self.structure, n, k, at));
        let (eta, inverse) = ((along(self.row(k), drive.force) + p.value) / d, d.inv());
        let change = |t: usize| match dd.get(t) {
            _ if !drive.by[t] => Complex64::default(),
            Some(dd) => (p.by[t] - eta * dd) * inverse,
            None => p.by[t] * inverse,
        };
        let d_eta = if drive.by.contains(&true) { [0, 1, 2].map(change) } else { Default::default() };
        Answer { mode: k, eta, d_eta, inverse }
    }

    /// Takes what a mode does off `v` and its derivatives.
    fn take(&self, answer: &Answer, by: [bool; 3], v: &mut [Complex64], dv: &mut [Vec<Complex64>; 3]) {
        let row = self.row(answer.mode);
        v.iter_mut().zip(row).for_each(|(v, y)| *v -= answer.eta * y);
        for (i, y) in row.iter().enumerate().filter(|_| by.contains(&true)) {
            (0..3).filter(|t| by[*t]).for_each(|t| dv[t][i] -= answer.d_eta[t] * y);
        }
    }
}

/// `H`, residual flexibility between contacts and laws, and among laws, in the coordinates; empty without laws.
fn residual(structure: &ModalStructure, directions: &Directions) -> Vec<f64> {
    let (first, laws) = (&directions.first, structure.laws());
    if laws.is_empty() {
        return Vec::new();
    }
    let c = first.len();
    let entry = |i: usize, j: usize| match (i.checked_sub(c), j.checked_sub(c)) {
        (None, None) => 0.0,
        (None, Some(l)) => laws[l].contacts[first[i]],
        (Some(l), None) => laws[l].contacts[first[j]],
        (Some(l), Some(other)) => laws[l].laws[other],
    };
    let d = c + laws.len();
    (0..d).flat_map(|i| (0..d).map(move |j| (i, j))).map(|(i, j)| entry(i, j)).collect()
}

/// What drives the modes in one harmonic.
struct Drive<'a> {
    force: &'a [Complex64],
    /// The load, if it has this harmonic.
    load: Option<&'a Load>,
    /// The derivatives that are asked for.
    by: [bool; 3],
}

impl Drive<'_> {
    fn of(&self, k: usize, n: usize, at: OperatingPoint) -> Varied {
        self.load.map_or_else(Varied::default, |load| load.modal(n, k, at))
    }
}

/// Sum over contacts of `y_ik v_i`.
fn along(row: &[f64], v: &[Complex64]) -> Complex64 {
    v.iter().zip(row).map(|(v, y)| v * y).sum()
}

impl LinearResponse for ContactResponse {
    fn n_coordinates(&self) -> usize {
        self.size()
    }

    fn first_law(&self) -> usize {
        self.directions.first.len()
    }

    fn gap_row(&self, i: usize, j: usize) -> f64 {
        let (direction, factor) = self.directions.of_contact[i];
        if direction == j { factor } else { 0.0 }
    }

    fn of_mode(&self, k: usize) -> Vec<f64> {
        self.row(k).to_vec()
    }

    fn scale(&self, length: f64) -> f64 {
        length
    }

    fn take_any_phase(&mut self) {
        self.even = None;
    }

    fn evaluate(&mut self, n: usize, at: OperatingPoint, load: &Load, asked: Asked, block: &mut HarmonicBlock) {
        block.reset();
        // The mean under a steady force is no sum over modes without load.
        let even = if load.has_harmonic(n) { None } else { self.even.take() };
        match even {
            Some(mut modes) => {
                self.evaluate_even(n, at, &mut modes, block);
                self.even = Some(modes);
            }
            None => self.evaluate_any(n, at, load, asked, block),
        }
    }

    fn modal_motion(
        &self,
        n: usize,
        at: OperatingPoint,
        load: &Load,
        block: &HarmonicBlock,
        derivatives: bool,
    ) -> ModalMotion {
        let (mut motion, mut v) = (ModalMotion::at_rest(self.structure.n_modes()), block.x.clone());
        let mut dv = [0, 1, 2].map(|_| vec![Complex64::default(); v.len()]);
        let pole = block.pole.map(|(p, _)| p);
        let drive = Drive { force: &block.force, load: load.has_harmonic(n).then_some(load), by: [derivatives; 3] };
        let drives = |k: usize| (n > 0 && drive.load.is_some()) || self.squares[k] > 0.0;
        self.take_static(n, at, &drive, &mut v, &mut dv);
        for k in (0..motion.eta.len()).filter(|&k| Some(k) != pole && drives(k)) {
            let answer = self.answer(k, n, at, &drive);
            motion.eta[k] = answer.eta;
            (0..3).for_each(|t| motion.d_eta[t][k] = answer.d_eta[t]);
            self.take(&answer, drive.by, &mut v, &mut dv);
        }
        if let Some((p, _)) = block.pole {
            let (eta, d_eta) = self.resonant(&self.apart(p, n, at, &drive), &v, &dv);
            motion.eta[p] = eta;
            (0..3).for_each(|t| motion.d_eta[t][p] = d_eta[t]);
        }
        motion
    }

    fn pull(
        &self,
        n: usize,
        at: OperatingPoint,
        block: &HarmonicBlock,
        weights: &[Complex64],
    ) -> (Vec<Complex64>, Vec<Complex64>) {
        let c = self.size();
        let (mut by_x, mut by_force) = (vec![Complex64::default(); c], vec![Complex64::default(); c]);
        let Some((p, rho2)) = block.pole else { return (by_x, by_force) };
        let stiffness = |k: usize| dynamic_stiffness(&self.structure, n, k, at).0;
        let share = self.coupling[p].powi(2) / (rho2 * self.squares[p]);
        let apart = weights[p] * stiffness(p).conj() / rho2;
        for (i, y) in self.row(p).iter().enumerate() {
            by_x[i] = weights[p] * share * y;
            by_force[i] = apart * y;
        }
        for (y, row) in self.row(p).iter().zip(self.residual.chunks(c)) {
            let weight = weights[p] * share * y;
            by_force.iter_mut().zip(row).for_each(|(b, h)| *b -= weight * h);
        }
        for &k in self.moving.iter().filter(|k| **k != p) {
            let across: f64 = self.row(p).iter().zip(self.row(k)).map(|(a, b)| a * b).sum();
            let weight = (weights[k] - weights[p] * share * across) / stiffness(k);
            by_force.iter_mut().zip(self.row(k)).for_each(|(b, y)| *b += weight * y);
        }
        (by_x, by_force)
    }

    fn pull_load(
        &self,
        n: usize,
        at: OperatingPoint,
        block: &HarmonicBlock,
        residual: &[Complex64],
        eta: &[Complex64],
    ) -> (Vec<Complex64>, Vec<Complex64>) {
        let mut of = vec![Complex64::default(); eta.len()];
        // Weights of `v`, which all modes but the one apart are taken off.
        let mut by_v = residual.to_vec();
        if let Some((p, rho2)) = block.pole {
            let (d, turn) = (dynamic_stiffness(&self.structure, n, p, at).0, &self.turns[p]);
            let factor = residual[0] * (turn.length / rho2.sqrt());
            of[p] = eta[p] * d.conj() / rho2 - factor;
            by_v[0] = Complex64::default();
            turn.apply(&mut by_v);
            let along_row = (factor * d + eta[p] * (self.coupling[p].powi(2) / rho2)) / self.squares[p];
            by_v.iter_mut().zip(self.row(p)).for_each(|(to, y)| *to += along_row * y);
        }
        let pole = block.pole.map(|(p, _)| p);
        for k in (0..of.len()).filter(|&k| Some(k) != pole && (n > 0 || self.squares[k] > 0.0)) {
            of[k] = (eta[k] - along(self.row(k), &by_v)) / dynamic_stiffness(&self.structure, n, k, at).0;
        }
        (of, by_v[self.first_law()..].iter().map(|weight| -weight).collect())
    }
}

/// The mode apart at one harmonic.
struct Apart {
    mode: usize,
    /// `D_p` with its derivatives with respect to ω and ξ.
    d: Complex64,
    dd: [Complex64; 2],
    /// `s_p²` and `ρ²`.
    s2: f64,
    rho2: f64,
    /// `w_p` with its derivatives.
    w: Complex64,
    dw: [Complex64; 3],
    /// The derivatives that are asked for.
    by: [bool; 3],
}

impl ContactResponse {
    fn apart(&self, mode: usize, n: usize, at: OperatingPoint, drive: &Drive) -> Apart {
        let ((d, dd), load) = (dynamic_stiffness(&self.structure, n, mode, at), drive.of(mode, n, at));
        let s2 = self.coupling[mode].powi(2);
        let w = along(self.row(mode), drive.force) + load.value;
        Apart { mode, d, dd, s2, rho2: d.norm_sqr() + s2, w, dw: load.by, by: drive.by }
    }

    /// Modal coordinate of the mode apart, from `v` and its derivatives.
    fn resonant(&self, apart: &Apart, v: &[Complex64], dv: &[Vec<Complex64>; 3]) -> (Complex64, [Complex64; 3]) {
        let (row, square) = (self.row(apart.mode), self.squares[apart.mode]);
        let &Apart { d, s2, rho2, w, .. } = apart;
        let eta = (d.conj() * w + along(row, v) / square * s2) / rho2;
        let mut d_eta = [Complex64::default(); 3];
        for (t, change) in d_eta.iter_mut().enumerate().filter(|(t, _)| apart.by[*t]) {
            let dd = apart.dd.get(t).copied().unwrap_or_default();
            let sum = dd.conj() * w + d.conj() * apart.dw[t] + along(row, &dv[t]) / square * s2;
            *change = sum / rho2 - eta * (2.0 * (d.conj() * dd).re / rho2);
        }
        (eta, d_eta)
    }

    /// Motions of any phase, with damping and load.
    fn evaluate_any(&self, n: usize, at: OperatingPoint, load: &Load, asked: Asked, block: &mut HarmonicBlock) {
        let (c, pole) = (self.size(), self.pole(n, at));
        let HarmonicBlock { x, force, g, residual, d_residual, kinetic, .. } = &mut *block;
        residual.copy_from_slice(x);
        let drive = Drive { force, load: load.has_harmonic(n).then_some(load), by: asked.by };
        self.take_static(n, at, &drive, residual, d_residual);
        g.iter_mut().zip(&self.residual).for_each(|(g, h)| g.re = *h);
        // Modes that move no contact answer to a load alone, which only their energy tells; a steady force leaves them
        // at rest.
        let all = n > 0 && asked.energy && drive.load.is_some();
        for k in (0..self.coupling.len()).filter(|&k| Some(k) != pole && (all || self.squares[k] > 0.0)) {
            let answer = self.answer(k, n, at, &drive);
            self.take(&answer, drive.by, residual, d_residual);
            let row = self.row(k);
            for (to, y) in g.chunks_exact_mut(c).zip(row) {
                let scaled = answer.inverse * y;
                to.iter_mut().zip(row).for_each(|(to, y)| *to += scaled * y);
            }
            if asked.energy {
                let mass = self.structure.inertia()[k];
                kinetic.add(mass, answer.eta, answer.d_eta);
                let weight = answer.eta.conj() * answer.inverse * mass;
                kinetic.by_force.iter_mut().zip(row).for_each(|(to, y)| *to += weight * y);
            }
        }
        let apart = pole.map(|mode| self.apart(mode, n, at, &drive));
        self.finish(apart, n, at, asked.energy, block);
    }

    /// Motions that are even in time, without damping and load.
    fn evaluate_even(&self, n: usize, at: OperatingPoint, modes: &mut ModeSums, block: &mut HarmonicBlock) {
        let (c, nu) = (self.size(), n as f64 * at.omega);
        let apart = modes.set(nu * nu, &block.force);
        if let (1, Some(apart)) = (c, apart) {
            return self.evaluate_scalars(n, at, apart, &modes.sums, block);
        }
        let (sums, slope) = (&modes.sums, -2.0 * n as f64 * nu);
        block.g.iter_mut().zip(&sums.g).for_each(|(to, g)| to.re = *g);
        for (i, row) in sums.g.chunks_exact(c).enumerate() {
            block.residual[i] = block.x[i] - row.iter().zip(&block.force).map(|(g, f)| f * g).sum::<Complex64>();
            block.d_residual[0][i].re = slope * sums.t[i];
            block.kinetic.by_force[i].re = sums.t[i];
        }
        (block.kinetic.value, block.kinetic.by[0]) = (sums.energy[0], -slope * sums.energy[1]);
        let drive = Drive { force: &block.force, load: None, by: [true, false, false] };
        let of_mode = apart.map(|(mode, _)| self.apart(mode, n, at, &drive));
        self.finish(of_mode, n, at, true, block);
        if apart.is_some_and(|(_, below)| below % 2 == 1) {
            block.l[..c].iter_mut().chain(&mut block.g[..c]).for_each(|v| *v = -*v);
            block.residual[0] = -block.residual[0];
            block.d_residual[0][0] = -block.d_residual[0][0];
        }
    }

    /// The same for one coordinate in a fraction of the instructions: `ρ r = D (x − G λ) − y² λ`.
    fn evaluate_scalars(
        &self,
        n: usize,
        at: OperatingPoint,
        (mode, below): (usize, usize),
        sums: &Sums,
        block: &mut HarmonicBlock,
    ) {
        let (n, nu, sign) = (n as f64, n as f64 * at.omega, if below % 2 == 1 { -1.0 } else { 1.0 });
        let (x, force, y, s2) = (block.x[0].re, block.force[0].re, self.rows[mode], self.coupling[mode].powi(2));
        let (g, t, [e, s], slope) = (sums.g[0], sums.t[0], sums.energy, -2.0 * n * nu);
        let d = self.structure.omega_squared()[mode] - nu * nu;
        let rho2 = d * d + s2;
        let factor = sign / rho2.sqrt();
        let (v, w, dv) = (x - g * force, y * force, slope * t);
        let (defect, by_d) = (d * v - y * w, d * slope / rho2);
        block.residual[0].re = defect * factor;
        block.d_residual[0][0].re = (slope * v + d * dv - defect * by_d) * factor;
        block.l[0].re = d * factor;
        block.g[0].re = (d * g + y * y) * factor;
        block.pole = Some((mode, rho2));
        block.sizes[0] = size_of_row(d.abs(), nu, rho2);
        let share = s2 / (y * rho2);
        let eta = d * w / rho2 + share * v;
        let d_eta = slope * w / rho2 + share * dv - 2.0 * eta * by_d;
        let (kinetic, half) = (&mut block.kinetic, 0.5 * nu * nu);
        kinetic.value = 0.5 * half * (e + eta * eta);
        kinetic.by[0] = 0.5 * n * nu * (e + eta * eta) + half * (eta * d_eta - slope * s);
        kinetic.by_x[0].re = half * eta * share;
        kinetic.by_force[0].re = half * (t + eta * (d * y / rho2 - share * g));
    }

    /// Residual, matrices and energy, where the block has `v`, its derivatives, `G` and the sums of the energy of all
    /// modes but the one apart.
    fn finish(&self, apart: Option<Apart>, n: usize, at: OperatingPoint, energy: bool, block: &mut HarmonicBlock) {
        let c = self.size();
        if let Some(apart) = apart.as_ref().filter(|_| energy) {
            self.add_energy(apart, block);
        }
        if energy {
            block.kinetic.times_speed(n, at.omega);
        }
        match apart {
            Some(apart) => self.take_apart(n as f64 * at.omega, &apart, block),
            None => (0..c).for_each(|i| block.l[i * c + i] = Complex64::ONE),
        }
    }

    /// Adds the mode apart to the sums of the energy: `∂η_p/∂x = s_p² y_pᵀ/(|y_p|² ρ²)`,
    /// `∂η_p/∂λ̂ = D̄_p y_pᵀ/ρ² − ∂η_p/∂x G`.
    fn add_energy(&self, apart: &Apart, block: &mut HarmonicBlock) {
        let (c, row, mass) = (self.size(), self.row(apart.mode), self.structure.inertia()[apart.mode]);
        let (eta, d_eta) = self.resonant(apart, &block.residual, &block.d_residual);
        let (weight, share) = (eta.conj() * mass, apart.s2 / (self.squares[apart.mode] * apart.rho2));
        let (by_x, by_force) = (weight * share, weight * apart.d.conj() / apart.rho2);
        for (i, y) in row.iter().enumerate() {
            let of_others = along(row, &block.g[i * c..(i + 1) * c]);
            block.kinetic.by_x[i] = by_x * y;
            block.kinetic.by_force[i] += by_force * y - by_x * of_others;
        }
        block.kinetic.add(mass, eta, d_eta);
    }

    /// The equations with one mode apart, from `v`, its derivatives and `G` of the others in the block.
    fn take_apart(&self, nu: f64, &Apart { mode, d, dd, rho2, w, dw, by, .. }: &Apart, block: &mut HarmonicBlock) {
        let (c, row, square, turn) = (self.size(), self.row(mode), self.squares[mode], &self.turns[mode]);
        let rho = rho2.sqrt();
        let factor = turn.length / rho;
        block.pole = Some((mode, rho2));
        block.sizes[0] = size_of_row(d.norm(), nu, rho2);
        let alpha = along(row, &block.residual) / square;
        let defect = d * alpha - w;
        turn.apply(&mut block.residual);
        block.residual[0] = defect * factor;
        for (t, dv) in block.d_residual.iter_mut().enumerate().filter(|(t, _)| by[*t]) {
            let (of_d, of_rho) = match dd.get(t) {
                Some(dd) => (dd * alpha, (d.conj() * dd).re / rho),
                None => (Complex64::default(), 0.0),
            };
            let d_alpha = along(row, dv) / square;
            turn.apply(dv);
            dv[0] = (of_d + d * d_alpha - dw[t] - defect * (of_rho / rho)) * factor;
        }
        // G of the other modes, and L = I, are turned in the same way.
        for j in 0..c {
            let column = |v: &[f64]| (0..c).map(|i| block.g[i * c + j] * v[i]).sum::<Complex64>();
            let (of_turn, of_mode) = (column(&turn.w) * turn.beta, column(row) / square);
            (1..c).for_each(|i| block.g[i * c + j] = of_turn * turn.w[i] - block.g[i * c + j]);
            block.g[j] = (d * of_mode + row[j]) * factor;
            (1..c).for_each(|i| {
                block.l[i * c + j].re = turn.beta * turn.w[j] * turn.w[i] - if i == j { 1.0 } else { 0.0 }
            });
            block.l[j] = d * (row[j] / square * factor);
        }
    }
}

/// Size of the row of the mode apart below which it is rounding.
const SMALLEST_ROW: f64 = 1e-9;

/// What is large for the first row of `L`, by which harmonics without contact are held: `D_p/ρ` itself, or what a
/// change of `ν²` by its own size makes of it where it vanishes, in resonance. Beside a contact that is much stiffer
/// than the structure both are small.
fn size_of_row(stiffness: f64, nu: f64, rho2: f64) -> f64 {
    ((stiffness + nu * nu) / rho2.sqrt()).clamp(SMALLEST_ROW, 1.0)
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

    fn apply(&self, v: &mut [Complex64]) {
        let along: Complex64 = self.w.iter().zip(&*v).map(|(w, v)| v * w).sum();
        v.iter_mut().zip(&self.w).for_each(|(v, w)| *v = along * (self.beta * w) - *v);
    }
}

use std::sync::Arc;

use nlmodes_linalg::max_norm;
use num_complex::Complex64;

use super::block::{Asked, HarmonicBlock, LinearResponse, ModalMotion, dynamic_stiffness};
use super::load::Load;
use super::operating_point::OperatingPoint;
use super::structure::ModalStructure;

/// The linear structure in its open modes, `x = η`: for many contacts, and for damping that couples modes.
///
/// ```text
/// r_k = (Σ_j D_kj η_j − ŷ_k − p_k)/ρ_k ,   ŷ = Yᵀ λ ,   ρ_k = √(|D_kk|² + s_k²)
/// ```
///
/// Modes that move no contact and are coupled to none are no unknowns: they answer by themselves, `η_k = p_k/D_k`.
pub(crate) struct ModalResponse {
    structure: Arc<ModalStructure>,
    /// The mode of each coordinate.
    active: Vec<usize>,
    coupling: Vec<f64>,
    largest_row: f64,
}

/// Least `s_k` over the largest.
const LEAST: f64 = 1e-9;

impl ModalResponse {
    pub fn new(structure: Arc<ModalStructure>) -> Self {
        let m = structure.n_modes();
        let coupled = !structure.damping().is_diagonal();
        let active: Vec<usize> = (0..m).filter(|&k| coupled || structure.moves_a_contact(k)).collect();
        let largest = max_norm((0..m).map(|k| structure.coupling(k)));
        let coupling = (0..m).map(|k| structure.coupling(k).max(LEAST * largest)).collect();
        let largest_row = max_norm((0..m).flat_map(|k| structure.rows().col(k).iter().copied()));
        Self { active, coupling, largest_row, structure }
    }
}

impl LinearResponse for ModalResponse {
    fn n_coordinates(&self) -> usize {
        self.active.len()
    }

    fn first_law(&self) -> usize {
        self.active.len()
    }

    fn gap_row(&self, i: usize, j: usize) -> f64 {
        self.structure.rows()[(i, self.active[j])]
    }

    fn of_mode(&self, k: usize) -> Vec<f64> {
        self.active.iter().map(|&j| f64::from(u8::from(j == k))).collect()
    }

    fn scale(&self, length: f64) -> f64 {
        length / self.largest_row.max(f64::MIN_POSITIVE)
    }

    fn evaluate(&mut self, n: usize, at: OperatingPoint, load: &Load, asked: Asked, block: &mut HarmonicBlock) {
        block.reset();
        let d = self.active.len();
        let damping = self.structure.damping();
        let nu = n as f64 * at.omega;
        for (row, &k) in self.active.iter().enumerate() {
            let (value, change) = dynamic_stiffness(&self.structure, n, k, at);
            if n == 0 && value == Complex64::default() && !self.structure.moves_a_contact(k) {
                // Nothing says where a rigid-body motion is that no contact feels: it is left where it was drawn.
                block.l[row * d + row] = Complex64::ONE;
                block.residual[row] = block.x[row];
                continue;
            }
            let rho = value.norm().hypot(self.coupling[k]);
            let p = load.modal(n, k, at);
            let x = &block.x;
            let mut sum = value * x[row] - block.force[row] - p.value;
            let mut by = [change[0] * x[row] - p.by[0], change[1] * x[row] - p.by[1], -p.by[2]];
            block.l[row * d + row] = value / rho;
            block.g[row * d + row] = Complex64::new(1.0 / rho, 0.0);
            if !damping.is_diagonal() {
                for (column, &j) in self.active.iter().enumerate().filter(|(_, j)| **j != k) {
                    let coupled = Complex64::new(0.0, nu * damping.entry(k, j));
                    sum += coupled * x[column];
                    by[0] += Complex64::new(0.0, n as f64 * damping.entry(k, j)) * x[column];
                    block.l[row * d + column] = coupled / rho;
                }
            }
            block.residual[row] = sum / rho;
            for t in 0..3 {
                let d_rho = if t < 2 { (value.conj() * change[t]).re / rho } else { 0.0 };
                block.d_residual[t][row] = (by[t] - sum * (d_rho / rho)) / rho;
            }
        }
        if asked.energy {
            let (motion, inertia) = (self.modal_motion(n, at, load, block, true), self.structure.inertia());
            for (k, mass) in inertia.iter().enumerate() {
                block.kinetic.add(*mass, motion.eta[k], [0, 1, 2].map(|t| motion.d_eta[t][k]));
            }
            let of_coordinate = self.active.iter().map(|&k| motion.eta[k].conj() * inertia[k]);
            block.kinetic.by_x.iter_mut().zip(of_coordinate).for_each(|(to, weight)| *to = weight);
            block.kinetic.times_speed(n, at.omega);
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
        let mut motion = ModalMotion::at_rest(self.structure.n_modes());
        self.active.iter().zip(&block.x).for_each(|(&k, x)| motion.eta[k] = *x);
        let alone = (0..motion.eta.len()).filter(|k| load.has_harmonic(n) && !self.active.contains(k));
        for k in alone {
            let (p, (d, dd)) = (load.modal(n, k, at), dynamic_stiffness(&self.structure, n, k, at));
            if p.value == Complex64::default() && p.by.iter().all(|by| *by == Complex64::default()) {
                continue;
            }
            let eta = p.value / d;
            motion.eta[k] = eta;
            for t in (0..3).filter(|_| derivatives) {
                let dd = if t < 2 { dd[t] } else { Complex64::default() };
                motion.d_eta[t][k] = (p.by[t] - eta * dd) / d;
            }
        }
        motion
    }

    fn pull(
        &self,
        _: usize,
        _: OperatingPoint,
        _: &HarmonicBlock,
        weights: &[Complex64],
    ) -> (Vec<Complex64>, Vec<Complex64>) {
        let by_x = self.active.iter().map(|&k| weights[k]).collect();
        (by_x, vec![Complex64::default(); self.active.len()])
    }

    fn pull_load(
        &self,
        n: usize,
        at: OperatingPoint,
        block: &HarmonicBlock,
        residual: &[Complex64],
        eta: &[Complex64],
    ) -> (Vec<Complex64>, Vec<Complex64>) {
        let alone = |k: usize| eta[k] / dynamic_stiffness(&self.structure, n, k, at).0;
        let mut of: Vec<Complex64> = (0..eta.len()).map(alone).collect();
        let d = self.active.len();
        for (row, &k) in self.active.iter().enumerate() {
            // `G` is `1/ρ` on its diagonal, and zero where a mode is left where it is.
            of[k] = -residual[row] * block.g[row * d + row];
        }
        (of, Vec::new())
    }
}

use std::sync::Arc;

use nlmodes_linalg::{Mat, add_product};
use num_complex::Complex64;

use super::block::{Asked, HarmonicBlock, LinearResponse, ModalMotion};
use super::load::Load;
use super::operating_point::OperatingPoint;
use crate::CondensedStructure;
use crate::condensed::Held;
use crate::energy::HeldEnergy;
use crate::transfer::Plane;

/// A structure with massless contact nodes, reduced to its fixed-interface modes. The coordinates are `b`, the positions
/// that the contact nodes would have without stops; they are at `q_N = b + K_NN⁻¹ W λ`.
///
/// ```text
/// A_n b_n − B_n q_N,n = 0            connectivity (14) through eq. (8), in a form without poles
/// L_n = A_n − B_n ,   G_n = B_n K_NN⁻¹
/// ```
///
/// `L_n` is small beside a contact node that is much stiffer than the structure, and is then no difference of large
/// numbers. A negative damping `ξ` has no meaning here but that of an unknown that a free phase takes, and that vanishes
/// on solutions: `ξ/ω_ref B_n db_n/dτ` is added.
pub(crate) struct HeldResponse {
    held: Arc<Held>,
    /// `W`, n_N × c.
    w: Mat<f64>,
    is_even: bool,
    /// `ω_ref`, rad/s.
    reference: f64,
    plane: Plane,
    energy: HeldEnergy,
    /// `b − q_N` of all coordinates.
    kept: Vec<Complex64>,
    /// Real or imaginary parts of `b` and `q_N`.
    b: Vec<f64>,
    q: Vec<f64>,
    /// `B K_NN⁻¹`.
    g: Vec<f64>,
}

impl HeldResponse {
    pub fn new(structure: &CondensedStructure, is_even: bool, reference: f64) -> Self {
        let n = structure.n_contact_dofs();
        Self {
            held: structure.held.clone(),
            w: structure.model.w().clone(),
            is_even,
            reference,
            plane: Plane::new(n),
            energy: HeldEnergy::new(n),
            kept: vec![Complex64::default(); n],
            b: vec![0.0; n],
            q: vec![0.0; n],
            g: vec![0.0; n * n],
        }
    }

    /// Residual, matrices and derivatives from the plane of harmonic `n`.
    fn connect(&self, n: usize, slope: f64, at: OperatingPoint, asked: Asked, block: &mut HarmonicBlock) {
        let (c, plane) = (self.kept.len(), &self.plane);
        let (turn, delta) = (Complex64::new(0.0, n as f64), at.xi / self.reference);
        for i in 0..c {
            let [mut value, mut by_nu2, mut turned, mut d_turned] = [Complex64::default(); 4];
            for (e, (x, kept)) in block.x.iter().zip(&self.kept).enumerate() {
                let [d, b, da, db] = [&plane.d, &plane.b, &plane.da, &plane.db].map(|m| m[i * c + e]);
                // A b − B q = (A − B) b + B (b − q)
                value += x * d + kept * b;
                by_nu2 += x * da - (x - kept) * db;
                block.l[i * c + e].re = d;
                if asked.by[1] {
                    turned += x * b;
                    d_turned += x * db;
                    block.l[i * c + e].im = n as f64 * delta * b;
                }
            }
            block.residual[i] = value + turn * turned * delta;
            block.d_residual[0][i] = (by_nu2 + turn * d_turned * delta) * slope;
            block.d_residual[1][i] = turn * turned / self.reference;
        }
    }

    /// Motions that are even in time of one coordinate, in a fraction of the instructions.
    fn evaluate_scalars(&mut self, n: usize, at: OperatingPoint, asked: Asked, block: &mut HarmonicBlock) {
        let Self { held, plane, energy, .. } = self;
        let nu = n as f64 * at.omega;
        let (nu2, slope, inverse) = (nu * nu, 2.0 * n as f64 * nu, held.sums.k_nn_inverse[0]);
        block.take_size();
        let (b, kept) = (block.x[0].re, -inverse * block.force[0].re);
        if n == 0 {
            plane.set_static(held);
        } else {
            plane.set(held, nu2);
        }
        let lift = if n == 0 && !held.lift.is_empty() { held.lift[0] } else { 0.0 };
        block.residual[0].re = plane.d[0] * b + plane.b[0] * kept - lift;
        block.d_residual[0][0].re = (plane.da[0] * b - plane.db[0] * (b - kept)) * slope;
        block.l[0].re = plane.d[0];
        block.g[0].re = plane.b[0] * inverse;
        block.sizes[0] = plane.size_of_row(0, nu2);
        if n > 0 && asked.energy {
            energy.set(held, plane, nu2, &[b], &[b - kept]);
            block.kinetic.value = energy.value;
            block.kinetic.by[0] = energy.d_nu2 * slope;
            block.kinetic.by_x[0].re = energy.d_b[0] + energy.d_q[0];
            block.kinetic.by_force[0].re = inverse * energy.d_q[0];
        }
    }

    /// The kinetic energy of harmonic `n`, of cosines and sines one after the other.
    fn add_energy(&mut self, nu2: f64, slope: f64, block: &mut HarmonicBlock) {
        let Self { held, plane, energy, kept, b, q, is_even, .. } = self;
        let c = kept.len();
        for is_sine in [false, true].into_iter().take(if *is_even { 1 } else { 2 }) {
            let part = |z: &Complex64| if is_sine { z.im } else { z.re };
            let unit = if is_sine { -Complex64::I } else { Complex64::ONE };
            for i in 0..c {
                b[i] = part(&block.x[i]);
                q[i] = b[i] - part(&kept[i]);
            }
            energy.set(held, plane, nu2, b, q);
            block.kinetic.value += energy.value;
            block.kinetic.by[0] += energy.d_nu2 * slope;
            for i in 0..c {
                block.kinetic.by_x[i] += unit * (energy.d_b[i] + energy.d_q[i]);
                let inverse = &held.sums.k_nn_inverse[i * c..(i + 1) * c];
                let by_force = inverse.iter().zip(&energy.d_q).map(|(k, by)| k * by).sum::<f64>();
                block.kinetic.by_force[i] += unit * by_force;
            }
        }
    }
}

impl LinearResponse for HeldResponse {
    fn n_coordinates(&self) -> usize {
        self.kept.len()
    }

    fn first_law(&self) -> usize {
        self.kept.len()
    }

    fn gap_row(&self, i: usize, j: usize) -> f64 {
        self.w[(j, i)]
    }

    /// Open modes are not known.
    fn of_mode(&self, _k: usize) -> Vec<f64> {
        vec![0.0; self.kept.len()]
    }

    fn scale(&self, length: f64) -> f64 {
        length
    }

    fn take_next_term(&mut self, with: bool) {
        self.plane.with_next_term = with;
    }

    fn evaluate(&mut self, n: usize, at: OperatingPoint, _load: &Load, asked: Asked, block: &mut HarmonicBlock) {
        if self.is_even && self.kept.len() == 1 {
            return self.evaluate_scalars(n, at, asked, block);
        }
        block.reset();
        let (c, nu, held) = (self.kept.len(), n as f64 * at.omega, &self.held);
        let (nu2, slope) = (nu * nu, 2.0 * n as f64 * nu);
        match n {
            0 => self.plane.set_static(held),
            _ => self.plane.set(held, nu2),
        }
        let inverse = &held.sums.k_nn_inverse;
        for (i, kept) in self.kept.iter_mut().enumerate() {
            let pressed = inverse[i * c..(i + 1) * c].iter().zip(&block.force).map(|(k, force)| force * *k);
            *kept = -pressed.sum::<Complex64>();
        }
        self.g.fill(0.0);
        add_product(1.0, &self.plane.b, inverse, &mut self.g, [c, c, c], c);
        block.g.iter_mut().zip(&self.g).for_each(|(to, g)| to.re = *g);
        for (i, size) in block.sizes.iter_mut().enumerate() {
            *size = self.plane.size_of_row(i, nu2);
        }
        self.connect(n, slope, at, asked, block);
        match n {
            0 => block.residual.iter_mut().zip(&self.held.lift).for_each(|(residual, lift)| residual.re -= lift),
            _ if asked.energy => self.add_energy(nu2, slope, block),
            _ => {}
        }
    }

    fn modal_motion(&self, _n: usize, _at: OperatingPoint, _load: &Load, _block: &HarmonicBlock) -> ModalMotion {
        ModalMotion::at_rest(0)
    }

    fn pull(
        &self,
        _n: usize,
        _at: OperatingPoint,
        _block: &HarmonicBlock,
        _weights: &[Complex64],
    ) -> (Vec<Complex64>, Vec<Complex64>) {
        let none = vec![Complex64::default(); self.kept.len()];
        (none.clone(), none)
    }
}

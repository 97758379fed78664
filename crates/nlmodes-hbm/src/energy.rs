use nlmodes_linalg::Mat;

use crate::CondensedStructure;
use crate::transfer::Plane;

/// Averaged kinetic energy `E_av = Σ_n ν²/4 Σ_k η_k,n²` of one real coefficient of one harmonic, and its derivatives.
///
/// Near the eigenfrequency of a held mode p, where `q_N,n → 0`, its coordinate follows from `b_n` and `q_N,n` together:
/// `η_p = −(δ g_p q + s_p g_p (b − F q)) / (δ² + s_p²)`, which needs neither to be resonant nor not to be.
pub(crate) struct KineticEnergy {
    pub value: f64,
    /// With respect to the n_N coefficients of `b` and of `q_N`.
    pub d_b: Vec<f64>,
    pub d_q: Vec<f64>,
    /// With respect to `ν²`.
    pub d_nu2: f64,
}

impl KineticEnergy {
    pub fn new(n: usize) -> Self {
        Self { value: 0.0, d_b: vec![0.0; n], d_q: vec![0.0; n], d_nu2: 0.0 }
    }

    pub fn set(&mut self, structure: &CondensedStructure, plane: &Plane, nu2: f64, b: &[f64], q: &[f64]) {
        self.value = 0.0;
        self.d_nu2 = 0.0;
        self.d_b.fill(0.0);
        self.d_q.fill(0.0);
        for (k, mode) in structure.modes.iter().enumerate() {
            let (eta, d_eta) = if plane.poles.contains(&k) {
                self.add_resonant(structure, plane, k, nu2, b, q)
            } else {
                let inverse = 1.0 / (mode.lambda - nu2);
                let eta = -inner(&mode.g, q) * inverse;
                let weight = -0.5 * nu2 * eta * inverse;
                self.d_q.iter_mut().zip(&mode.g).for_each(|(d, g)| *d += weight * g);
                (eta, eta * inverse)
            };
            self.value += 0.25 * nu2 * eta * eta;
            self.d_nu2 += 0.25 * eta * eta + 0.5 * nu2 * eta * d_eta;
        }
        self.add_residual_mass(&structure.residual.mass, nu2, q);
        if plane.with_next_term {
            self.add_next_term(&structure.residual.next, nu2, q);
        }
    }

    /// `ν⁴/2 qᵀ S q`, what follows in the series of the held modes that were not computed.
    fn add_next_term(&mut self, next: &Mat<f64>, nu2: f64, q: &[f64]) {
        for i in 0..q.len() {
            let row: f64 = (0..q.len()).map(|j| next[(i, j)] * q[j]).sum();
            self.value += 0.5 * nu2 * nu2 * q[i] * row;
            self.d_nu2 += nu2 * q[i] * row;
            self.d_q[i] += nu2 * nu2 * row;
        }
    }

    /// `ν²/4 qᵀ R q` of the held modes that were not computed.
    fn add_residual_mass(&mut self, mass: &Mat<f64>, nu2: f64, q: &[f64]) {
        for i in 0..q.len() {
            let inertia: f64 = (0..q.len()).map(|j| mass[(i, j)] * q[j]).sum();
            self.value += 0.25 * nu2 * q[i] * inertia;
            self.d_nu2 += 0.25 * q[i] * inertia;
            self.d_q[i] += 0.5 * nu2 * inertia;
        }
    }

    /// Gradient of the resonant coordinate; returns it and its derivative with respect to `ν²`.
    fn add_resonant(
        &mut self,
        structure: &CondensedStructure,
        plane: &Plane,
        p: usize,
        nu2: f64,
        b: &[f64],
        q: &[f64],
    ) -> (f64, f64) {
        let (mode, n) = (&structure.modes[p], q.len());
        let (delta, s) = (mode.lambda - nu2, mode.s);
        let denominator = delta * delta + s * s;
        let eta = resonant_coordinate(structure, plane, p, nu2, b, q);
        let g_f = |matrix: &[f64], j: usize| (0..n).map(|i| mode.g[i] * matrix[i * n + j]).sum::<f64>();
        let weight = 0.5 * nu2 * eta / denominator;
        let mut slope = 0.0;
        for (j, q) in q.iter().enumerate() {
            self.d_b[j] -= weight * s * mode.g[j];
            self.d_q[j] -= weight * (delta * mode.g[j] - s * g_f(&plane.f, j));
            slope += (mode.g[j] + s * g_f(&plane.df, j)) * q;
        }
        (eta, (slope + 2.0 * delta * eta) / denominator)
    }
}

/// Modal coordinates `η_k` of the held modes for one real coefficient.
pub(crate) fn held_coordinates(
    structure: &CondensedStructure,
    plane: &Plane,
    nu2: f64,
    b: &[f64],
    q: &[f64],
    eta: &mut [f64],
) {
    for (k, (mode, eta)) in structure.modes.iter().zip(eta).enumerate() {
        *eta = if plane.poles.contains(&k) {
            resonant_coordinate(structure, plane, k, nu2, b, q)
        } else {
            -inner(&mode.g, q) / (mode.lambda - nu2)
        };
    }
}

fn resonant_coordinate(structure: &CondensedStructure, plane: &Plane, p: usize, nu2: f64, b: &[f64], q: &[f64]) -> f64 {
    let (mode, n) = (&structure.modes[p], q.len());
    let (delta, s) = (mode.lambda - nu2, mode.s);
    let from_b: f64 = (0..n).map(|i| mode.g[i] * (b[i] - inner(&plane.f[i * n..(i + 1) * n], q))).sum();
    -(delta * inner(&mode.g, q) + s * from_b) / (delta * delta + s * s)
}

pub(crate) fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

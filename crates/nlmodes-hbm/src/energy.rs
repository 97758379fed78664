use nlmodes_linalg::Mat;

use crate::condensed::Held;
use crate::held_sums::Sums;
use crate::transfer::Plane;

/// Averaged kinetic energy `E_av = Σ_n ν²/4 Σ_k η_k,n²` of one real coefficient of one harmonic, and its derivatives.
///
/// Near the eigenfrequency of a held mode p, where `q_N,n → 0`, its coordinate follows from `b_n` and `q_N,n` together:
/// `η_p = −(δ g_p q + s_p g_p (b − F q)) / (δ² + s_p²)`, which needs neither to be resonant nor not to be.
pub(crate) struct HeldEnergy {
    pub value: f64,
    /// With respect to the n_N coefficients of `b` and of `q_N`.
    pub d_b: Vec<f64>,
    pub d_q: Vec<f64>,
    /// With respect to `ν²`.
    pub d_nu2: f64,
}

impl HeldEnergy {
    pub fn new(n: usize) -> Self {
        Self { value: 0.0, d_b: vec![0.0; n], d_q: vec![0.0; n], d_nu2: 0.0 }
    }

    pub fn set(&mut self, held: &Held, plane: &Plane, nu2: f64, b: &[f64], q: &[f64]) {
        if let ([b], [q], 1, false) = (b, q, plane.poles.len(), plane.with_next_term) {
            return self.set_scalars(held, plane, nu2, *b, *q);
        }
        self.value = 0.0;
        self.d_nu2 = 0.0;
        self.d_b.fill(0.0);
        self.d_q.fill(0.0);
        for p in plane.poles.clone() {
            let (eta, d_eta) = self.add_resonant(held, plane, p, nu2, b, q);
            self.value += 0.25 * nu2 * eta * eta;
            self.d_nu2 += 0.25 * eta * eta + 0.5 * nu2 * eta * d_eta;
        }
        self.add_others(&plane.sums, &held.residual.mass, nu2, q);
        if plane.with_next_term {
            self.add_next_term(&held.residual.next, nu2, q);
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

    /// The same for one contact degree of freedom.
    fn set_scalars(&mut self, held: &Held, plane: &Plane, nu2: f64, b: f64, q: f64) {
        let mode = &held.modes[plane.poles.start];
        let (g, s, delta, f, df) = (mode.g[0], mode.s, mode.lambda - nu2, plane.f[0], plane.df[0]);
        let inverse = 1.0 / (delta * delta + s * s);
        let eta = -g * (delta * q + s * (b - f * q)) * inverse;
        let d_eta = (g * (1.0 + s * df) * q + 2.0 * delta * eta) * inverse;
        let inertia = (held.residual.mass[(0, 0)] + plane.sums.s2[0]) * q;
        let weight = 0.5 * nu2 * eta * g * inverse;
        self.value = 0.25 * nu2 * (eta * eta + q * inertia);
        self.d_nu2 = 0.25 * (eta * eta + q * inertia) + 0.5 * nu2 * (eta * d_eta + q * plane.sums.s3[0] * q);
        self.d_b[0] = -weight * s;
        self.d_q[0] = 0.5 * nu2 * inertia - weight * (delta - s * f);
    }

    /// `ν²/4 qᵀ (S_2 + R) q`: of the modes that are not kept apart, and of those that were not computed.
    /// `dS_2/dν² = 2 S_3`.
    fn add_others(&mut self, sums: &Sums, mass: &Mat<f64>, nu2: f64, q: &[f64]) {
        let n = q.len();
        for i in 0..n {
            let inertia: f64 = (0..n).map(|j| (mass[(i, j)] + sums.s2[i * n + j]) * q[j]).sum();
            let slope = inner(&sums.s3[i * n..(i + 1) * n], q);
            self.value += 0.25 * nu2 * q[i] * inertia;
            self.d_nu2 += 0.25 * q[i] * inertia + 0.5 * nu2 * q[i] * slope;
            self.d_q[i] += 0.5 * nu2 * inertia;
        }
    }

    /// Gradient of the resonant coordinate; returns it and its derivative with respect to `ν²`.
    fn add_resonant(&mut self, held: &Held, plane: &Plane, p: usize, nu2: f64, b: &[f64], q: &[f64]) -> (f64, f64) {
        let (mode, n) = (&held.modes[p], q.len());
        let (delta, s) = (mode.lambda - nu2, mode.s);
        let denominator = delta * delta + s * s;
        let eta = resonant_coordinate(held, plane, p, nu2, b, q);
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
pub(crate) fn held_coordinates(held: &Held, plane: &Plane, nu2: f64, b: &[f64], q: &[f64], eta: &mut [f64]) {
    held.sums.couple(q, eta);
    eta.iter_mut().zip(&held.sums.lambda).for_each(|(eta, lambda)| *eta /= nu2 - lambda);
    for p in plane.poles.clone() {
        eta[p] = resonant_coordinate(held, plane, p, nu2, b, q);
    }
}

fn resonant_coordinate(held: &Held, plane: &Plane, p: usize, nu2: f64, b: &[f64], q: &[f64]) -> f64 {
    let (mode, n) = (&held.modes[p], q.len());
    let (delta, s) = (mode.lambda - nu2, mode.s);
    let from_b: f64 = (0..n).map(|i| mode.g[i] * (b[i] - inner(&plane.f[i * n..(i + 1) * n], q))).sum();
    -(delta * inner(&mode.g, q) + s * from_b) / (delta * delta + s * s)
}

pub(crate) fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

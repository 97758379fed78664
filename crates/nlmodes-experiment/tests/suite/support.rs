//! Records with known answers.

#![allow(dead_code)]

// The path is the same for the tests and for the example that shares this file.
#[path = "support/autoresonance.rs"]
pub mod autoresonance;

use nlmodes_experiment::records::{Channel, Quantity, Record, Role};
use nlmodes_modal::LinearModes;
use num_complex::Complex64;

/// Normal random numbers from a seed.
#[derive(Debug)]
pub struct Normal(u64);

impl Normal {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    fn uniform(&mut self) -> f64 {
        // xorshift64*
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn draw(&mut self) -> f64 {
        let (a, b) = (self.uniform().max(1e-300), self.uniform());
        (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    }
}

/// `Re Σ (inω)^order q_n e^{inωt}` at the sampling instants.
pub fn sampled(q: &[Complex64], omega: f64, order: u32, rate: f64, n: usize) -> Vec<f64> {
    let at = |t: f64| -> f64 {
        let term = |(k, q): (usize, &Complex64)| {
            (Complex64::new(0.0, k as f64 * omega).powu(order) * q * Complex64::cis(k as f64 * omega * t)).re
        };
        q.iter().enumerate().map(term).sum()
    };
    (0..n).map(|j| at(j as f64 / rate)).collect()
}

/// Three modes of a beam-like structure at four positions.
pub fn modes() -> LinearModes {
    let shapes =
        [vec![0.031, -0.174, 0.433], vec![0.60, -1.33, 0.17], vec![1.26, -0.13, -0.98], vec![1.85, 1.84, 1.83]];
    let omegas = [40.1, 268.62, 758.26].map(|f| std::f64::consts::TAU * f);
    LinearModes::new(&POSITIONS, &omegas, &[0.0019, 0.0076, 0.0005], &shapes).unwrap()
}

pub const POSITIONS: [f64; 4] = [0.063, 0.306, 0.483, 0.63];

/// A periodic motion in modal coordinates, and the force at the first position.
#[derive(Debug, Clone)]
pub struct Motion {
    pub omega: f64,
    pub eta: Vec<Vec<Complex64>>,
    pub force: Vec<Complex64>,
}

impl Motion {
    /// Harmonics that decay as those of an impact do; the force in quadrature to mode 1.
    pub fn example(omega: f64, harmonics: usize) -> Self {
        let size = |k: usize, n: usize| match (k, n) {
            (_, 0) => -1e-6,
            (0, 1) => 5.6e-4,
            (_, n) => 3e-5 / (n as f64).powf(1.5) / (1.0 + k as f64),
        };
        let term = |k: usize, n: usize| {
            Complex64::from_polar(size(k, n), if n == 0 { 0.0 } else { 0.05 * (n + 2 * k) as f64 - 0.05 })
        };
        let eta = (0..3).map(|k| (0..=harmonics).map(|n| term(k, n)).collect()).collect();
        let mut force: Vec<Complex64> =
            (0..=harmonics).map(|n| Complex64::from_polar(0.3 / (n.max(1) as f64), 0.3 * n as f64)).collect();
        force[0] = 0.2.into();
        Self { omega, eta, force }.in_phase_resonance(6.7)
    }

    /// The fundamental of the force a quarter of a period ahead of the displacement at the drive point.
    pub fn in_phase_resonance(mut self, force: f64) -> Self {
        self.force[1] = Complex64::from_polar(force, self.at(0)[1].arg() + std::f64::consts::FRAC_PI_2);
        self
    }

    /// Displacement at a position.
    pub fn at(&self, d: usize) -> Vec<Complex64> {
        let modes = modes();
        let sum = |n: usize| (0..3).map(|k| self.eta[k][n] * modes.shape(d, k)).sum();
        (0..self.force.len()).map(sum).collect()
    }

    /// Force, displacement and velocity at the drive point and the tip, accelerations between, with relative noise.
    pub fn record(&self, rate: f64, n: usize, noise: f64, seed: u64) -> Record {
        use Quantity::{Acceleration, Displacement, Force, Velocity};
        let mut normal = Normal::new(seed);
        let mut record = Record::new("made", rate);
        let mut add = |name: &str, quantity, role, d: usize, q: &[Complex64], order| {
            let mut samples = sampled(q, self.omega, order, rate, n);
            let rms = (samples.iter().map(|x| x * x).sum::<f64>() / n as f64).sqrt();
            samples.iter_mut().for_each(|x| *x += noise * rms * normal.draw());
            record.channels.push(Channel::new(name, quantity, role, Some(POSITIONS[d])));
            record.samples.push(samples);
        };
        add("force", Force, Role::Excitation, 0, &self.force, 0);
        add("x_drive", Displacement, Role::DrivePoint, 0, &self.at(0), 0);
        add("v_drive", Velocity, Role::DrivePoint, 0, &self.at(0), 1);
        add("a_1", Acceleration, Role::Response, 1, &self.at(1), 2);
        add("a_2", Acceleration, Role::Response, 2, &self.at(2), 2);
        add("x_tip", Displacement, Role::Response, 3, &self.at(3), 0);
        record
    }
}

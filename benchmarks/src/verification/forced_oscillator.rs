//! The forced bilinear oscillator in arcs: `m ẍ + c ẋ + k x + k_s max(x − g, 0) = F cos Ωt`, one contact a period.

use std::f64::consts::{FRAC_PI_2, TAU};

use num_complex::Complex64;

use super::tools::{integral, newton};
use crate::Failure;

/// The oscillator and its force.
#[derive(Debug, Clone, Copy)]
pub struct ForcedOscillator {
    pub m: f64,
    pub c: f64,
    pub k: f64,
    pub k_s: f64,
    pub gap: f64,
    pub force: f64,
}

/// A response, to begin with or exact.
#[derive(Debug, Clone, Copy)]
pub struct Response {
    pub omega: f64,
    /// Amplitude of the fundamental.
    pub amplitude: f64,
    /// By how much it lags the force, rad.
    pub lag: f64,
    /// Share of the period in contact.
    pub share: f64,
    /// The multiplier of largest magnitude, imaginary part not negative.
    pub multiplier: Complex64,
}

impl ForcedOscillator {
    /// Displacement and velocity after `t` of an arc that begins at the time `from`.
    fn after(&self, [x, v]: [f64; 2], from: f64, t: f64, closed: bool, omega: f64) -> [f64; 2] {
        let (k, rest) = if closed {
            let k = self.k + self.k_s;
            (k, self.k_s * self.gap / k)
        } else {
            (self.k, 0.0)
        };
        let steady = self.force / Complex64::new(k - self.m * omega * omega, omega * self.c);
        let at = |t: f64| {
            let q = steady * Complex64::cis(omega * t);
            [rest + q.re, (q * Complex64::new(0.0, omega)).re]
        };
        let ([x0, v0], [x1, v1]) = (at(from), at(from + t));
        let [[a, b], [c, d]] = self.exponential(k, t);
        [x1 + a * (x - x0) + b * (v - v0), v1 + c * (x - x0) + d * (v - v0)]
    }

    fn exponential(&self, k: f64, t: f64) -> [[f64; 2]; 2] {
        let decay = 0.5 * self.c / self.m;
        let w = (k / self.m - decay * decay).sqrt();
        let (s, c) = (w * t).sin_cos();
        let e = (-decay * t).exp();
        [[e * (c + decay / w * s), e * s / w], [-e * s * k / (self.m * w), e * (c - decay / w * s)]]
    }

    /// The exact response next to `guess`, at its frequency or where it lags by a quarter of a turn.
    pub fn near(&self, guess: Response, phase_resonance: bool) -> Result<Response, Failure> {
        let period = TAU / guess.omega;
        let length = guess.share * period;
        let speed = guess.amplitude * guess.omega * (0.5 * guess.omega * length).sin();
        let mut start = vec![guess.lag / guess.omega - 0.5 * length, speed, length];
        start.extend(phase_resonance.then_some(guess.omega));
        let parts = |z: &[f64]| {
            let omega = if phase_resonance { z[3] } else { guess.omega };
            let leaving = self.after([self.gap, z[1]], z[0], z[2], true, omega);
            (omega, leaving, self.after(leaving, z[0] + z[2], TAU / omega - z[2], false, omega))
        };
        let fundamental = |z: &[f64]| {
            let (omega, leaving, _) = parts(z);
            let arc = |start: [f64; 2], from: f64, length: f64, closed: bool| {
                let x = |t: f64| self.after(start, from, t, closed, omega)[0];
                let part = |of: fn(f64) -> f64| integral(|t| x(t) * of(omega * (from + t)), 0.0, length, 400);
                Complex64::new(part(f64::cos), -part(f64::sin))
            };
            let period = TAU / omega;
            let sum = arc([self.gap, z[1]], z[0], z[2], true) + arc(leaving, z[0] + z[2], period - z[2], false);
            sum * (2.0 / period)
        };
        let defects = |z: &[f64]| {
            let (omega, leaving, end) = parts(z);
            let mut defects = vec![leaving[0] - self.gap, end[0] - self.gap, (end[1] - z[1]) / omega];
            defects.extend(phase_resonance.then(|| -fundamental(z).arg() - FRAC_PI_2));
            defects
        };
        let z = newton(defects, &start)?;
        let (omega, _, _) = parts(&z);
        let first = fundamental(&z);
        let [closed, open] = [(self.k + self.k_s, z[2]), (self.k, TAU / omega - z[2])];
        let [a, b] = [self.exponential(closed.0, closed.1), self.exponential(open.0, open.1)];
        let product = |i: usize, j: usize| b[i][0] * a[0][j] + b[i][1] * a[1][j];
        let (trace, det) =
            (product(0, 0) + product(1, 1), product(0, 0) * product(1, 1) - product(0, 1) * product(1, 0));
        let half = Complex64::new(0.25 * trace * trace - det, 0.0).sqrt();
        let multiplier = 0.5 * trace + half * trace.signum();
        let multiplier = Complex64::new(multiplier.re, multiplier.im.abs());
        Ok(Response { omega, amplitude: first.norm(), lag: -first.arg(), share: z[2] * omega / TAU, multiplier })
    }
}

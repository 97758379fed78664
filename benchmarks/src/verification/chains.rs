//! Chains of masses that hit a rigid stop once a period: nonsmooth modes in closed form.

use std::f64::consts::{PI, TAU};

use nlmodes::model::{Contact, Side};
use nlmodes::timestep::{Shooting, ShootingScales};

use super::Check;
use super::time::{dynamics, impulse};
use super::tools::{slope, springs};
use crate::Failure;

/// `n` masses of 1 kg on springs of 1 N/m behind a wall, the last of which hits a rigid stop 1 m away once a period
/// without loss.
struct Impacts {
    period: f64,
    /// Momentum of an impact, N s.
    impulse: f64,
    /// Averaged kinetic energy, J.
    kinetic: f64,
    /// Displacements at the instant of the impact.
    positions: Vec<f64>,
}

impl Impacts {
    /// The motion with this share of the period of the first linear mode.
    fn new(n: usize, share: f64) -> Self {
        let angle = |k: usize| (2 * k + 1) as f64 * PI / (2 * n + 1) as f64;
        let omega: Vec<f64> = (0..n).map(|k| 2.0 * (0.5 * angle(k)).sin()).collect();
        let shape = |j: usize, k: usize| (4.0 / (2 * n + 1) as f64).sqrt() * (angle(k) * (j + 1) as f64).sin();
        let period = share * TAU / omega[0];
        let turn: Vec<f64> = omega.iter().map(|omega| 0.5 * omega * period).collect();
        let last = |k: usize| shape(n - 1, k);
        let impulse = -1.0 / (0..n).map(|k| last(k).powi(2) / (2.0 * omega[k] * turn[k].tan())).sum::<f64>();
        let amplitude: Vec<f64> = (0..n).map(|k| -impulse * last(k) / (2.0 * omega[k] * turn[k].sin())).collect();
        let energy =
            |k: usize| 0.25 * (amplitude[k] * omega[k]).powi(2) * (1.0 - (2.0 * turn[k]).sin() / (2.0 * turn[k]));
        let position = |j: usize| (0..n).map(|k| shape(j, k) * amplitude[k] * turn[k].cos()).sum();
        Self { period, impulse, kinetic: (0..n).map(energy).sum(), positions: (0..n).map(position).collect() }
    }

    /// Frequency and impulse with the same averaged kinetic energy before a stop of this stiffness, N/m, by shooting.
    fn before(&self, stiffness: f64) -> Result<[f64; 2], Failure> {
        let (n, fast) = (self.positions.len(), stiffness.sqrt());
        let connections: Vec<(usize, usize, f64)> = (0..n).map(|j| (j.saturating_sub(1), j, 1.0)).collect();
        let stop = Contact::elastic(n - 1, Side::Positive, 1.0, stiffness);
        let dynamics = dynamics(&springs(&vec![1.0; n], &connections, vec![stop])?, true)?;
        // In the middle of the contact, which takes half an oscillation of the last mass on the stop.
        let mut middle = self.positions.clone();
        middle[n - 1] += 0.5 * self.impulse / fast;
        let state = dynamics.state(&middle, &vec![0.0; n])?;
        let omega = TAU / (self.period + PI / fast);
        let mut shooting = Shooting::new(dynamics, ShootingScales { omega, energy: self.kinetic })?;
        let x = shooting.unknowns(&state, omega);
        let motion = shooting.motion_near(&x, 0.0)?;
        Ok([motion.omega / TAU, impulse(&motion.trajectory)])
    }
}

/// What `values` at `1, ½, ¼, …` tend to at zero, by a polynomial through all of them (Neville).
fn at_zero(mut values: Vec<f64>) -> f64 {
    for order in 1..values.len() {
        let factor = 2.0_f64.powi(i32::try_from(order).unwrap_or(i32::MAX));
        (order..values.len()).rev().for_each(|i| values[i] += (values[i] - values[i - 1]) / (factor - 1.0));
    }
    values.pop().unwrap_or(f64::NAN)
}

/// Stops of growing stiffness beside the rigid one, for these shares of the linear period.
pub fn chain(n: usize, shares: &[f64]) -> Result<Vec<Check>, Failure> {
    let mut checks = Vec::new();
    for &share in shares {
        let exact = Impacts::new(n, share);
        let stiffness = [1e4, 4e4, 1.6e5, 6.4e5, 2.56e6];
        let found = stiffness.map(|k| exact.before(k)).into_iter().collect::<Result<Vec<_>, Failure>>()?;
        let [frequency, impulse] = [0, 1].map(|i| found.iter().map(|pair| pair[i]).collect::<Vec<f64>>());
        let reference = 1.0 / exact.period;
        let off: Vec<(f64, f64)> = stiffness.iter().zip(&frequency).map(|(k, f)| (*k, f - reference)).collect();
        let why = "the fifth power of the duration of the contact, 0.01 to 0.002 of the period";
        checks.push(Check::order(
            format!("f over the compliance, {share} T₁"),
            -slope(&off),
            0.5,
            0.05,
            "the next term, of order one",
        ));
        checks.push(Check::relative(
            format!("f for a rigid stop, {share} T₁, Hz"),
            at_zero(frequency),
            reference,
            1e-7,
            why,
        ));
        checks.push(Check::relative(
            format!("impulse for a rigid stop, {share} T₁, N s"),
            at_zero(impulse),
            exact.impulse,
            1e-6,
            why,
        ));
    }
    Ok(checks)
}

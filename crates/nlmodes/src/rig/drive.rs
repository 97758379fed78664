use nlmodes_experiment::phase_loop::MAX_HARMONICS;
use num_complex::Complex64;

use crate::rig::RigError;
use crate::rig::propagator::{DEGREE, Input};

/// Largest angle of the drive in one integration step, rad: the error of the cosine series is then below 1e-7.
const LARGEST_ANGLE: f64 = 0.5;

/// The drive over one sampling interval: `Re Σ U_n(t) e^{in(φ + ω t)}` with amplitudes that change linearly.
///
/// Harmonic, without a zero-order hold, which would lag by half a sampling interval, 0.36 degrees at 20 kHz and 40 Hz.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Complex amplitudes of the harmonics 1, 2 … at the beginning and at the end, N or V.
    pub amplitudes: [[Complex64; MAX_HARMONICS]; 2],
    /// Phase of the fundamental at the beginning, rad.
    pub phase: f64,
    /// Angular frequency of the fundamental, rad/s.
    pub omega: f64,
}

impl Drive {
    /// No drive.
    pub const OFF: Self = Self { amplitudes: [[Complex64::ZERO; MAX_HARMONICS]; 2], phase: 0.0, omega: 0.0 };

    /// `A(t) cos(φ + ω t)`, with this amplitude at the beginning and at the end.
    pub fn sine(amplitude: [f64; 2], phase: f64, omega: f64) -> Self {
        let mut drive = Self { phase, omega, ..Self::OFF };
        drive.amplitudes.iter_mut().zip(amplitude).for_each(|(all, first)| all[0] = first.into());
        drive
    }

    /// Its highest harmonic, at least one.
    fn highest(&self) -> usize {
        let is_there = |n: &usize| self.amplitudes.iter().any(|at| at[n - 1] != Complex64::ZERO);
        (2..=MAX_HARMONICS).rev().find(is_there).unwrap_or(1)
    }

    /// Powers of time over the part of the interval from `start` to `end` (fractions of its length of `interval`
    /// seconds).
    pub(crate) fn polynomial(&self, start: f64, end: f64, interval: f64) -> Result<Input, RigError> {
        let highest = self.highest();
        let angle = highest as f64 * self.omega * interval * (end - start);
        if angle.abs() > LARGEST_ANGLE || !angle.is_finite() {
            return Err(RigError::DriveTooFast { angle, limit: LARGEST_ANGLE });
        }
        let mut input = [0.0; DEGREE + 1];
        for n in 1..=highest {
            let [from, to] = self.amplitudes.map(|at| at[n - 1]);
            let at = |share: f64| from + (to - from) * share;
            let (first, slope) = (at(start), at(end) - at(start));
            let omega = n as f64 * self.omega;
            let mut term = Complex64::cis(n as f64 * self.phase + omega * interval * start);
            let mut before = Complex64::ZERO;
            for (k, value) in input.iter_mut().enumerate() {
                *value += (first * term + slope * before).re;
                before = term;
                term *= Complex64::new(0.0, omega * interval * (end - start) / (k + 1) as f64);
            }
        }
        Ok(input)
    }

    /// The drive and its first two time derivatives at the end of an interval of this length, s.
    pub(crate) fn at_end(&self, interval: f64) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for n in 1..=self.highest() {
            let [from, to] = self.amplitudes.map(|at| at[n - 1]);
            let (rate, turn) = ((to - from) / interval, Complex64::new(0.0, n as f64 * self.omega));
            let wave = Complex64::cis(n as f64 * (self.phase + self.omega * interval));
            let derivatives = [to, rate + to * turn, (rate * 2.0 + to * turn) * turn];
            sum.iter_mut().zip(derivatives).for_each(|(sum, value)| *sum += (value * wave).re);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomial_and_derivatives_are_those_of_the_harmonics() {
        let mut drive = Drive::sine([1.0, 1.3], 0.4, 260.0);
        drive.amplitudes[0][2] = Complex64::new(0.3, -0.2);
        drive.amplitudes[1][2] = Complex64::new(0.5, 0.1);
        let interval = 1e-4;
        let value = |t: f64| {
            let of = |n: usize| {
                let [from, to] = drive.amplitudes.map(|at| at[n - 1]);
                ((from + (to - from) * (t / interval)) * Complex64::cis(n as f64 * (0.4 + 260.0 * t))).re
            };
            of(1) + of(3)
        };
        let input = drive.polynomial(0.25, 0.75, interval).unwrap();
        for share in [0.0, 0.3, 1.0] {
            let sum: f64 = input.iter().enumerate().map(|(k, c)| c * f64::powi(share, k as i32)).sum();
            assert!((sum - value((0.25 + 0.5 * share) * interval)).abs() < 1e-13, "{sum}");
        }
        let [now, first, second] = drive.at_end(interval);
        let step = 1e-6;
        let [before, after] = [-step, step].map(|d| value(interval + d));
        assert!((now - value(interval)).abs() < 1e-13);
        assert!((first - (after - before) / (2.0 * step)).abs() < 1e-5 * first.abs(), "{first}");
        let differences = (after - 2.0 * now + before) / (step * step);
        assert!((second - differences).abs() < 1e-3 * second.abs(), "{second} {differences}");
    }

    #[test]
    fn the_highest_harmonic_is_the_one_that_is_too_fast() {
        let mut drive = Drive::sine([1.0; 2], 0.0, 2000.0);
        assert!(drive.polynomial(0.0, 1.0, 1e-4).is_ok());
        drive.amplitudes[1][4] = 1e-3.into();
        let refused = drive.polynomial(0.0, 1.0, 1e-4);
        assert!(matches!(refused, Err(RigError::DriveTooFast { angle, .. }) if (angle - 1.0).abs() < 1e-12));
    }
}

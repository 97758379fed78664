use num_complex::Complex64;

use crate::RigError;
use crate::propagator::{DEGREE, Input};

/// Largest angle of the drive in one integration step, rad: the series of the cosine then errs by less than 1e-7.
const LARGEST_ANGLE: f64 = 0.5;

/// The drive over one sampling interval: `A(t) cos(φ + ω t)` with an amplitude that changes linearly.
///
/// Harmonic, not held: a held drive would lag by half a sampling interval, which at 20 kHz and 40 Hz is 0.36 degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Amplitude at the beginning and at the end, N or V.
    pub amplitude: [f64; 2],
    /// Phase at the beginning, rad.
    pub phase: f64,
    /// Angular frequency, rad/s.
    pub omega: f64,
}

impl Drive {
    /// No drive.
    pub const OFF: Self = Self { amplitude: [0.0; 2], phase: 0.0, omega: 0.0 };

    /// Powers of time over the part of the interval from `start` to `end` (shares of it, which is `interval` seconds long).
    pub(crate) fn polynomial(&self, start: f64, end: f64, interval: f64) -> Result<Input, RigError> {
        let angle = self.omega * interval * (end - start);
        if angle.abs() > LARGEST_ANGLE || !angle.is_finite() {
            return Err(RigError::DriveTooFast { angle, limit: LARGEST_ANGLE });
        }
        let at = |share: f64| self.amplitude[0] + share * (self.amplitude[1] - self.amplitude[0]);
        let (first, slope) = (at(start), at(end) - at(start));
        let mut term = Complex64::cis(self.phase + self.omega * interval * start);
        let (mut input, mut before) = ([0.0; DEGREE + 1], 0.0);
        for (k, value) in input.iter_mut().enumerate() {
            *value = first * term.re + slope * before;
            before = term.re;
            term *= Complex64::new(0.0, angle / (k + 1) as f64);
        }
        Ok(input)
    }

    /// The drive and its first two time derivatives at the end of an interval of this length, s.
    pub(crate) fn at_end(&self, interval: f64) -> [f64; 3] {
        let rate = (self.amplitude[1] - self.amplitude[0]) / interval;
        let (sin, cos) = (self.phase + self.omega * interval).sin_cos();
        let (a, ω) = (self.amplitude[1], self.omega);
        [a * cos, rate * cos - a * ω * sin, -2.0 * rate * ω * sin - a * ω * ω * cos]
    }
}

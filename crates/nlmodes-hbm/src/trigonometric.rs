use num_complex::Complex64;

/// A real trigonometric polynomial `f(τ) = Re Σ z_n e^{inτ}`.
#[derive(Debug, Clone, Default)]
pub(crate) struct Trigonometric {
    pub z: Vec<Complex64>,
}

impl Trigonometric {
    /// Value, first and second derivative at `tau`.
    pub fn evaluate(&self, tau: f64) -> [f64; 3] {
        evaluate(&self.z, tau)
    }

    /// Bounds of the function and of its first three derivatives.
    pub fn bounds(&self) -> [f64; 4] {
        let mut bounds = [0.0; 4];
        for (n, z) in self.z.iter().enumerate() {
            let (n, mut bound) = (n as f64, magnitude(z));
            for sum in &mut bounds {
                *sum += bound;
                bound *= n;
            }
        }
        bounds
    }

    /// Value and derivatives at `tau`.
    pub fn at(&self, tau: f64) -> Instant {
        Instant { tau, f: self.evaluate(tau) }
    }

    /// The zero between two instants at which the function has different signs; a value up to `rounding` is one, for no
    /// further step makes it any better.
    ///
    /// From where the cubic through both ends with their slopes puts it, by Halley's method, kept in the bracket by
    /// bisection.
    pub fn root(&self, rounding: f64, low: Instant, high: Instant) -> f64 {
        let falls = low.f[0] >= 0.0;
        let mut tau = expected_root(0, &low, &high);
        let (mut low, mut high) = (low.tau, high.tau);
        for _ in 0..MOST_STEPS {
            let f = self.evaluate(tau);
            if f[0].abs() <= rounding {
                return tau;
            }
            if (f[0] > 0.0) == falls {
                low = tau
            } else {
                high = tau
            }
            let newton = -f[0] / f[1];
            // Curvature of the function over its slope.
            let bend = f[2] / f[1];
            let expected = tau + newton / (1.0 + 0.5 * newton * bend).max(0.5);
            let is_within = expected > low && expected < high;
            let next = if is_within { expected } else { 0.5 * (low + high) };
            let step = (next - tau).abs();
            // What Halley's method leaves is the third power of its step, times the square of what the function and its
            // harmonics bend by.
            let left = if is_within { step * (step * bend.abs().max(self.z.len() as f64)).powi(2) } else { step };
            if left <= 4.0 * f64::EPSILON * tau.abs().max(f64::EPSILON) {
                return next;
            }
            tau = next;
        }
        tau
    }

    /// Where the function is lowest or highest between two instants at which its slope has different signs, or a place
    /// on the way there that is `enough`.
    ///
    /// By Newton's method for the slope, kept in the bracket by bisection, until no step would change the value by more
    /// than `rounding`; the instant itself is known to the root of that.
    pub fn turn(&self, rounding: f64, low: Instant, high: Instant, enough: impl Fn(f64) -> bool) -> Instant {
        let falls = low.f[1] >= 0.0;
        let mut at = self.at(expected_root(1, &low, &high));
        let (mut low, mut high) = (low.tau, high.tau);
        for _ in 0..MOST_STEPS {
            let [value, slope, curvature] = at.f;
            // What Newton's method would gain, twice.
            let gain = slope * slope / curvature.abs();
            if enough(value) || gain <= rounding || high - low <= f64::EPSILON * high.abs() {
                return at;
            }
            if (slope > 0.0) == falls {
                low = at.tau
            } else {
                high = at.tau
            }
            let expected = at.tau - slope / curvature;
            let is_within = expected > low && expected < high;
            at = self.at(if is_within { expected } else { 0.5 * (low + high) });
        }
        at
    }
}

/// Most steps that bracket a zero.
const MOST_STEPS: usize = 80;

/// An instant with the value of a function there and its first two derivatives.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Instant {
    pub tau: f64,
    pub f: [f64; 3],
}

/// Where the inverse of a function, as a cubic through both ends with their slopes, puts its zero; halfway, where that
/// is not between them.
fn expected_root(order: usize, low: &Instant, high: &Instant) -> f64 {
    let (width, rise) = (high.tau - low.tau, high.f[order] - low.f[order]);
    let share = -low.f[order] / rise;
    let [from, to] = [low, high].map(|end| rise / (width * end.f[order + 1]));
    let rest = 1.0 - share;
    let place = share * share * (3.0 - 2.0 * share) + share * rest * (from * rest - to * share);
    low.tau + width * if place > 0.0 && place < 1.0 { place } else { 0.5 }
}

/// Value, first and second derivative of `Re Σ z_n e^{inτ}` at `tau`.
pub(crate) fn evaluate(z: &[Complex64], tau: f64) -> [f64; 3] {
    let step = Complex64::cis(tau);
    let mut turn = Complex64::new(1.0, 0.0);
    let mut sum = [0.0; 3];
    for (n, z) in z.iter().enumerate() {
        let (n, term) = (n as f64, z * turn);
        sum[0] += term.re;
        sum[1] -= n * term.im;
        sum[2] -= n * n * term.re;
        turn *= step;
    }
    sum
}

/// Bound of the second derivative of `Re Σ z_n e^{inτ}`.
pub(crate) fn bound_of_curvature(z: &[Complex64]) -> f64 {
    z.iter().enumerate().map(|(n, z)| (n * n) as f64 * magnitude(z)).sum()
}

/// Bound of `Re Σ z_n e^{inτ}`.
pub(crate) fn bound(z: &[Complex64]) -> f64 {
    z.iter().map(magnitude).sum()
}

/// The root of the square is a fraction of the cost of `norm`, which guards against overflow.
fn magnitude(z: &Complex64) -> f64 {
    z.norm_sqr().sqrt()
}

/// `aᵀ b`.
pub(crate) fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_of_a_cosine_and_of_its_slope() {
        let f = Trigonometric { z: vec![Complex64::new(-0.5, 0.0), Complex64::new(1.0, 0.0)] };
        let third = std::f64::consts::FRAC_PI_3;
        assert!((f.root(1e-16, f.at(0.1), f.at(2.0)) - third).abs() < 1e-15);
        let bottom = f.turn(1e-16, f.at(2.0), f.at(4.0), |_| false);
        assert!((bottom.f[0] + 1.5).abs() < 4e-16 && (bottom.tau - std::f64::consts::PI).abs() < 1e-8);
        assert!((f.evaluate(0.7)[2] + 0.7f64.cos()).abs() < 1e-15);
        assert_eq!(f.bounds(), [1.5, 1.0, 1.0, 1.0]);
    }

    /// `sin τ − s` in any unit, between ends of which one may lie beside the crest or on the other side of it, and the
    /// same with time reversed.
    #[test]
    fn roots_are_found_to_rounding_from_any_ends() {
        for s in [0.0, 0.3, -0.8, 0.999, 1.0 - 1e-9] {
            let root = f64::asin(s);
            for unit in [1e-9, 1.0, 1e7] {
                let rising = Trigonometric { z: vec![(-s * unit).into(), Complex64::new(0.0, -unit)] };
                let falling = Trigonometric { z: vec![(-s * unit).into(), Complex64::new(0.0, unit)] };
                for (before, behind) in [(0.01, 0.01), (0.3, 1e-3), (1e-9, 0.4), (1.5, 1e-5)] {
                    // Beyond the crest it falls again, and before the trough.
                    let to = (root + behind).min(std::f64::consts::PI - root - 1e-6);
                    let from = (root - before).max(-std::f64::consts::PI - root + 1e-6);
                    if to <= root {
                        continue;
                    }
                    let found = rising.root(1e-16 * unit, rising.at(from), rising.at(to));
                    let mirrored = falling.root(1e-16 * unit, falling.at(-to), falling.at(-from));
                    // A value of 1e-16 is rounding, and what it is worth in time depends on the slope.
                    let rounding = 2e-15 / root.cos();
                    assert!((found - root).abs() < rounding, "{s} {unit} {before}: {:e}", found - root);
                    assert!((mirrored + root).abs() < rounding, "{s} {unit} {before}: {:e}", mirrored + root);
                }
            }
        }
    }

    /// The crest of a wave whose curvature turns on the way there, in any unit: its height to rounding, or whatever is
    /// high enough before.
    #[test]
    fn turning_points_are_known_by_their_height() {
        for unit in [1e-9, 1.0, 1e7] {
            let z = [(0.0, 0.0), (1.0, 0.0), (0.0, 0.0), (0.3, 0.0)].map(|(re, im)| Complex64::new(re, im) * unit);
            let f = Trigonometric { z: z.to_vec() };
            for (from, to) in [(-0.2, 0.3), (-1e-3, 0.4), (-0.45, 1e-7)] {
                let crest = f.turn(2e-16 * unit, f.at(from), f.at(to), |_| false);
                assert!(
                    (crest.f[0] / (1.3 * unit) - 1.0).abs() < 1e-15,
                    "{unit} {from}: {:e}",
                    crest.f[0] / unit - 1.3
                );
                let high_enough = f.turn(2e-16 * unit, f.at(from), f.at(to), |value| value > 1.1 * unit);
                assert!(high_enough.f[0] > 1.1 * unit && high_enough.tau > from && high_enough.tau < to);
            }
        }
    }
}

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

    /// Bound of a derivative.
    pub fn bound(&self, order: i32) -> f64 {
        bound(&self.z, order)
    }

    /// Value and derivatives at `tau`.
    pub fn at(&self, tau: f64) -> Instant {
        Instant { tau, f: self.evaluate(tau) }
    }

    /// The zero of derivative `order` (0 or 1) between two instants at which it has different signs.
    ///
    /// From where the cubic through both ends with their slopes puts it, by Halley's method for the function, by Newton's for its slope, kept in the bracket
    /// by bisection.
    pub fn root(&self, order: usize, low: Instant, high: Instant) -> f64 {
        let falls = low.f[order] >= 0.0;
        let mut tau = expected_root(order, &low, &high);
        let (mut low, mut high) = (low.tau, high.tau);
        // A value below this is rounding, of which no further step makes anything better.
        let rounding = f64::EPSILON * self.bound(order as i32);
        for _ in 0..80 {
            let f = self.evaluate(tau);
            if f[order].abs() <= rounding {
                return tau;
            }
            if (f[order] > 0.0) == falls {
                low = tau
            } else {
                high = tau
            }
            let newton = -f[order] / f[order + 1];
            // Curvature of the function over its slope.
            let bend = if order == 0 { f[2] / f[1] } else { 0.0 };
            let expected = tau + newton / (1.0 + 0.5 * newton * bend).max(0.5);
            let is_within = expected > low && expected < high;
            let next = if is_within { expected } else { 0.5 * (low + high) };
            let step = (next - tau).abs();
            // What Halley's method leaves is the third power of its step, times the square of what the function and its harmonics bend by.
            let left = match order == 0 && is_within {
                true => step * (step * bend.abs().max(self.z.len() as f64)).powi(2),
                false => step,
            };
            if left <= 4.0 * f64::EPSILON * tau.abs().max(f64::EPSILON) {
                return next;
            }
            tau = next;
        }
        tau
    }
}

/// An instant with the value of a function there and its first two derivatives.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Instant {
    pub tau: f64,
    pub f: [f64; 3],
}

/// Where the inverse of a function, as a cubic through both ends with their slopes, puts its zero; halfway, where that is not between them.
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

/// Bound of a derivative of `Re Σ z_n e^{inτ}`.
pub(crate) fn bound(z: &[Complex64], order: i32) -> f64 {
    // The root of the square is a fraction of the cost of `norm`, which guards against overflow.
    z.iter().enumerate().map(|(n, z)| (n as f64).powi(order) * z.norm_sqr().sqrt()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_of_a_cosine_and_of_its_slope() {
        let f = Trigonometric { z: vec![Complex64::new(-0.5, 0.0), Complex64::new(1.0, 0.0)] };
        let third = std::f64::consts::FRAC_PI_3;
        let root = |order, low, high| f.root(order, f.at(low), f.at(high));
        assert!((root(0, 0.1, 2.0) - third).abs() < 1e-15);
        // The search ends where a step is below four units of rounding.
        assert!((root(1, 2.0, 4.0) - std::f64::consts::PI).abs() < 4.0 * f64::EPSILON * std::f64::consts::PI);
        assert!((f.evaluate(0.7)[2] + 0.7f64.cos()).abs() < 1e-15);
        assert!(f.bound(2) >= 1.0);
    }

    /// `sin τ − s` in any unit, between ends of which one may lie beside the crest or on the other side of it, and the same with time reversed.
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
                    let found = rising.root(0, rising.at(from), rising.at(to));
                    let mirrored = falling.root(0, falling.at(-to), falling.at(-from));
                    // A value of 1e-16 is rounding, and what it is worth in time depends on the slope.
                    let rounding = 2e-15 / root.cos();
                    assert!((found - root).abs() < rounding, "{s} {unit} {before}: {:e}", found - root);
                    assert!((mirrored + root).abs() < rounding, "{s} {unit} {before}: {:e}", mirrored + root);
                }
            }
        }
    }
}

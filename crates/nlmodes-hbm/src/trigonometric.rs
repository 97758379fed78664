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

    /// The zero of derivative `order` (0 or 1) in `[low, high]`, at whose ends it has different signs:
    /// Newton's method, kept in the bracket by bisection.
    pub fn root(&self, order: usize, mut low: f64, mut high: f64) -> f64 {
        let at_low = self.evaluate(low)[order];
        let mut tau = 0.5 * (low + high);
        for _ in 0..80 {
            let f = self.evaluate(tau);
            if f[order] == 0.0 {
                return tau;
            }
            if (f[order] < 0.0) == (at_low < 0.0) {
                low = tau;
            } else {
                high = tau;
            }
            let newton = tau - f[order] / f[order + 1];
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - tau).abs() <= 4.0 * f64::EPSILON * tau.abs().max(f64::EPSILON) {
                return next;
            }
            tau = next;
        }
        tau
    }
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
        assert!((f.root(0, 0.1, 2.0) - third).abs() < 1e-15);
        // The search ends where a step is below four units of rounding.
        assert!((f.root(1, 2.0, 4.0) - std::f64::consts::PI).abs() < 4.0 * f64::EPSILON * std::f64::consts::PI);
        assert!((f.evaluate(0.7)[2] + 0.7f64.cos()).abs() < 1e-15);
        assert!(f.bound(2) >= 1.0);
    }
}

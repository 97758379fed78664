use core::f64::consts::SQRT_2;

use num_complex::Complex64;

use crate::math::{cis, norm};

/// Order of a Butterworth low-pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Order {
    /// `ω_c / (s + ω_c)`
    #[default]
    First,
    /// `ω_c² / (s² + √2 ω_c s + ω_c²)`
    Second,
}

/// Butterworth low-pass of a complex amplitude, sampled by the bilinear transform with the cut-off prewarped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LowPass {
    /// Cut-off `ω_c`, rad/s: the gain there is 1/√2.
    pub cut_off: f64,
    /// Order.
    pub order: Order,
}

/// Sampled filter: `y = b₀ z + s₀`, and the states in transposed form.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SampledLowPass {
    b: [f64; 3],
    a: [f64; 2],
}

impl LowPass {
    /// `H(s)` of the filter before sampling.
    pub fn response(&self, s: Complex64) -> Complex64 {
        let w = self.cut_off;
        match self.order {
            Order::First => w / (s + w),
            Order::Second => w * w / (s * s + SQRT_2 * w * s + w * w),
        }
    }

    /// Gain `|H|` at the angular frequency `omega`, rad/s, sampled with `step`, s.
    pub fn sampled_gain(&self, omega: f64, step: f64) -> f64 {
        let SampledLowPass { b, a } = self.sampled(step);
        let delay = cis(-omega * step);
        norm((b[0] + delay * (b[1] + delay * b[2])) / (1.0 + delay * (a[0] + delay * a[1])))
    }

    /// `s ↦ (1 − z⁻¹) / (1 + z⁻¹) / k` with `k = tan(ω_c h / 2) / ω_c`.
    pub(crate) fn sampled(&self, step: f64) -> SampledLowPass {
        let k = libm::tan(0.5 * self.cut_off * step);
        match self.order {
            Order::First => {
                let b = k / (1.0 + k);
                SampledLowPass { b: [b, b, 0.0], a: [(k - 1.0) / (1.0 + k), 0.0] }
            }
            Order::Second => {
                let norm = 1.0 / (1.0 + SQRT_2 * k + k * k);
                let b = k * k * norm;
                SampledLowPass {
                    b: [b, 2.0 * b, b],
                    a: [2.0 * (k * k - 1.0) * norm, (1.0 - SQRT_2 * k + k * k) * norm],
                }
            }
        }
    }
}

impl SampledLowPass {
    /// Next output, and the states after it.
    pub(crate) fn step(&self, [s0, s1]: [Complex64; 2], input: Complex64) -> (Complex64, [Complex64; 2]) {
        let y = input * self.b[0] + s0;
        (y, [input * self.b[1] - y * self.a[0] + s1, input * self.b[2] - y * self.a[1]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sampled_filters_have_unit_gain_at_rest_and_half_the_power_at_the_cut_off() {
        for order in [Order::First, Order::Second] {
            let filter = LowPass { cut_off: 30.0, order };
            assert!((filter.sampled_gain(0.0, 1e-3) - 1.0).abs() < 1e-12);
            assert!((filter.sampled_gain(30.0, 1e-3) - 0.5_f64.sqrt()).abs() < 1e-12);
            assert!((filter.response(Complex64::new(0.0, 30.0)).norm() - 0.5_f64.sqrt()).abs() < 1e-15);
        }
    }

    #[test]
    fn a_rotating_input_comes_out_with_the_gain_of_the_filter() {
        for order in [Order::First, Order::Second] {
            let filter = LowPass { cut_off: 30.0, order };
            let (sampled, mut states, mut y) = (filter.sampled(1e-3), [Complex64::default(); 2], Complex64::default());
            for k in 0..3000 {
                (y, states) = sampled.step(states, Complex64::cis(0.08 * f64::from(k)));
            }
            assert!((y.norm() - filter.sampled_gain(80.0, 1e-3)).abs() < 1e-12);
        }
    }
}

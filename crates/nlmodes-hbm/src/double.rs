use std::f64::consts::PI;
use std::ops::{Add, Mul, Neg, Sub};

use num_complex::Complex64;

/// A number with twice the digits: the unevaluated sum of a number and what lies below its last digit (Dekker 1971).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Double {
    pub high: f64,
    pub low: f64,
}

/// `2^27 + 1`, which splits a number into two halves whose products are exact.
const SPLITTER: f64 = 134_217_729.0;

/// `2π − 2π` rounded.
const TAU_LOW: f64 = 2.449_293_598_294_706_5e-16;

impl Double {
    pub const ZERO: Self = Self { high: 0.0, low: 0.0 };
    pub const ONE: Self = Self { high: 1.0, low: 0.0 };
    pub const TAU: Self = Self { high: 2.0 * PI, low: TAU_LOW };

    pub fn of(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }

    /// The exact sum of two numbers (Knuth).
    pub fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let of_b = high - a;
        Self { high, low: (a - (high - of_b)) + (b - of_b) }
    }

    /// The exact product of two numbers (Veltkamp, Dekker).
    pub fn product(a: f64, b: f64) -> Self {
        let split = |a: f64| {
            let c = SPLITTER * a;
            let high = c - (c - a);
            (high, a - high)
        };
        let (high, (a1, a2), (b1, b2)) = (a * b, split(a), split(b));
        Self { high, low: ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2 }
    }

    pub fn over(self, divisor: f64) -> Self {
        let first = self.high / divisor;
        let rest = self - Self::product(first, divisor);
        Self::sum(first, rest.high / divisor)
    }

    pub fn value(self) -> f64 {
        self.high + self.low
    }
}

impl Add for Double {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = (Self::sum(self.high, other.high), Self::sum(self.low, other.low));
        let first = Self::sum(high.high, high.low + low.high);
        Self::sum(first.high, first.low + low.low)
    }
}

impl Neg for Double {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = Self::product(self.high, other.high);
        Self::sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

/// A complex number with twice the digits.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct DoubleComplex {
    pub re: Double,
    pub im: Double,
}

/// Terms of the exponential series, and halvings of its argument before it is summed: together good to all digits up to
/// a few turns.
const TERMS: usize = 20;
const HALVINGS: i32 = 6;

impl DoubleComplex {
    pub const ZERO: Self = Self { re: Double::ZERO, im: Double::ZERO };
    pub const ONE: Self = Self { re: Double::ONE, im: Double::ZERO };

    /// `e^{iτ}` for τ of a few turns at most.
    pub fn cis(tau: f64) -> Self {
        let small = Self { re: Double::ZERO, im: Double::of(tau / 2.0_f64.powi(HALVINGS)) };
        // Horner's scheme for Σ zᵏ/k!.
        let mut sum = Self::ONE;
        for k in (1..=TERMS).rev() {
            let next = sum * small;
            sum = Self { re: next.re.over(k as f64), im: next.im.over(k as f64) } + Self::ONE;
        }
        (0..HALVINGS).fold(sum, |z, _| z * z)
    }

    pub fn conj(self) -> Self {
        Self { im: -self.im, ..self }
    }

    pub fn scaled(self, factor: Double) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }

    pub fn value(self) -> Complex64 {
        Complex64::new(self.re.value(), self.im.value())
    }
}

impl Add for DoubleComplex {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for DoubleComplex {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Mul for DoubleComplex {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_beyond_the_last_one_are_kept() {
        let third = Double::ONE.over(3.0);
        let left = third + third + third - Double::ONE;
        assert!(left.value().abs() < 1e-31, "{left:?}");
        let square = Double::of(1e8 + 1.0) * Double::of(1e8 + 1.0) - Double::of(1e16) - Double::of(2e8);
        assert_eq!(square.value(), 1.0);
        assert!((Double::TAU - Double::of(std::f64::consts::TAU)).value() > 2e-16);
    }

    /// A sum of two numbers is rounded to the nearest one: beside a power of two they lie twice as close on one side.
    #[test]
    fn the_value_of_an_exact_sum_is_the_rounded_sum() {
        for k in 40..=60 {
            for a in [1.0, -2.0, 3.0, 1024.0, 0.1] {
                for b in [1.0, 1.5, -1.0, -1.75].map(|b| b * 2.0_f64.powi(-k)) {
                    let sum = Double::sum(a, b);
                    assert_eq!(sum.value(), a + b, "{a} {b:e}");
                    let rest = sum - Double::of(a);
                    assert_eq!(rest.value(), b, "{a} {b:e}");
                }
            }
        }
    }

    #[test]
    fn a_turn_in_parts_comes_back_to_one() {
        // Thirteen turns of 2π/13, of which only the rounding of the angle is left: e^{i·13 δ} with δ known exactly.
        for parts in [3_u32, 7, 13, 50] {
            let angle = std::f64::consts::TAU / f64::from(parts);
            let z = DoubleComplex::cis(angle);
            let turned = (0..parts).fold(DoubleComplex::ONE, |w, _| w * z);
            let left = Double::product(angle, f64::from(parts)) - Double::TAU;
            let off = [turned.re - Double::ONE, turned.im - left].map(Double::value);
            assert!(off.iter().all(|v| v.abs() < 1e-28), "{parts}: {off:?}");
            let length = turned.re * turned.re + turned.im * turned.im - Double::ONE;
            assert!(length.value().abs() < 1e-28, "{length:?}");
        }
        let z = DoubleComplex::cis(-4.1).value();
        assert!((z - Complex64::cis(-4.1)).norm() < 1e-15);
    }
}

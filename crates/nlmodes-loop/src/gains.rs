use core::f64::consts::SQRT_2;

use num_complex::Complex64;

use crate::error::{finite, positive};
use crate::math::norm;
use crate::{LowPass, Order, PhaseLoopError};

/// What has to be known of the resonance beforehand, roughly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resonance {
    /// Angular eigenfrequency `ω_0`, rad/s.
    pub omega: f64,
    /// Damping ratio `ζ`.
    pub damping_ratio: f64,
}

impl Resonance {
    /// Decay rate `δ = ζ ω_0`, 1/s: the lag follows the frequency through `1 / (s + δ)`.
    pub fn decay_rate(&self) -> f64 {
        self.damping_ratio * self.omega
    }
}

/// Gains of the loop filter: `ω = ω_start + K_p e + K_i ∫ e dt`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gains {
    /// `K_p`, 1/s.
    pub proportional: f64,
    /// `K_i`, 1/s².
    pub integral: f64,
}

impl Gains {
    /// Gains after the symmetrical optimum: unit loop gain at a quarter of the cut-off, where the phase margin is about
    /// 60 degrees with a low-pass of first order and about 55 with one of second.
    ///
    /// ```text
    /// L(s) = (K_p + K_i / s) H(s) / (s + δ) ,   |L(iω_x)| = 1   at   ω_x = ω_c / 4 ,   K_i = (δ + ω_x / 4) K_p
    /// ```
    ///
    /// # Errors
    /// [`PhaseLoopError::NotPositive`], [`PhaseLoopError::NotFinite`].
    pub fn design(resonance: Resonance, low_pass: LowPass) -> Result<Self, PhaseLoopError> {
        positive("frequency of the resonance (rad/s)", resonance.omega)?;
        finite("damping ratio", resonance.damping_ratio)?;
        let crossover = 0.25 * positive("cut-off of the detector (rad/s)", low_pass.cut_off)?;
        let corner = resonance.decay_rate().max(0.0) + 0.25 * crossover;
        let unit = Self { proportional: 1.0, integral: corner };
        let scale = 1.0 / norm(unit.open_loop(resonance, low_pass, Complex64::new(0.0, crossover)));
        Ok(Self { proportional: scale, integral: scale * corner })
    }

    /// Open loop `L(s) = (K_p + K_i / s) H(s) / (s + δ)`.
    pub fn open_loop(&self, resonance: Resonance, low_pass: LowPass, s: Complex64) -> Complex64 {
        (self.proportional + self.integral / s) * low_pass.response(s) / (s + resonance.decay_rate())
    }

    /// Largest stable integral gain, 1/s², at the proportional gain of `self`; zero if there is none.
    ///
    /// By Routh, with `δ` the decay rate and `ω_c` the cut-off: for a low-pass of first order `(ω_c + δ) (δ + K_p)`;
    /// for one of second order `a_1 (a_3 a_2 − a_1) / (a_3² ω_c²)` with `a_3 = √2 ω_c + δ`, `a_2 = ω_c² + √2 ω_c δ`,
    /// `a_1 = ω_c² (δ + K_p)`.
    pub fn integral_limit(&self, resonance: Resonance, low_pass: LowPass) -> f64 {
        let (delta, w) = (resonance.decay_rate(), low_pass.cut_off);
        let limit = match low_pass.order {
            Order::First if w + delta > 0.0 => (w + delta) * (delta + self.proportional),
            Order::First => 0.0,
            Order::Second => {
                let a3 = SQRT_2 * w + delta;
                let (a2, a1) = (w * w + SQRT_2 * w * delta, w * w * (delta + self.proportional));
                if a1 > 0.0 && a3 > 0.0 { a1 * (a3 * a2 - a1) / (a3 * w * (a3 * w)) } else { 0.0 }
            }
        };
        limit.max(0.0)
    }

    /// Whether the loop is stable.
    ///
    /// # Errors
    /// [`PhaseLoopError::UnstableGains`] with the limit, and [`PhaseLoopError::NotFinite`].
    pub fn check(&self, resonance: Resonance, low_pass: LowPass) -> Result<(), PhaseLoopError> {
        finite("proportional gain (1/s)", self.proportional)?;
        finite("integral gain (1/s²)", self.integral)?;
        let limit = self.integral_limit(resonance, low_pass);
        if self.integral > 0.0 && self.integral < limit {
            return Ok(());
        }
        Err(PhaseLoopError::UnstableGains { proportional: self.proportional, integral: self.integral, limit })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{PI, TAU};

    /// Roots of the characteristic polynomial in the right half-plane, by the argument principle along the imaginary
    /// axis: a polynomial of degree n turns by `(n − 2 N) π` from `−i∞` to `i∞`.
    fn unstable_roots(gains: Gains, resonance: Resonance, low_pass: LowPass) -> i32 {
        let polynomial = |y: f64| {
            let s = Complex64::new(0.0, y);
            let h = low_pass.response(s);
            (s * (s + resonance.decay_rate()) / h) + gains.proportional * s + gains.integral
        };
        let degree = if low_pass.order == Order::First { 3 } else { 4 };
        let scale = low_pass.cut_off + gains.proportional.abs() + gains.integral.abs().sqrt();
        let at = |k: i32| polynomial(scale * (0.5 * PI * f64::from(k) / 40_001.0).tan());
        let turned: f64 = (-40_000..40_000).map(|k| (at(k + 1) / at(k)).arg()).sum();
        ((f64::from(degree) - turned / PI) / 2.0).round() as i32
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]
        #[test]
        fn the_limit_separates_stable_from_unstable(
            omega in 50.0..5000.0f64, zeta in 1e-3..0.05f64, share in 0.005..0.2f64, kp in -0.5..3.0f64,
            order in prop::sample::select(vec![Order::First, Order::Second])
        ) {
            let resonance = Resonance { omega, damping_ratio: zeta };
            let low_pass = LowPass { cut_off: share * omega, order };
            let mut gains = Gains { proportional: kp * low_pass.cut_off, integral: 0.0 };
            let limit = gains.integral_limit(resonance, low_pass);
            for factor in [0.9, 1.1] {
                gains.integral = factor * limit.max(1e-3 * omega * omega * share);
                let stable = unstable_roots(gains, resonance, low_pass) == 0;
                prop_assert_eq!(gains.check(resonance, low_pass).is_ok(), stable);
            }
        }

        #[test]
        fn designed_gains_have_a_phase_margin(
            omega in 50.0..5000.0f64, zeta in 1e-4..0.05f64, share in 0.005..0.2f64,
            order in prop::sample::select(vec![Order::First, Order::Second])
        ) {
            let resonance = Resonance { omega, damping_ratio: zeta };
            let low_pass = LowPass { cut_off: share * omega, order };
            let gains = Gains::design(resonance, low_pass).unwrap();
            prop_assert!(gains.check(resonance, low_pass).is_ok());
            let open = gains.open_loop(resonance, low_pass, Complex64::new(0.0, 0.25 * low_pass.cut_off));
            let margin = (open.arg() + TAU).rem_euclid(TAU) - PI;
            prop_assert!((open.norm() - 1.0).abs() < 1e-12);
            prop_assert!(margin > 50f64.to_radians() && margin < 110f64.to_radians(), "{}", margin.to_degrees());
        }
    }

    #[test]
    fn at_the_limit_a_pair_of_roots_is_imaginary() {
        let resonance = Resonance { omega: 250.0, damping_ratio: 0.002 };
        let low_pass = LowPass { cut_off: 12.0, order: Order::First };
        let mut gains = Gains { proportional: 5.0, integral: 0.0 };
        gains.integral = gains.integral_limit(resonance, low_pass);
        let s = Complex64::new(0.0, (12.0 * (0.5 + 5.0_f64)).sqrt());
        assert!((gains.open_loop(resonance, low_pass, s) + 1.0).norm() < 1e-14);
    }

    /// A loop in seconds and the same in microseconds or days: gains and limits carry their powers of the unit of time.
    #[test]
    fn gains_and_limits_scale_with_the_unit_of_time() {
        for order in [Order::First, Order::Second] {
            let at = |s: f64| {
                let resonance = Resonance { omega: 250.0 * s, damping_ratio: 0.004 };
                let low_pass = LowPass { cut_off: 12.0 * s, order };
                let gains = Gains::design(resonance, low_pass).unwrap();
                gains.check(resonance, low_pass).unwrap();
                [gains.proportional / s, gains.integral / s / s, gains.integral_limit(resonance, low_pass) / s / s]
            };
            let expected = at(1.0);
            for s in [1e-6, 1e-3, 1e5] {
                at(s).iter().zip(&expected).for_each(|(a, b)| assert!((a / b - 1.0).abs() < 1e-12, "{s}: {a} {b}"));
            }
        }
    }

    #[test]
    fn a_resonance_that_grows_faster_than_the_filter_follows_has_no_stable_gain() {
        for (order, damping_ratio) in [(Order::First, -0.05), (Order::Second, -0.07)] {
            let resonance = Resonance { omega: 250.0, damping_ratio };
            let gains = Gains { proportional: 30.0, integral: 1e-3 };
            let low_pass = LowPass { cut_off: 12.0, order };
            assert_eq!(gains.integral_limit(resonance, low_pass), 0.0, "{order:?}");
            assert!(gains.check(resonance, low_pass).is_err() && unstable_roots(gains, resonance, low_pass) > 0);
        }
    }
}

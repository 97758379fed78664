//! A rod of two elements in front of a stop, its tip massless: one degree of freedom with mass, and a motion in closed
//! form.

use crate::support;

use std::f64::consts::{PI, TAU};

use nlmodes_hbm::{PeriodicSystem, Switching, Symmetry};
use support::{fitted_slope, problem, settle, two_element_rod};

/// The motion with amplitude `A` while free, in units `EA = ρA = L = g₀ = 1`.
///
/// The massive node x has `m = 1/3`; free it sits on a spring of 2 about 0, and with the tip at the stop on one of 4
/// about ½. At `x = 1` both have the same strain energy 1 and the speed is continuous: `6 (A² − 1) = 12 (B² − ¼)`.
struct ClosedForm {
    a: f64,
    b: f64,
    /// Half the contact phase and half the free phase, s.
    half: [f64; 2],
}

const OMEGA_FREE: f64 = 2.449_489_742_783_178;
const OMEGA_CONTACT: f64 = 3.464_101_615_137_754_6;

impl ClosedForm {
    fn new(a: f64) -> Self {
        let b = (0.25 + 0.5 * (a * a - 1.0)).sqrt();
        Self { a, b, half: [(0.5 / b).acos() / OMEGA_CONTACT, (PI - (1.0 / a).acos()) / OMEGA_FREE] }
    }

    fn period(&self) -> f64 {
        2.0 * (self.half[0] + self.half[1])
    }

    fn omega(&self) -> f64 {
        TAU / self.period()
    }

    /// `⟨½ m ẋ²⟩` with `∫ sin² = ½ (θ − sin θ cos θ)` over each phase.
    fn kinetic(&self) -> f64 {
        let theta = [OMEGA_CONTACT * self.half[0], OMEGA_FREE * self.half[1]];
        let integral = theta.map(|theta| theta - theta.sin() * theta.cos());
        let contact = 2.0 * self.b * self.b / OMEGA_CONTACT * integral[0];
        let free = self.a * self.a / OMEGA_FREE * integral[1];
        (contact + free) / self.period()
    }

    fn x(&self, tau: f64) -> f64 {
        let t = if tau > PI { TAU - tau } else { tau } / self.omega();
        if t < self.half[0] {
            return 0.5 + self.b * (OMEGA_CONTACT * t).cos();
        }
        -self.a * (OMEGA_FREE * (0.5 * self.period() - t)).cos()
    }

    /// Scaled unknowns of the motion, to begin Newton's method with: the gap opens by −x, and the scales are 1 and
    /// √6.
    fn unknowns(&self, problem: &PeriodicSystem) -> (Vec<f64>, f64) {
        let (h, samples) = (problem.series().n_harmonics, 1 << 13);
        let cosine = |n: usize| {
            let sum: f64 = (0..samples)
                .map(|j| TAU * j as f64 / samples as f64)
                .map(|tau| self.x(tau) * (n as f64 * tau).cos())
                .sum();
            sum * if n == 0 { 1.0 } else { 2.0 } / samples as f64
        };
        let mut x: Vec<f64> = (0..=h).map(|n| -cosine(n)).collect();
        x.push(self.omega() / OMEGA_FREE);
        (x, (self.kinetic() / 0.5).ln())
    }
}

/// Relative error of the frequency at the energy of the closed form, and the total energy.
fn computed(closed: &ClosedForm, harmonics: usize, switching: Switching) -> (f64, f64) {
    let structure = two_element_rod();
    let (mut problem, start) = problem(&structure, 1, harmonics, Symmetry::Even, switching);
    assert!((start.energy - 0.5).abs() < 1e-13 && (start.omega - OMEGA_FREE).abs() < 1e-13);
    let (guess, p) = closed.unknowns(&problem);
    let (x, residual) = settle(&mut problem, guess, p);
    assert!(residual < 1e-11, "{harmonics} harmonics, {switching:?}: residual {residual:e}");
    let point = structure.modal_point(&mut problem, &x, residual).unwrap();
    assert!((point.kinetic_energy / closed.kinetic() - 1.0).abs() < 1e-10);
    (point.omega / closed.omega() - 1.0, point.total_energy)
}

/// Largest error among the harmonics (or samples) of each octave: single ones oscillate with where the corners fall.
fn octaves(from: usize, count: usize, error: impl Fn(usize) -> f64) -> Vec<(f64, f64)> {
    let largest = |low: usize| (0..8).map(|i| low + low * i / 8).fold(0.0_f64, |m, n| m.max(error(n).abs()));
    (0..count).map(|k| (from << k) as f64).map(|low| (low, largest(low as usize))).collect()
}

/// Largest deviation of `½ m ẋ² + V(x)` from `A²` over a period, relative.
fn energy_spread(closed: &ClosedForm, harmonics: usize) -> f64 {
    let structure = two_element_rod();
    let (mut problem, _) = problem(&structure, 1, harmonics, Symmetry::Even, Switching::Exact);
    let (guess, p) = closed.unknowns(&problem);
    let (x, residual) = settle(&mut problem, guess, p);
    let point = structure.modal_point(&mut problem, &x, residual).unwrap();
    let spread = (0..4096).map(|j| TAU * j as f64 / 4096.0).map(|tau| {
        let (x, v) = (point.coefficients.value(0, tau), point.omega * point.coefficients.derivative(0, tau, 1));
        let strain = if x > 1.0 { 2.0 * x * x - 2.0 * x + 1.0 } else { x * x };
        (v * v / 6.0 + strain) / (closed.a * closed.a) - 1.0
    });
    spread.fold(0.0, |m, e| m.max(e.abs()))
}

#[test]
fn the_closed_form_has_the_figures_it_is_known_for() {
    let closed = ClosedForm::new(2.0);
    assert!((closed.omega() / TAU - 0.417_852_834_045_572_5).abs() < 1e-15);
    assert!((closed.kinetic() - 2.076_372_313_358_422).abs() < 1e-14);
    // The same mean by differences of x(τ) on a fine grid.
    let n = 100_000;
    let step = TAU / n as f64;
    let speed = |j: usize| (closed.x(step * (j + 1) as f64) - closed.x(step * j as f64)) / step * closed.omega();
    let mean = (0..n).map(|j| speed(j).powi(2) / 6.0).sum::<f64>() / n as f64;
    assert!((mean / closed.kinetic() - 1.0).abs() < 1e-8, "{mean}");
}

#[test]
fn frequency_at_given_energy_converges_with_the_fifth_power_of_the_harmonics() {
    // The third derivative of x jumps, so x_n ~ n⁻⁴; the frequency is stationary, so its error goes like Σ_{n > H} n²
    // x_n² ~ H⁻⁵.
    let closed = ClosedForm::new(2.0);
    let errors = octaves(5, 5, |h| computed(&closed, h, Switching::Exact).0);
    let slope = fitted_slope(&errors);
    assert!((-5.5..-4.4).contains(&slope), "order {slope}: {errors:?}");
}

#[test]
fn fifty_harmonics_give_ten_digits_of_frequency_and_energy() {
    for amplitude in [1.2, 2.0, 4.0] {
        let closed = ClosedForm::new(amplitude);
        for harmonics in 50..=64 {
            let (error, total) = computed(&closed, harmonics, Switching::Exact);
            assert!(error.abs() < 1e-10, "A = {amplitude}, {harmonics} harmonics: {error:e}");
            let energy = total / (amplitude * amplitude) - 1.0;
            assert!(energy.abs() < 1e-10, "A = {amplitude}, {harmonics} harmonics: total energy off by {energy:e}");
        }
    }
}

#[test]
fn total_energy_converges_to_the_square_of_the_amplitude() {
    let closed = ClosedForm::new(2.0);
    let errors = octaves(5, 5, |h| computed(&closed, h, Switching::Exact).1 / 4.0 - 1.0);
    let slope = fitted_slope(&errors);
    assert!((-5.5..-4.4).contains(&slope), "order {slope}: {errors:?}");
}

#[test]
fn energy_is_constant_in_time_but_for_the_square_of_the_truncation() {
    // Pointwise the velocity misses Σ_{n > H} n x_n ~ H⁻².
    let closed = ClosedForm::new(2.0);
    let spreads: Vec<(f64, f64)> = [5, 10, 20, 40, 80].map(|h| (h as f64, energy_spread(&closed, h))).to_vec();
    let slope = fitted_slope(&spreads);
    assert!((-2.1..-1.9).contains(&slope), "order {slope}: {spreads:?}");
    assert!(spreads[4].1 < 3e-5, "{spreads:?}");
}

#[test]
fn samples_add_an_error_that_falls_with_their_square() {
    let closed = ClosedForm::new(2.0);
    for harmonics in [5, 20] {
        let exact = computed(&closed, harmonics, Switching::Exact).0;
        let errors = octaves(64, 6, |n| computed(&closed, harmonics, Switching::Sampled { samples: n }).0 - exact);
        let slope = fitted_slope(&errors);
        // The trapezoidal rule on a function whose slope jumps; which samples lie next to the jump makes the factor.
        assert!((-2.4..-1.7).contains(&slope), "{harmonics} harmonics, order {slope}: {errors:?}");
    }
}

#[test]
fn more_harmonics_do_not_mend_the_error_of_the_samples() {
    let closed = ClosedForm::new(2.0);
    let sampled = Switching::Sampled { samples: 256 };
    let limit = computed(&closed, 60, sampled).0;
    assert!(limit.abs() > 1e-6 && limit.abs() < 4e-6, "{limit:e}");
    for harmonics in [20, 30, 40, 100] {
        let found = computed(&closed, harmonics, sampled).0;
        assert!((found / limit - 1.0).abs() < 0.02, "{harmonics} harmonics: {found:e} against {limit:e}");
    }
    assert!(computed(&closed, 60, Switching::Exact).0.abs() < 1e-4 * limit.abs());
}

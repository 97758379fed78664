//! Duffing's oscillator `ẍ + 2 ζ ẋ + x + κ x³` in closed form: backbone, damped mode, response and multipliers.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use nlmodes_hbm::{
    Coordinates, Load, LoadTerm, PeriodicMotion, PeriodicSettings, PeriodicSystem, Polynomial, Scales, Switching,
    Symmetry,
};
use num_complex::Complex64;

use crate::laws::oscillator;
use crate::support::modal::{newton, settings, solver};

/// `K(m)` by the arithmetic-geometric mean.
fn complete_elliptic(m: f64) -> f64 {
    let (mut a, mut g) = (1.0, (1.0 - m).sqrt());
    for _ in 0..30 {
        (a, g) = (0.5 * (a + g), (a * g).sqrt());
    }
    FRAC_PI_2 / a
}

/// Angular frequency and averaged kinetic energy of the free motion of this amplitude: `x = A cn(…)`,
/// `ω = π √(1 + κA²)/(2 K(m))`, `m = κA²/(2(1 + κA²))`, and the action by a quadrature of its own.
fn free(kappa: f64, amplitude: f64) -> (f64, f64) {
    let stiff = 1.0 + kappa * amplitude * amplitude;
    let omega = PI * stiff.sqrt() / (2.0 * complete_elliptic(kappa * amplitude * amplitude / (2.0 * stiff)));
    // E_av = ω/(4π) ∮ ẋ dx with x = A sin s: ẋ = A cos s √(1 + κA²(1 + sin² s)/2).
    let count = 400;
    let work = |j: usize| {
        let s = 2.0 * PI * (j as f64 + 0.5) / count as f64;
        let slope = (1.0 + 0.5 * kappa * amplitude * amplitude * (1.0 + s.sin().powi(2))).sqrt();
        (amplitude * s.cos()).powi(2) * slope
    };
    let action = (0..count).map(work).sum::<f64>() * 2.0 * PI / count as f64;
    (omega, omega / (4.0 * PI) * action)
}

const MANY: PeriodicSettings =
    PeriodicSettings { harmonics: 31, switching: Switching::Exact, coordinates: Coordinates::Automatic };

fn largest(motion: &PeriodicMotion) -> f64 {
    motion.eta.iter().map(|eta| eta[0].re).sum()
}

#[test]
fn the_backbone_is_that_of_elliptic_functions() {
    let kappa = 0.8;
    for amplitude in [0.3_f64, 1.0, 3.0] {
        let (omega, energy) = free(kappa, amplitude);
        let structure = oscillator(Arc::new(Polynomial { coefficients: vec![0.0, 0.0, kappa] }), 0.0);
        let scales = Scales::new(amplitude, omega, energy);
        let mut system =
            PeriodicSystem::conservative_mode(&structure, Symmetry::Even, MANY, scales, solver().as_ref()).unwrap();
        let mut x = vec![0.0; system.n_coefficients()];
        x[1] = 1.0;
        x.push(1.0);
        let (x, _) = newton(&mut system, x, 0.0);
        let motion = system.motion(&x, 0.0).unwrap();
        assert!((motion.at.omega / omega - 1.0).abs() < 1e-11, "{amplitude}: {} {omega}", motion.at.omega);
        assert!((largest(&motion) / amplitude - 1.0).abs() < 1e-10, "{} {amplitude}", largest(&motion));
        let total = 0.5 * amplitude * amplitude + 0.25 * kappa * amplitude.powi(4);
        assert!((motion.total_energy / total - 1.0).abs() < 1e-10, "{} {total}", motion.total_energy);
    }
}

/// With a linear damper the damped mode is the free motion, and its damping ratio `ζ/ω`.
#[test]
fn the_damped_mode_is_the_free_motion_with_the_ratio_of_its_damper() {
    let (kappa, ratio) = (0.8, 0.03);
    for amplitude in [0.3_f64, 1.0, 3.0] {
        let (omega, energy) = free(kappa, amplitude);
        let structure = oscillator(Arc::new(Polynomial { coefficients: vec![0.0, 0.0, kappa] }), ratio);
        let scales = Scales::new(amplitude, omega, energy);
        let mut system = PeriodicSystem::damped_mode(&structure, MANY, scales, solver().as_ref()).unwrap();
        let mut x = vec![0.0; system.n_coefficients()];
        x[1] = 1.0;
        x.extend([1.0, 0.0]);
        system.hold_phase(&x);
        let (x, _) = newton(&mut system, x, 0.0);
        let motion = system.motion(&x, 0.0).unwrap();
        assert!((motion.at.omega / omega - 1.0).abs() < 1e-11, "{amplitude}: {} {omega}", motion.at.omega);
        let expected = ratio / omega;
        assert!((motion.damping_ratio() / expected - 1.0).abs() < 1e-10, "{} {expected}", motion.damping_ratio());
    }
}

/// Under the load of which `A cn(p t | m)` is the response, `p² = α + κ A²`, `m = κ A²/(2 p²)`, that is the response.
///
/// Its multipliers follow from the equation of Lamé, `u″ + (h − 6 m sn²) u = 0` with `h = (1 − ζ²)/p² + 6 m` where a
/// disturbance is `e^{−ζt} u(p t)`: the product of two solutions is `F = a₀ + a₁ sn² + a₂ sn⁴`, the exponents of these
/// are `± i ν ∫ dx/F` with `ν² = a₀ a₁ + h a₀²`.
#[test]
fn a_response_and_its_multipliers_are_those_of_elliptic_functions() {
    let (kappa, amplitude, alpha, ratio) = (0.7, 1.3_f64, 0.6, 0.05);
    let p = (alpha + kappa * amplitude * amplitude).sqrt();
    let m = kappa * amplitude * amplitude / (2.0 * p * p);
    let (k, nome) = (complete_elliptic(m), (-PI * complete_elliptic(1.0 - m) / complete_elliptic(m)).exp());
    let omega = PI * p / (2.0 * k);
    let cn = |n: usize| {
        let q = nome.powf(0.5 * n as f64);
        amplitude * 2.0 * PI / (m.sqrt() * k) * q / (1.0 + q * q)
    };
    let term = |n: usize| LoadTerm {
        harmonic: n,
        omega_power: 0,
        modal: vec![Complex64::new(1.0 - alpha, 2.0 * ratio * n as f64 * omega) * cn(n)],
        gaps: vec![0.0.into()],
    };
    let structure = oscillator(Arc::new(Polynomial { coefficients: vec![0.0, 0.0, kappa] }), ratio);
    let load = Load::new(&structure, (0..15).map(|j| term(2 * j + 1)).collect()).unwrap();
    let scales = Scales::new(amplitude, omega, 1.0);
    let settings = settings(31, Coordinates::Automatic);
    let mut system =
        PeriodicSystem::force_response(&structure, load, omega, 1.0, settings, scales, solver().as_ref()).unwrap();
    let mut x = vec![0.0; system.n_coefficients()];
    x[1] = 0.9;
    let (x, _) = newton(&mut system, x, 1.0);
    let motion = system.motion(&x, 1.0).unwrap();
    for n in 0..30 {
        let expected = if n % 2 == 1 { cn(n) } else { 0.0 };
        assert!((motion.eta[n][0] - expected).norm() < 1e-11 * amplitude, "{n}: {} {expected}", motion.eta[n][0]);
    }
    let h = (1.0 - ratio * ratio) / (p * p) + 6.0 * m;
    let a2 = 1.0;
    let a1 = (h - 4.0 * (1.0 + m)) * a2 / (3.0 * m);
    let a0 = ((h - 1.0 - m) * a1 + 3.0 * a2) / (3.0 * m);
    let nu = (a0 * a1 + h * a0 * a0).sqrt();
    let count = 400;
    let part = |j: usize| {
        let s = (2.0 * PI * j as f64 / count as f64).sin().powi(2);
        1.0 / ((1.0 - m * s).sqrt() * (a0 + s * (a1 + s * a2)))
    };
    let angle = nu * (0..count).map(part).sum::<f64>() * 2.0 * PI / count as f64;
    let size = (-ratio * 4.0 * k / p).exp();
    let found = system.floquet(&x, 1.0, solver().as_ref()).unwrap();
    let (sum, product): (Complex64, Complex64) = (found.multipliers.iter().sum(), found.multipliers.iter().product());
    assert!((sum - 2.0 * size * angle.cos()).norm() < 1e-10, "{sum} {}", 2.0 * size * angle.cos());
    assert!((product - size * size).norm() < 1e-10, "{product} {}", size * size);
}

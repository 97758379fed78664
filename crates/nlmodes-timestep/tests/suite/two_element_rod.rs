//! A rod of two elements with a stop and a massless tip: one degree of freedom with mass, and a motion in closed form.

use crate::support;

use std::f64::consts::TAU;

use nlmodes_timestep::{Floquet, ModalState, PeriodicMotion, Shooting, ShootingScales, Verification};
use support::{ClosedForm, OMEGA_FREE, dynamics, settle, unit_rod};

/// `½ m A² ω²/2` at `A = 1`.
const GRAZING_ENERGY: f64 = 0.5;

fn shooting() -> Shooting {
    let scales = ShootingScales { omega: OMEGA_FREE, energy: GRAZING_ENERGY };
    Shooting::new(dynamics(&unit_rod(2)), scales).unwrap()
}

#[test]
fn the_propagated_motion_is_the_closed_form_at_every_instant() {
    for amplitude in [1.0 + 1e-9, 1.2, 2.0, 50.0] {
        let closed = ClosedForm::new(amplitude);
        let mut rod = dynamics(&unit_rod(2));
        let start = rod.state(&closed.position(0.0), &[0.0, 0.0]).unwrap();
        let trajectory = rod.propagate(&start, 3.0 * closed.period()).unwrap();
        // The phase of the closed form is arccos(1/A), which has lost digits near grazing.
        let tolerance = 1e-13 * amplitude / (1.0 - 1.0 / (amplitude * amplitude)).sqrt();
        for j in 0..=3000 {
            let t = 3.0 * closed.period() * f64::from(j) / 3000.0;
            let (found, expected) = (trajectory.at(t).displacement, closed.position(t));
            let error = (found[0] - expected[0]).abs().max((found[1] - expected[1]).abs());
            assert!(error < tolerance, "A = {amplitude}, t = {t}: {found:?} and {expected:?}");
        }
        let first = trajectory.closed_intervals()[0];
        assert!((first.to - closed.half[0]).abs() < tolerance, "A = {amplitude}: {}", first.to - closed.half[0]);
    }
}

#[test]
fn shooting_finds_the_closed_form_to_twelve_digits() {
    for amplitude in [1.001, 1.2, 2.0, 4.0, 30.0] {
        let closed = ClosedForm::new(amplitude);
        let mut shooting = shooting();
        let p = (closed.kinetic() / GRAZING_ENERGY).ln();
        // From a guess with an error of several per cent.
        let [x, _] = closed.position(0.0);
        let start = shooting.dynamics().state(&[1.05 * x, 1.0], &[0.0; 2]).unwrap();
        let guess = shooting.unknowns(&start, 0.97 * closed.omega());
        let (found, residual) = settle(&mut shooting, guess, p);
        assert!(residual < 1e-13, "A = {amplitude}: residual {residual:e}");
        let motion = shooting.motion(&found).unwrap();
        assert!((motion.omega / closed.omega() - 1.0).abs() < 1e-12, "{:e}", motion.omega / closed.omega() - 1.0);
        assert!((motion.kinetic_energy / closed.kinetic() - 1.0).abs() < 1e-12);
        assert!((motion.total_energy / (amplitude * amplitude) - 1.0).abs() < 1e-12);
        assert!((motion.trajectory.at(0.0).displacement[0] / x - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_motion_that_returns_is_told_from_one_that_does_not() {
    let closed = ClosedForm::new(2.0);
    let mut rod = dynamics(&unit_rod(2));
    let start = rod.state(&closed.position(0.0), &[0.0; 2]).unwrap();
    let exact = Verification::new(&mut rod, &start, closed.period()).unwrap();
    assert!(exact.energy_norm < 1e-13 && exact.displacement < 1e-13 && exact.velocity < 1e-13, "{exact:?}");
    assert!((exact.energy / 4.0 - 1.0).abs() < 1e-14 && exact.energy_drift < 1e-14);
    assert_eq!((exact.n_intervals, exact.intervals.len()), (1, 2));
    assert!((exact.closed_share[0] - 2.0 * closed.half[0] / closed.period()).abs() < 1e-14);
    // K_NN = 2 is the stiffness of the last element: λ = 2 (x − 1).
    assert!((exact.peak_force - 2.0 * (closed.position(0.0)[0] - 1.0)).abs() < 1e-13);
    // With a period too long by ΔT, x is off by ẍ (ΔT)²/2 and ẋ by ẍ ΔT; the velocity is zero at the end.
    let late = Verification::new(&mut rod, &start, 1.001 * closed.period()).unwrap();
    let acceleration = 12.0 * (closed.position(0.0)[0] - 0.5);
    let (late_by, speed) = (0.001 * closed.period(), 2.0 * OMEGA_FREE);
    assert!((late.velocity / (acceleration * late_by / speed) - 1.0).abs() < 1e-3, "{late:?}");
    // Only the velocity of the mass of 1/3, relative to the energy of 4: everything else is of second order.
    let missing = (0.5 / 3.0 * (acceleration * late_by).powi(2) / 4.0).sqrt();
    assert!((late.energy_norm / missing - 1.0).abs() < 1e-2, "{late:?} {missing}");
    assert!((late.displacement / (0.5 * acceleration * late_by * late_by / 2.0) - 1.0).abs() < 1e-3, "{late:?}");
}

#[test]
fn one_degree_of_freedom_has_the_double_multiplier_and_no_other() {
    let closed = ClosedForm::new(2.0);
    let mut rod = dynamics(&unit_rod(2));
    let state = rod.state(&closed.position(0.0), &[0.0; 2]).unwrap();
    let motion = PeriodicMotion::new(&mut rod, state, closed.omega()).unwrap();
    let floquet = Floquet::new(&mut rod, &motion).unwrap();
    assert!(floquet.multipliers.is_empty() && floquet.is_stable());
    assert!(floquet.trivial_defect < 1e-12, "{:e}", floquet.trivial_defect);
}

#[test]
fn a_free_motion_that_just_does_not_touch_stays_free_and_one_that_just_touches_does_not() {
    let mut rod = dynamics(&unit_rod(2));
    let period = TAU / OMEGA_FREE;
    let mut contact = |x: f64| {
        let state = rod.state(&[x, x], &[0.0; 2]).unwrap();
        let trajectory = rod.propagate(&state, period).unwrap();
        trajectory.closed_intervals().iter().map(|i| i.to - i.from).sum::<f64>()
    };
    assert_eq!(contact(-1.0 + 1e-15), 0.0);
    for depth in [1e-12_f64, 1e-8, 1e-4] {
        // The tip is closed for 2 √(2 depth)/ω of the period.
        let expected = 2.0 * (2.0 * depth).sqrt() / OMEGA_FREE;
        let found = contact(-1.0 - depth);
        // Rounding of the amplitude is 1e-16 for a depth of 1e-12, and the duration scales with its square root.
        assert!((found / expected - 1.0).abs() < 1e-3, "depth {depth:e}: {found:e}, not {expected:e}");
    }
    let still = ModalState { z: vec![0.0], v: vec![0.0] };
    assert!(rod.propagate(&still, 100.0).unwrap().closed_intervals().is_empty());
}

//! Unknowns, the directions in which branches set out, anchored phases, and other systems of units.

mod motions;

use crate::support;

use nlmodes_continuation::{Linearization, ParametricSystem};
use nlmodes_hbm::{Coordinates, ModalDamping, PeriodicSystem, RealSeries, Scales, Switching, Symmetry, modal_grazing};
use nlmodes_model::Side;
use support::modal::{Open, settings, solver};
use support::{condense, problem, rod};

const SYMMETRIES: [Symmetry; 2] = [Symmetry::Even, Symmetry::None];

/// Largest entry of `J t`.
fn defect(at: &Linearization, direction: &[f64]) -> f64 {
    let row = |i: usize| (0..direction.len()).map(|j| at.jacobian[(i, j)] * direction[j]).sum::<f64>();
    (0..at.residual.len()).map(|i| row(i).abs()).fold(0.0, f64::max)
}

/// In two systems of units, with stops at both ends of a slot and at two places.
fn stops(length: f64) -> [Vec<(usize, Side, f64)>; 3] {
    [
        vec![(6, Side::Positive, length)],
        vec![(6, Side::Negative, length), (2, Side::Positive, 0.45 * length)],
        vec![(6, Side::Positive, length), (6, Side::Negative, 1.7 * length)],
    ]
}

/// Where a contact only just touches the motion is linear still: residual and `J t` are zero. Rounding of the gap,
/// 1e-16, closes it for 1e-8 of the period.
#[test]
fn branches_begin_at_solutions_and_along_their_tangents() {
    for (ea, rho_a, length) in [(1.0, 1.0, 1.0), (2e8, 40.0, 1e-3)] {
        for stops in stops(length) {
            let model = rod(6, ea, rho_a, 3.0, &stops);
            let structure = condense(&model);
            for mode in [1, 2] {
                for symmetry in SYMMETRIES {
                    let (mut problem, start) = problem(&structure, mode, 4, symmetry, Switching::Exact);
                    let (x, direction) = problem.start(&start);
                    let mut at = Linearization::new(problem.dim());
                    problem.linearize(&x, 0.0, &mut at).unwrap();
                    let along = defect(&at, &direction);
                    assert!(at.residual_norm() < 1e-9 && along < 1e-5, "{:e} {along:e}", at.residual_norm());
                }
                let open = Open::massless(&model);
                let structure = open.structure(ModalDamping::none(open.n_modes()));
                let start = modal_grazing(&structure, mode).unwrap();
                // The negative damping that keeps a free motion going is that of the mode.
                let damped = open.structure(ModalDamping::ratios(&open.omega_squared, &[0.02, 0.03]));
                let mut system = PeriodicSystem::damped_mode(
                    &damped,
                    settings(4, Coordinates::Contact),
                    start.scales(),
                    solver().as_ref(),
                )
                .unwrap();
                let x = modal_grazing(&damped, mode).unwrap().unknowns(&system);
                let mut at = Linearization::new(system.dim());
                system.hold_phase(&x);
                system.linearize(&x, 0.0, &mut at).unwrap();
                assert!(at.residual_norm() < 1e-9, "damped: {:e}", at.residual_norm());
                for (symmetry, coordinates) in
                    SYMMETRIES.iter().flat_map(|s| [Coordinates::Contact, Coordinates::Modal].map(|c| (*s, c)))
                {
                    let mut system = PeriodicSystem::conservative_mode(
                        &structure,
                        symmetry,
                        settings(4, coordinates),
                        start.scales(),
                        solver().as_ref(),
                    )
                    .unwrap();
                    let x = start.unknowns(&system);
                    system.hold_phase(&x);
                    let mut at = Linearization::new(system.dim());
                    system.linearize(&x, 0.0, &mut at).unwrap();
                    let along = defect(&at, &start.direction(&system));
                    assert!(at.residual_norm() < 1e-9 && along < 1e-5, "{:e} {along:e}", at.residual_norm());
                }
            }
        }
    }
}

/// Coefficients of a motion a moment later, `b(τ + ε)`.
fn later(series: RealSeries, x: &[f64], coordinates: usize, epsilon: f64) -> Vec<f64> {
    let (mut moved, width) = (x.to_vec(), series.width());
    for (d, n) in (0..coordinates).flat_map(|d| (1..=series.n_harmonics).map(move |n| (d, n))) {
        let (c, s) = (d * width + n, d * width + series.sine(n).unwrap());
        let (sin, cos) = (n as f64 * epsilon).sin_cos();
        (moved[c], moved[s]) = (x[c] * cos + x[s] * sin, x[s] * cos - x[c] * sin);
    }
    moved
}

/// Size of the derivative by time of the coefficients.
fn speed(series: RealSeries, x: &[f64], coordinates: usize) -> f64 {
    let h = 1e-5;
    let [before, after] = [-h, h].map(|h| later(series, x, coordinates, h));
    before.iter().zip(&after).map(|(a, b)| ((b - a) / (2.0 * h)).powi(2)).sum::<f64>().sqrt()
}

/// Any motion, with frequency and unfolding behind it.
fn motion(coefficients: usize, seed: f64) -> Vec<f64> {
    (0..coefficients).map(|i| (1.7 * i as f64 + seed).sin()).chain([1.05, 0.0]).collect()
}

/// The anchor of the phase is zero at the accepted motion, and grows with its speed along the same motion a moment
/// later.
fn check_anchor(system: &mut impl ParametricSystem, series: RealSeries, coordinates: usize, hold: bool) {
    let n = system.dim();
    let mut at = Linearization::new(n);
    let mut anchor = |system: &mut dyn FnMut(&[f64], &mut Linearization), x: &[f64]| {
        system(x, &mut at);
        at.residual[n - 1]
    };
    for seed in [0.4, 2.1] {
        let x = motion(n - 2, seed);
        if hold {
            system.accepted(&x, 0.0);
        }
        let mut evaluate =
            |x: &[f64], at: &mut Linearization| assert!(system.linearize(x, 0.0, at).is_ok(), "no contact problem");
        assert!(anchor(&mut evaluate, &x).abs() < 1e-12, "{seed}");
        for epsilon in [1e-5, -1e-5] {
            let moved = anchor(&mut evaluate, &later(series, &x, coordinates, epsilon));
            let expected = epsilon * speed(series, &x, coordinates);
            assert!((moved.abs() / expected.abs() - 1.0).abs() < 1e-3, "{seed}: {moved:e} {expected:e}");
        }
        if !hold {
            // Without an accepted point that of the first evaluation counts.
            return;
        }
    }
}

#[test]
fn the_phase_of_the_last_accepted_motion_is_held() {
    let model = rod(6, 1.0, 1.0, 1.0, &[(6, Side::Positive, 1.0), (2, Side::Negative, 0.45)]);
    let structure = condense(&model);
    for hold in [true, false] {
        let (mut problem, _) = problem(&structure, 1, 3, Symmetry::None, Switching::Exact);
        let series = problem.series();
        check_anchor(&mut problem, series, 2, hold);
    }
    let open = Open::massless(&model);
    let structure = open.structure(ModalDamping::none(open.n_modes()));
    let first = open.omega_squared[0];
    for (coordinates, count) in [(Coordinates::Contact, 2), (Coordinates::Modal, open.n_modes())] {
        let mut system = PeriodicSystem::conservative_mode(
            &structure,
            Symmetry::None,
            settings(3, coordinates),
            Scales::new(1.0, first.sqrt(), first),
            solver().as_ref(),
        )
        .unwrap();
        let series = system.series();
        check_anchor(&mut system, series, count, true);
    }
}

/// Metres or micrometres, seconds or years, kilograms or micrograms: the scaled problem is the same to rounding.
#[test]
fn the_scaled_problem_does_not_know_its_units() {
    let of = |metre: f64, second: f64, kilogram: f64, coordinates: Coordinates, symmetry: Symmetry| {
        let stops = [(6, Side::Positive, metre), (2, Side::Negative, 0.45 * metre)];
        let (force, per_length) = (kilogram * metre / second.powi(2), kilogram / metre);
        let model = rod(6, force, per_length, metre, &stops);
        let (mut at, mut forms) = (Vec::new(), Vec::new());
        let open = Open::massless(&model);
        let w = &open.omega_squared;
        let structure = open.structure(ModalDamping::ratios(w, &[0.02]));
        let scales = Scales::new(metre, w[0].sqrt(), kilogram * w[0] * metre * metre);
        let mut system = match symmetry {
            Symmetry::None => {
                PeriodicSystem::damped_mode(&structure, settings(3, coordinates), scales, solver().as_ref())
            }
            Symmetry::Even => PeriodicSystem::conservative_mode(
                &structure,
                symmetry,
                settings(3, coordinates),
                scales,
                solver().as_ref(),
            ),
        }
        .unwrap();
        let n = system.dim();
        let mut x: Vec<f64> = (0..n).map(|i| 0.9 * (1.7 * i as f64 + 0.4).sin()).collect();
        x[system.n_coefficients()..].iter_mut().zip([1.05, 0.03]).for_each(|(x, given)| *x = given);
        system.hold_phase(&x);
        let mut linear = Linearization::new(n);
        system.linearize(&x, 0.2, &mut linear).unwrap();
        at.extend(linear.residual.iter().copied());
        (0..=n).for_each(|j| forms.extend((0..n).map(|i| linear.jacobian[(i, j)])));
        // Modes have either sign: what is compared does not depend on it only in contact coordinates.
        (at, forms)
    };
    for symmetry in SYMMETRIES {
        let expected = of(1.0, 1.0, 1.0, Coordinates::Contact, symmetry);
        for (metre, second, kilogram) in [(1e-6, 1.0, 1e-3), (1.0, 3e7, 1.0), (1e3, 1e-3, 1e-9)] {
            let found = of(metre, second, kilogram, Coordinates::Contact, symmetry);
            let pairs = found.0.iter().zip(&expected.0).chain(found.1.iter().zip(&expected.1));
            for (a, b) in pairs {
                assert!((a - b).abs() < 1e-8 * (1.0 + b.abs()), "{metre} {second} {kilogram}: {a} {b}");
            }
        }
    }
}

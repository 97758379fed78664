//! Forced responses and damped modes against values of event-driven integration, closed forms and invariants.

mod multipliers;

use crate::support;

use std::f64::consts::{FRAC_PI_2, TAU};

use nlmodes_continuation::{Bound, Branch, Continuation, ParametricSystem};
use nlmodes_hbm::{
    Coordinates, Load, ModalDamping, ModalStructure, PeriodicMotion, PeriodicSystem, PhaseLag, Scales, Symmetry,
    modal_grazing,
};
use nlmodes_model::Side;
use num_complex::Complex64;
use support::modal::{Open, newton, settings, solver};
use support::{bisect, on_springs, rod};

const AUTO: Coordinates = Coordinates::Automatic;

/// Two elements, `EA = ρA = L = g₀ = 1`, the tip without mass, 1 % of damping, and a unit force at the middle.
fn rod_of_two() -> (Open, ModalStructure, Load) {
    let open = Open::massless(&rod(2, 1.0, 1.0, 1.0, &[(2, Side::Positive, 1.0)]));
    let structure = open.structure(ModalDamping::ratios(&open.omega_squared, &[0.01]));
    let load = open.load(&structure, vec![open.force(0, 1, Complex64::ONE)]);
    (open, structure, load)
}

fn unit(structure: &ModalStructure) -> Scales {
    modal_grazing(structure, 1).unwrap().scales()
}

fn run(system: &mut PeriodicSystem, x: &[f64], p: f64, direction: f64, bounds: [f64; 2]) -> Branch {
    let n = system.dim();
    let mut t = vec![0.0; n + 1];
    t[n] = direction;
    let settings = Continuation {
        bounds: vec![Bound { coordinate: n, min: bounds[0], max: bounds[1] }],
        ..Continuation::default()
    };
    settings.run(system, x, p, &t, |_| std::ops::ControlFlow::Continue(())).unwrap()
}

/// All solutions at the level and frequency, with few harmonics, from the curve over the force; carried over to more
/// harmonics.
fn solutions(
    structure: &ModalStructure,
    load: &Load,
    level: f64,
    omega: f64,
    few: usize,
    many: usize,
) -> Vec<PeriodicMotion> {
    let build = |harmonics| {
        PeriodicSystem::force_response(
            structure,
            load.clone(),
            omega,
            level,
            settings(harmonics, AUTO),
            unit(structure),
            solver().as_ref(),
        )
        .unwrap()
    };
    let (mut coarse, mut fine) = (build(few), build(many));
    let zero = vec![0.0; coarse.dim()];
    let branch = run(&mut coarse, &zero, 0.0, 1.0, [-0.1, 3.0]);
    let crossings: Vec<Vec<f64>> = branch
        .points
        .windows(2)
        .filter(|w| (w[0].p - 1.0) * (w[1].p - 1.0) < 0.0)
        .map(|w| if (w[0].p - 1.0).abs() < (w[1].p - 1.0).abs() { w[0].x.clone() } else { w[1].x.clone() })
        .collect();
    let series = coarse.series();
    crossings
        .into_iter()
        .map(|x| {
            let (x, _) = newton(&mut coarse, x, 1.0);
            let x = fine.resized(&x, series);
            let (x, residual) = newton(&mut fine, x, 1.0);
            assert!(residual < 1e-12, "{residual:e}");
            fine.motion(&x, 1.0).unwrap()
        })
        .collect()
}

/// Angle by which the contact position lags the force, degrees. The direction of the contact points away from its stop.
fn lag(motion: &PeriodicMotion) -> f64 {
    -(-motion.contacts[0].free_fundamental).arg().to_degrees()
}

#[test]
fn the_rod_of_two_elements_has_three_responses_with_the_known_amplitudes() {
    let (_, structure, load) = rod_of_two();
    let found = solutions(&structure, &load, 0.2, 0.42 * TAU, 20, 80);
    let expected = [(2.42034024458, 0.3157984185, 31.677157), (1.52905305744, 0.2473334222, 160.714754)];
    for (amplitude, share, angle) in expected {
        let close = |m: &&PeriodicMotion| (m.contacts[0].free_fundamental.norm() - amplitude).abs() < 1e-3;
        let motion = found.iter().find(close).unwrap_or_else(|| panic!("{amplitude} is not among {}", found.len()));
        let contact = &motion.contacts[0];
        assert!((contact.free_fundamental.norm() - amplitude).abs() < 1e-8, "{}", contact.free_fundamental.norm());
        assert!((contact.closed_share - share).abs() < 1e-7, "{}", contact.closed_share);
        assert!((lag(motion) - angle).abs() < 1e-5, "{}", lag(motion));
        assert!((motion.input_power / motion.dissipated_power - 1.0).abs() < 1e-12);
    }
}

#[test]
fn phase_resonance_of_the_rod_is_where_it_is_known_to_be() {
    let (open, structure, load) = rod_of_two();
    let build = |harmonics| {
        let drive = PhaseLag { row: open.row(0, true), harmonic: 1, lag: FRAC_PI_2 };
        let touching = 0.2;
        PeriodicSystem::phase_resonance(
            &structure,
            load.clone(),
            drive,
            touching,
            settings(harmonics, AUTO),
            unit(&structure),
            solver().as_ref(),
        )
        .unwrap()
    };
    let (mut coarse, mut fine) = (build(20), build(80));
    // Linear phase resonance at a hundredth of the force: q = F φ²/(i ω ω₁ 2ζ) lags by 90 degrees at ω₁ but for what
    // the tip adds statically.
    let (k, width) = (0, coarse.series().width());
    let omega = open.omega_squared[k].sqrt();
    let row = structure.rows()[(0, k)];
    let level = 0.2 * (-4.0_f64).exp();
    let amplitude = row * open.shapes[(0, k)] * level / (0.02 * omega * omega);
    let mut x = vec![0.0; coarse.dim()];
    x[width / 2 + 1] = amplitude / coarse.unit();
    x[coarse.n_coefficients()] = 1.0;
    let (x, residual) = newton(&mut coarse, x, -4.0);
    assert!(residual < 1e-12, "{residual:e}");
    let branch = run(&mut coarse, &x, -4.0, 1.0, [-5.0, 0.0]);
    let last = branch.points.last().unwrap();
    assert!(last.p.abs() < 1e-12, "{:?}", branch.stop);
    let x = fine.resized(&last.x, coarse.series());
    let (x, residual) = newton(&mut fine, x, 0.0);
    assert!(residual < 1e-12);
    let motion = fine.motion(&x, 0.0).unwrap();
    assert!((motion.at.omega / TAU - 0.4400260004).abs() < 1e-9, "{}", motion.at.omega / TAU);
    assert!((motion.contacts[0].free_fundamental.norm() - 4.39277069957).abs() < 1e-8);
    assert!((motion.contacts[0].closed_share - 0.3619577474).abs() < 1e-7);
    assert!((motion.input_power / motion.dissipated_power - 1.0).abs() < 1e-12);
    let floquet = fine.floquet(&x, 0.0, solver().as_ref()).unwrap();
    assert!((floquet.largest().re - 0.9529337).abs() < 1e-5, "{:?}", floquet);
}

fn follow_mode(system: &mut PeriodicSystem, structure: &ModalStructure, to: f64) -> Branch {
    let start = modal_grazing(structure, 1).unwrap();
    let (x, direction) = (start.unknowns(system), start.direction(system));
    system.hold_phase(&x);
    let n = system.dim();
    let settings =
        Continuation { bounds: vec![Bound { coordinate: n, min: -2.0, max: to }], ..Continuation::default() };
    settings.run(system, &x, 0.0, &direction, |_| std::ops::ControlFlow::Continue(())).unwrap()
}

#[test]
fn the_damped_mode_of_the_rod_has_the_known_energy_and_damping() {
    let (_, structure, _) = rod_of_two();
    let build =
        |h| PeriodicSystem::damped_mode(&structure, settings(h, AUTO), unit(&structure), solver().as_ref()).unwrap();
    let mut coarse = build(20);
    let target = 0.4178528340455725 * TAU;
    let branch = follow_mode(&mut coarse, &structure, 6.0);
    let index = coarse.n_coefficients();
    let omega = |x: &[f64]| x[index] * structure.omega_squared()[0].sqrt();
    let at = branch.points.windows(2).find(|w| (omega(&w[0].x) - target) * (omega(&w[1].x) - target) <= 0.0).unwrap();
    let mut fine = build(80);
    let start = fine.resized(&at[0].x, coarse.series());
    let fine_index = fine.n_coefficients();
    fine.hold_phase(&start);
    let fine = std::cell::RefCell::new(fine);
    let solve = |p: f64| newton(&mut fine.borrow_mut(), start.clone(), p);
    let off = |p: f64| solve(p).0[fine_index] * structure.omega_squared()[0].sqrt() - target;
    let p = bisect(off, at[0].p, at[1].p);
    let (x, residual) = solve(p);
    assert!(residual < 1e-12);
    let mut fine = fine.into_inner();
    let motion = fine.motion(&x, p).unwrap();
    assert!((motion.kinetic_energy / 2.076372313358 - 1.0).abs() < 1e-8, "{}", motion.kinetic_energy);
    assert!((motion.damping_ratio() / 9.329801519889e-3 - 1.0).abs() < 1e-8, "{:e}", motion.damping_ratio());
    assert!((motion.at.xi * 2.0 * motion.kinetic_energy / motion.dissipated_power - 1.0).abs() < 1e-12);
}

/// Rods whose damped modes are compared with conservative ones: in two systems of units, one and two stops.
fn rods() -> Vec<Open> {
    let two = [(6, Side::Positive, 1.0), (2, Side::Negative, 0.45)];
    vec![
        Open::massless(&rod(6, 1.0, 1.0, 1.0, &two[..1])),
        Open::massless(&rod(6, 1.0, 1.0, 1.0, &two)),
        Open::massless(&rod(6, 210e9, 9000.0, 20.0, &[(6, Side::Positive, 1e-3)])),
    ]
}

#[test]
fn damping_proportional_to_mass_leaves_the_conservative_mode_and_none_leaves_no_power() {
    for (open, coordinates) in rods().iter().flat_map(|o| [(o, Coordinates::Contact), (o, Coordinates::Modal)]) {
        let first = open.omega_squared[0].sqrt();
        let (zeta, h) = (0.02, 6);
        let damped = open.structure(ModalDamping::rayleigh(&open.omega_squared, 2.0 * zeta * first, 0.0));
        let scales = unit(&damped);
        let mut even = PeriodicSystem::conservative_mode(
            &damped,
            Symmetry::Even,
            settings(h, coordinates),
            scales,
            solver().as_ref(),
        )
        .unwrap();
        let branch = follow_mode(&mut even, &damped, 0.8);
        let last = branch.points.last().unwrap();
        assert!((last.p - 0.8).abs() < 1e-12, "{:?}", branch.stop);
        let conservative = even.motion(&last.x, last.p).unwrap();
        let none = open.structure(ModalDamping::none(open.n_modes()));
        for (structure, expected) in [(&damped, zeta * first / conservative.at.omega), (&none, 0.0)] {
            let mut system =
                PeriodicSystem::damped_mode(structure, settings(h, coordinates), scales, solver().as_ref()).unwrap();
            let branch = follow_mode(&mut system, structure, 0.8);
            let last = branch.points.last().unwrap();
            assert!((last.p - 0.8).abs() < 1e-12, "{:?}", branch.stop);
            let motion = system.motion(&last.x, last.p).unwrap();
            assert!(
                (motion.at.omega / conservative.at.omega - 1.0).abs() < 1e-9,
                "{}",
                motion.at.omega / conservative.at.omega
            );
            assert!((motion.damping_ratio() - expected).abs() < 1e-11, "{} {expected}", motion.damping_ratio());
        }
    }
}

#[test]
fn open_modes_with_all_modes_give_the_branch_of_the_held_modes() {
    let model = rod(10, 210e9, 9000.0, 20.0, &[(10, Side::Positive, 1e-3)]);
    let open = Open::massless(&model);
    let structure = open.structure(ModalDamping::none(open.n_modes()));
    let held = support::condense(&model);
    let (mut problem, start) = support::problem(&held, 1, 7, Symmetry::Even, nlmodes_hbm::Switching::Exact);
    let reference = support::follow(&mut problem, &start, 3.0);
    let expected = reference.points.last().unwrap();
    for coordinates in [Coordinates::Contact, Coordinates::Modal] {
        let mut system = PeriodicSystem::conservative_mode(
            &structure,
            Symmetry::Even,
            settings(7, coordinates),
            unit(&structure),
            solver().as_ref(),
        )
        .unwrap();
        let branch = follow_mode(&mut system, &structure, 3.0_f64.ln());
        let last = branch.points.last().unwrap();
        let omega = system.operating_point(&last.x, last.p).omega;
        let point = held.modal_point(&mut problem, &expected.x, 0.0).unwrap();
        let motion = system.motion(&last.x, last.p).unwrap();
        assert!((motion.total_energy / point.total_energy - 1.0).abs() < 1e-9);
        let expected = expected.x[problem.n_coefficients()] * problem.scales().omega;
        assert!((omega / expected - 1.0).abs() < 1e-9, "{coordinates:?}: {omega} {expected}");
    }
}

#[test]
fn a_response_that_does_not_touch_is_the_linear_one_and_so_is_one_with_a_vanishing_stop() {
    let model = rod(6, 1.0, 1.0, 1.0, &[(6, Side::Positive, 1.0)]);
    let mut touched = false;
    for (soft, level) in [(false, 1e-4), (true, 50.0)] {
        let model = if soft { on_springs(&model, &[1e-15]) } else { model.clone() };
        let open = if soft { Open::lowest(&model, 6) } else { Open::massless(&model) };
        let structure = open.structure(ModalDamping::ratios(&open.omega_squared, &[0.02, 0.01]));
        let load = open.load(&structure, vec![open.force(3, 1, Complex64::cis(0.4)), open.force(5, 3, Complex64::ONE)]);
        for omega in [0.7, 1.0, 3.3].map(|f| f * open.omega_squared[0].sqrt()) {
            for coordinates in [Coordinates::Contact, Coordinates::Modal] {
                let mut system = PeriodicSystem::force_response(
                    &structure,
                    load.clone(),
                    omega,
                    1.0,
                    settings(5, coordinates),
                    unit(&structure),
                    solver().as_ref(),
                )
                .unwrap();
                let zero = vec![0.0; system.dim()];
                let (x, _) = newton(&mut system, zero, level);
                let motion = system.motion(&x, level).unwrap();
                assert!(soft || motion.contacts[0].touches == 0);
                touched |= motion.contacts[0].touches > 0;
                for (n, dof, phase) in [(1, 3, 0.4), (3, 5, 0.0)] {
                    let nu = n as f64 * omega;
                    for k in 0..open.n_modes() {
                        let d = Complex64::new(open.omega_squared[k] - nu * nu, nu * structure.damping().entry(k, k));
                        let expected = Complex64::cis(phase) * open.shapes[(dof, k)] * level / d;
                        assert!((motion.eta[n][k] - expected).norm() < 1e-12 * level.max(expected.norm()));
                    }
                }
            }
        }
    }
    assert!(touched);
}

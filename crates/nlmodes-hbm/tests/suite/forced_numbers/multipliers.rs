//! Floquet multipliers of forced responses.

use std::f64::consts::TAU;

use nlmodes_continuation::ParametricSystem;
use nlmodes_hbm::{Floquet, Load, ModalDamping, ModalStructure, PeriodicSystem, Scales};
use nlmodes_model::{Contact, ContactLaw, Dof, DofKind, Side, StructuralModel};
use num_complex::Complex64;

use super::support::modal::{Open, newton, settings, solver};
use super::{AUTO, rod_of_two, run, unit};

/// NLvib's example 03: `M = I`, `K = [1 −1; −1 2]`, `C = 0.03 K`, a one-sided spring of 100 with gap 1 at mass 1, a
/// force of 0.1 at mass 2.
fn two_masses() -> (Open, ModalStructure, Load) {
    let k =
        nlmodes_linalg::sparse_from_triplets(2, 2, &[(0, 0, 1.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 2.0)]).unwrap();
    let m = nlmodes_linalg::sparse_from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0)]).unwrap();
    let dof = |node| Dof { node, position: node as f64, kind: DofKind::Axial };
    let stop = Contact { law: ContactLaw::Elastic { stiffness: 100.0 }, ..Contact::rigid(0, Side::Positive, 1.0) };
    let model = StructuralModel::new(m, k, vec![dof(0), dof(1)], vec![stop]).unwrap();
    let open = Open::lowest(&model, 2);
    let structure = open.structure(ModalDamping::rayleigh(&open.omega_squared, 0.0, 0.03));
    let load = open.load(&structure, vec![open.force(1, 1, Complex64::new(0.1, 0.0))]);
    (open, structure, load)
}

#[test]
fn the_peak_of_two_masses_is_the_one_known_and_its_multiplier_too() {
    let (open, structure, load) = two_masses();
    let build = |h| {
        PeriodicSystem::frequency_response(
            &structure,
            load.clone(),
            1.0,
            1.0,
            settings(h, AUTO),
            Scales::new(1.0, 1.0, 1.0),
            solver().as_ref(),
        )
        .unwrap()
    };
    let (mut coarse, mut fine) = (build(13), build(63));
    let zero = vec![0.0; coarse.dim()];
    let (x, _) = newton(&mut coarse, zero, 0.3);
    let branch = run(&mut coarse, &x, 0.3, 1.0, [0.2, 1.0]);
    let row = open.row(1, false);
    let amplitude =
        |system: &mut PeriodicSystem, x: &[f64], p: f64| system.motion(x, p).unwrap().displacement(&row)[1].norm();
    let best = branch.points.iter().max_by(|a, b| {
        let of = |q: &nlmodes_continuation::BranchPoint| amplitude(&mut build(13), &q.x, q.p);
        of(a).total_cmp(&of(b))
    });
    let best = best.unwrap();
    let mut x = fine.resized(&best.x, coarse.series());
    // The top of a parabola through three points, twice.
    let mut omega = 0.7511845540;
    for _ in 0..3 {
        let h = 1e-4;
        let mut of = |w: f64| {
            let (solved, residual) = newton(&mut fine, x.clone(), w);
            assert!(residual < 1e-11, "{residual:e} at {w}");
            x = solved;
            amplitude(&mut fine, &x, w)
        };
        let (a, b, c) = (of(omega - h), of(omega), of(omega + h));
        omega += 0.5 * h * (a - c) / (a - 2.0 * b + c);
    }
    let (x, _) = newton(&mut fine, x, omega);
    let peak = amplitude(&mut fine, &x, omega);
    assert!((peak - 0.9363067661).abs() < 1e-9, "{peak} at {omega}");
    assert!((omega - 0.7511845540).abs() < 1e-5, "{omega}");
    let floquet = fine.floquet(&x, omega, solver().as_ref()).unwrap();
    let off = (floquet.largest().re + 1.1924192).abs();
    assert!(off < 3e-3 && off < floquet.error, "{floquet:?}");
    let stability = floquet.stability();
    assert_eq!((stability.stable, stability.loss()), (Some(false), Some(nlmodes_modal::Event::PeriodDoubling)));
    let product: Complex64 = floquet.multipliers.iter().product();
    let expected = (-structure.damping().trace() * TAU / omega).exp();
    assert!((product.re / expected - 1.0).abs() < 1e-9 && product.im.abs() < 1e-9 * expected);
}

/// Two masses without damping and all but without contact, a spring of 1e-12 of their own, at twice the first
/// frequency: after a period the first is where it was with the other sign, and its disturbance is a sine of half the
/// frequency. The second, at 2.5 times the first frequency, turns by 5/4.
#[test]
fn the_disturbance_at_a_period_doubling_is_a_sine_of_half_the_frequency() {
    for unit in [1.0, 250.0] {
        let matrix = |values: [f64; 2]| {
            nlmodes_linalg::sparse_from_triplets(2, 2, &[(0, 0, values[0]), (1, 1, values[1])]).unwrap()
        };
        let dof = |node| Dof { node, position: node as f64, kind: DofKind::Axial };
        let (m, k) = (matrix([1.0; 2]), matrix([unit * unit, 6.25 * unit * unit]));
        let stop = Contact {
            law: ContactLaw::Elastic { stiffness: 1e-12 * unit * unit },
            ..Contact::rigid(0, Side::Positive, 1.0)
        };
        let open = Open::lowest(&StructuralModel::new(m, k, vec![dof(0), dof(1)], vec![stop]).unwrap(), 2);
        let structure = open.structure(ModalDamping::none(2));
        let load = open.load(&structure, vec![open.force(1, 1, Complex64::new(0.1, 0.0))]);
        let (settings, scales) = (settings(5, AUTO), Scales::new(1.0, unit, unit * unit));
        let mut system =
            PeriodicSystem::frequency_response(&structure, load, 1.0, unit, settings, scales, solver().as_ref())
                .unwrap();
        let still = vec![0.0; system.dim()];
        // One that comes to the spring for a part of the period.
        let mut pressed = still.clone();
        pressed[1] = 3.0;
        let share = |system: &mut PeriodicSystem, x: &[f64]| system.motion(x, 2.0).unwrap().contacts[0].closed_share;
        assert!(share(&mut system, &still) == 0.0 && share(&mut system, &pressed) > 0.1);
        let found = [still, pressed].map(|x| system.doubling_disturbance(&x, 2.0, 7).unwrap());
        assert!(found.iter().all(|found| found.len() == 8));
        for (k, eta) in found.iter().flat_map(|found| found.iter().enumerate()) {
            // Simpson's rule with 24 samples for each of eight harmonics of a turn.
            let [first, second] = [eta[0].norm(), eta[1].norm()];
            let expected = if k == 1 { 1.0 } else { 0.0 };
            assert!((first - expected).abs() < 1e-6 && second < 1e-6, "{k}: {eta:?}");
        }
    }
}

/// Largest multipliers, with their errors, of the two responses of the rod at 0.42 Hz whose amplitudes are known to
/// `within`, and the known ones.
fn multipliers_of_the_rod(harmonics: usize, within: f64) -> Vec<(Floquet, Complex64)> {
    let (_, structure, load) = rod_of_two();
    let (level, omega) = (0.2, 0.42 * TAU);
    let mut system = PeriodicSystem::force_response(
        &structure,
        load,
        omega,
        level,
        settings(harmonics, AUTO),
        unit(&structure),
        solver().as_ref(),
    )
    .unwrap();
    let zero = vec![0.0; system.dim()];
    let branch = run(&mut system, &zero, 0.0, 1.0, [-0.1, 3.0]);
    let mut found = Vec::new();
    for w in branch.points.windows(2).filter(|w| (w[0].p - 1.0) * (w[1].p - 1.0) < 0.0) {
        let (x, _) = newton(&mut system, w[0].x.clone(), 1.0);
        let floquet = system.floquet(&x, 1.0, solver().as_ref()).unwrap();
        let amplitude = system.motion(&x, 1.0).unwrap().contacts[0].free_fundamental.norm();
        let expected = match amplitude {
            a if (a - 2.42034).abs() < within => Complex64::new(0.9198996, 0.2090172),
            a if (a - 1.52905).abs() < within => Complex64::new(1.2534129, 0.0),
            _ => continue,
        };
        found.push((floquet, expected));
    }
    found
}

#[test]
fn multipliers_of_the_responses_of_the_rod_are_the_known_ones() {
    let found = multipliers_of_the_rod(40, 1e-3);
    assert_eq!(found.len(), 2);
    for (floquet, expected) in found {
        let largest = floquet.largest();
        assert!((largest - expected).norm() < 1e-5, "{largest} for {expected}, error {:e}", floquet.error);
        assert_eq!(floquet.stability().stable, Some(largest.norm() < 1.0));
    }
}

#[test]
fn multipliers_lie_within_their_error_however_few_the_harmonics() {
    for harmonics in [4, 5, 6, 7, 8, 9, 11, 13, 16, 20, 28] {
        let found = multipliers_of_the_rod(harmonics, 0.1);
        assert_eq!(found.len(), 2, "{harmonics} harmonics");
        for (floquet, expected) in found {
            let off = (floquet.largest().norm() - expected.norm()).abs();
            println!("{harmonics}: off {off:.2e}, error {:.2e}", floquet.error);
            assert!(off < floquet.error + 1e-6, "{harmonics} harmonics: {off:e} off, {floquet:?}");
        }
    }
}

//! Invariants for any structure: energy, reversibility, the equations of motion, the contact law, derivatives.

use crate::support;

use nlmodes_continuation::conformance::jacobian_defect;
use nlmodes_continuation::{Linearization, ParametricSystem};
use nlmodes_fem::{Direction, Stop};
use nlmodes_linalg::{bilinear, multiply};
use nlmodes_modal::HarmonicCoefficients;
use nlmodes_model::{ContactLaw, DofKind, Drop, MasslessContactModel, Move, Side, StructuralModel, linear_modes};
use nlmodes_timestep::{ContactDynamics, Floquet, ModalState, PeriodicMotion, Shooting, ShootingScales, StateEnergy};
use num_complex::Complex64;
use std::f64::consts::PI;
use support::{beam, dynamics, massless, rod_with, unit_rod, with_rule};

fn rod_between_stops() -> StructuralModel {
    let stop = |at, side, gap| Stop::rigid(at, Direction::Axial, side, gap);
    rod_with(12, &[stop(1.0, Side::Positive, 0.5), stop(1.0, Side::Negative, 0.7), stop(0.5, Side::Positive, 0.3)])
}

fn soft_and_hard() -> StructuralModel {
    let stop = |at, side, gap| Stop::rigid(at, Direction::Axial, side, gap);
    rod_with(12, &[stop(1.0, Side::Positive, 0.5).on_spring(3.0), stop(0.5, Side::Negative, 0.2)])
}

fn beam_before_three_stops() -> StructuralModel {
    let beam = beam(9, &[]);
    let at = |i: usize| beam.dofs().iter().filter(|d| d.kind == DofKind::Deflection).nth(i).unwrap().position;
    let stop = |at, side, gap| Stop::rigid(at, Direction::Transverse, side, gap);
    support::beam(
        9,
        &[
            stop(at(8), Side::Positive, 1e-3),
            stop(at(6), Side::Positive, 0.5e-3).on_spring(1e6),
            stop(at(4), Side::Negative, 0.2e-3),
        ],
    )
}

/// The structures and, for each, the initial tip deflection in its first mode.
fn structures() -> Vec<(&'static str, MasslessContactModel, f64)> {
    let tips = MasslessContactModel::with_spring_tips(
        &rod_with(6, &[Stop::rigid(1.0, Direction::Axial, Side::Positive, 0.5).on_spring(20.0)]),
        None,
    );
    vec![
        ("rod of ten elements", massless(&unit_rod(10)), -3.0),
        ("rod, mass moved", with_rule(&unit_rod(10), &Move), -3.0),
        ("rod between stops", massless(&rod_between_stops()), -0.6),
        ("rod, soft and hard stop", massless(&soft_and_hard()), -1.5),
        (
            "rod pressed at rest",
            massless(&rod_with(8, &[Stop::rigid(1.0, Direction::Axial, Side::Positive, -0.2)])),
            -1.0,
        ),
        ("rod, spring tips", tips.unwrap(), -3.0),
        ("beam before three stops", with_rule(&beam_before_three_stops(), &Drop), -4e-3),
    ]
}

/// Released from rest in the first mode, with small amplitudes of others; for some ten of its periods or, for the
/// chattering beam, a third of one.
fn let_go(model: &MasslessContactModel, tip: f64) -> (ContactDynamics, ModalState, f64) {
    let modes = linear_modes(model.mass(), model.stiffness(), usize::MAX).unwrap();
    let last = model.contacts()[0].dof;
    let n = model.dofs().len();
    let mut q: Vec<f64> = (0..n).map(|i| tip / modes.shapes[(last, 0)] * modes.shapes[(i, 0)]).collect();
    let is_beam = model.dofs()[last].kind == DofKind::Deflection;
    for k in 1..modes.omega.len().min(if is_beam { 4 } else { usize::MAX }) {
        let share = 0.1 * tip * modes.omega[0] / modes.omega[k] / modes.shapes[(last, 0)];
        (0..n).for_each(|i| q[i] += share * modes.shapes[(i, k)] / (k + 1) as f64);
    }
    let dynamics = ContactDynamics::new(model.clone()).unwrap();
    let state = dynamics.state(&q, &vec![0.0; n]).unwrap();
    (dynamics, state, if is_beam { 2.2 } else { 60.0 } / modes.omega[0])
}

/// Kinetic and strain energy and that of the springs of elastic stops, from the matrices.
fn energy(model: &MasslessContactModel, q: &[f64], v: &[f64]) -> f64 {
    let springs = model.contacts().iter().map(|c| match c.law {
        ContactLaw::Rigid => 0.0,
        ContactLaw::Elastic { stiffness } => 0.5 * stiffness * (c.side.sign() * q[c.dof] - c.gap).max(0.0).powi(2),
    });
    0.5 * bilinear(v, model.mass(), v) + 0.5 * bilinear(q, model.stiffness(), q) + springs.sum::<f64>()
}

#[test]
fn energy_of_a_state_from_matrices_is_that_of_its_modes() {
    for (name, model, tip) in structures() {
        let (mut dynamics, _, _) = let_go(&model, tip);
        let modes = linear_modes(model.mass(), model.stiffness(), 3).unwrap();
        let last = model.contacts()[0].dof;
        let mut motion = HarmonicCoefficients::zeros(model.dofs().len(), 3);
        for d in 0..model.dofs().len() {
            for k in 0..modes.omega.len() {
                let share = tip * modes.shapes[(d, k)] / modes.shapes[(last, 0)] / (3 * k * k + 1) as f64;
                motion.of_mut(d)[k + 1] = Complex64::from_polar(share, 0.3 * k as f64);
            }
        }
        let (omega, mut energy) = (modes.omega[0], StateEnergy::new(&model).unwrap());
        let mut contacts = 0;
        for j in 0..40 {
            let tau = 0.05 * PI * f64::from(j);
            let state = dynamics.state_of_harmonics(&motion, omega, tau).unwrap();
            let expected = dynamics.energy(&state).unwrap();
            let found = energy.of_harmonics(&motion, omega, tau).unwrap();
            let tolerance = if name.starts_with("beam") { 1e-7 } else { 1e-11 };
            assert!((found / expected - 1.0).abs() < tolerance, "{name}, {tau}: {found} for {expected}");
            let forces = dynamics.propagate(&state, 1e-6 / omega).unwrap().at(0.0).forces;
            contacts += usize::from(forces.iter().any(|force| *force > 0.0));
        }
        assert!((5..40).contains(&contacts), "{name}: in contact at {contacts} of 40 instants");
    }
}

#[test]
fn energy_is_kept_to_rounding_over_hundreds_of_contacts() {
    for (name, model, tip) in structures() {
        let (mut dynamics, state, time) = let_go(&model, tip);
        let trajectory = dynamics.propagate(&state, 10.0 * time).unwrap();
        let first = trajectory.energies()[0];
        let drift = trajectory.energies().iter().fold(0.0_f64, |m, e| m.max((e / first - 1.0).abs()));
        let contacts = trajectory.closed_intervals().len();
        assert!(contacts > 60, "{name}: {contacts} contacts");
        // A rounding error at each change of modes: they accumulate like a random walk.
        assert!(drift < 1e-12, "{name}: {drift:e} over {contacts} contacts");
        for j in 0..200 {
            let at = trajectory.at(10.0 * time * f64::from(j) / 200.0);
            let by_matrices = energy(&model, &at.displacement, &at.velocity);
            // The beam's matrices themselves lose seven digits: the strain energy is a small difference of large terms.
            let tolerance = if name.starts_with("beam") { 1e-8 } else { 1e-12 };
            assert!((by_matrices / first - 1.0).abs() < tolerance, "{name}: {:e}", by_matrices / first - 1.0);
        }
    }
}

#[test]
fn the_contact_law_and_the_equations_of_motion_hold_at_any_instant() {
    for (name, model, tip) in structures() {
        let (mut dynamics, state, time) = let_go(&model, tip);
        let trajectory = dynamics.propagate(&state, time).unwrap();
        let all = (0..400).flat_map(|j| trajectory.at(time * f64::from(j) / 400.0).forces);
        let (largest_force, mut tested) = (all.fold(0.0, f64::max), 0);
        for j in 1..400 {
            let t = time * f64::from(j) / 400.0;
            let at = trajectory.at(t);
            let length = tip.abs();
            for (i, c) in model.contacts().iter().enumerate() {
                let yields = at.forces[i] * c.law.compliance();
                let gap = c.gap - c.side.sign() * at.displacement[c.dof] + yields;
                let name = format!("{name}, contact {i} at {t}: gap {gap:e}, force {:e}", at.forces[i]);
                assert!(gap > -1e-11 * length && at.forces[i] > -1e-11 * largest_force, "{name}");
                assert!(gap.abs() < 1e-11 * length || at.forces[i].abs() < 1e-11 * largest_force, "{name}");
                tested += usize::from(at.forces[i] > 0.0);
            }
            // M q̈ + K q = W λ with q̈ by differences of the velocity; the massless rows need none.
            let h = 1e-5 * time / 60.0;
            let (before, after) = (trajectory.at(t - h), trajectory.at(t + h));
            let acceleration: Vec<f64> =
                before.velocity.iter().zip(&after.velocity).map(|(a, b)| (b - a) / (2.0 * h)).collect();
            let inertia = multiply(model.mass(), &acceleration);
            let mut elastic = multiply(model.stiffness(), &at.displacement);
            for (i, c) in model.contacts().iter().enumerate() {
                elastic[c.dof] -= c.direction() * at.forces[i];
            }
            let scale = elastic.iter().zip(&inertia).fold(0.0_f64, |m, (e, i)| m.max(e.abs()).max(i.abs()));
            let defect = elastic.iter().zip(&inertia).fold(0.0_f64, |m, (e, i)| m.max((e + i).abs()));
            // Second differences across a kink of the acceleration, and rounding of stiff rows.
            assert!(defect < 2e-3 * scale, "{name} at {t}: {defect:e} of {scale:e}");
        }
        assert!(tested > 10, "{name}: hardly any contact");
    }
}

#[test]
fn a_motion_run_backwards_comes_back() {
    for (name, model, tip) in structures() {
        let (mut dynamics, state, time) = let_go(&model, tip);
        let mut there = dynamics.propagate(&state, 0.5 * time).unwrap().end;
        there.v.iter_mut().for_each(|v| *v = -*v);
        let back = dynamics.propagate(&there, 0.5 * time).unwrap().end;
        let omega = dynamics.omega().to_vec();
        let norm = |z: &[f64]| omega.iter().zip(z).map(|(ω, z)| (ω * z).powi(2)).sum::<f64>().sqrt();
        let gap: Vec<f64> = back.z.iter().zip(&state.z).map(|(a, b)| a - b).collect();
        let missing = norm(&gap) / norm(&state.z);
        // The tip of the beam chatters: in its 94 contacts forward and back, each amplifies rounding errors by half.
        let tolerance = if name.starts_with("beam") { 1e-5 } else { 1e-12 };
        assert!(missing < tolerance, "{name}: {missing:e}");
    }
}

#[test]
fn the_motion_is_that_of_small_steps_of_runge_and_kutta() {
    // On M_LL q̈ = −K_0 q + B λ(q), right-hand side from the matrices, for the rod of four elements with one stop.
    let model = massless(&unit_rod(4));
    let n = 3;
    let (k, m) = (model.stiffness().to_dense(), model.mass().to_dense());
    let inverse = {
        let block = nlmodes_linalg::Mat::from_fn(n, n, |i, j| m[(i, j)]);
        nlmodes_linalg::DenseLu::factor(&block).unwrap()
    };
    let acceleration = |q: &[f64]| {
        let tip = (-(0..n).map(|j| k[(n, j)] * q[j]).sum::<f64>() / k[(n, n)]).min(1.0);
        let mut a: Vec<f64> =
            (0..n).map(|i| -(0..n).map(|j| k[(i, j)] * q[j]).sum::<f64>() - k[(i, n)] * tip).collect();
        inverse.solve_in_place(&mut a);
        a
    };
    let start = [-0.9, -1.7, -2.3];
    let mut dynamics = dynamics(&unit_rod(4));
    let state = dynamics.state(&[start[0], start[1], start[2], 0.0], &[0.0; 4]).unwrap();
    let trajectory = dynamics.propagate(&state, 6.0).unwrap();
    assert!(trajectory.closed_intervals().len() >= 2);
    let add = |x: &[f64], s: f64, y: &[f64]| x.iter().zip(y).map(|(x, y)| x + s * y).collect::<Vec<f64>>();
    let largest_difference = |steps: u32| {
        let (mut q, mut v, mut worst) = (start.to_vec(), vec![0.0; n], 0.0_f64);
        let h = 6.0 / f64::from(steps);
        for step in 1..=steps {
            let k1 = (v.clone(), acceleration(&q));
            let k2 = (add(&v, h / 2.0, &k1.1), acceleration(&add(&q, h / 2.0, &k1.0)));
            let k3 = (add(&v, h / 2.0, &k2.1), acceleration(&add(&q, h / 2.0, &k2.0)));
            let k4 = (add(&v, h, &k3.1), acceleration(&add(&q, h, &k3.0)));
            for (w, k) in [(1.0, &k1), (2.0, &k2), (2.0, &k3), (1.0, &k4)] {
                (q, v) = (add(&q, w * h / 6.0, &k.0), add(&v, w * h / 6.0, &k.1));
            }
            if step % (steps / 100) == 0 {
                let at = trajectory.at(h * f64::from(step));
                worst = (0..n).fold(worst, |m, i| m.max((at.displacement[i] - q[i]).abs()));
            }
        }
        worst
    };
    // In steps across the contact instants, where a derivative of the right-hand side jumps, the error is h² and more.
    let [coarse, fine] = [10_000, 160_000].map(largest_difference);
    assert!(fine < 5e-9 && fine < coarse / 100.0, "{coarse:e}, {fine:e}");
}

#[test]
fn derivatives_of_the_shooting_equations_are_those_by_differences() {
    // The beam with three stops is replaced by that with one: a difference step small enough for a chattering motion is
    // below rounding.
    let stop = Stop::rigid(0.62975520, Direction::Transverse, Side::Positive, 1e-3);
    let one_stop = ("beam", massless(&beam(5, &[stop])), -4e-3);
    for (name, model, tip) in structures().into_iter().take(6).chain([one_stop]) {
        let (dynamics, state, _) = let_go(&model, tip);
        let omega = dynamics.omega()[0];
        // Half a period with a contact, for the beam before its tip has chattered for long.
        let factor = if name == "beam" { 1.5 } else { 1.1 };
        let energy = 0.5 * state.z.iter().zip(dynamics.omega()).map(|(z, ω)| (ω * z).powi(2)).sum::<f64>();
        let mut shooting = Shooting::new(dynamics, ShootingScales { omega, energy }).unwrap();
        let x = shooting.unknowns(&state, factor * omega);
        // Third derivatives grow with the ratio of frequencies; the beam's highest is some ten thousand times its
        // lowest.
        let (step, tolerance) = if name.starts_with("beam") { (1e-8, 1e-4) } else { (1e-6, 1e-6) };
        let defect = jacobian_defect(&mut shooting, &x, 0.1, step).unwrap();
        assert!(defect < tolerance, "{name}: {defect:e}");
        let mut at = Linearization::new(shooting.dim());
        shooting.linearize(&x, 0.1, &mut at).unwrap();
        let motion = shooting.motion(&x).unwrap();
        // Away from a periodic motion the mean is that over the first half.
        let half = shooting.dynamics().propagate(&state, std::f64::consts::PI / (factor * omega)).unwrap();
        assert!(!half.closed_intervals().is_empty(), "{name}");
        let mean = half.kinetic_integral() * factor * omega / std::f64::consts::PI;
        assert!((at.residual[shooting.frequency_index()] - (mean / energy).ln() + 0.1).abs() < 1e-12);
        assert!(motion.kinetic_energy > 0.0);
    }
}

#[test]
fn multipliers_of_a_linear_motion_are_those_of_its_other_modes() {
    // The second mode without contact: e^{±iω_k T} of all others, in addition to its own double one.
    let mut dynamics = dynamics(&unit_rod(10));
    let omega = dynamics.omega().to_vec();
    let mut state = ModalState { z: vec![0.0; omega.len()], v: vec![0.0; omega.len()] };
    state.z[1] = 0.05;
    let motion = PeriodicMotion::new(&mut dynamics, state, omega[1]).unwrap();
    let floquet = Floquet::new(&mut dynamics, &motion).unwrap();
    assert_eq!(floquet.multipliers.len(), 2 * omega.len() - 2);
    assert!(floquet.is_stable() && floquet.largest() < 1.0 + 1e-11 && floquet.trivial_defect < 1e-12);
    for (k, ω) in omega.iter().enumerate().filter(|(k, _)| *k != 1) {
        let angle = ω * std::f64::consts::TAU / omega[1];
        for expected in [angle, -angle] {
            let nearest = floquet.multipliers.iter().map(|μ| (μ - num_complex::Complex64::cis(expected)).norm());
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-11, "mode {k}: {nearest:e}");
        }
    }
}

#[test]
fn stops_that_touch_or_press_at_rest_and_stops_on_both_sides_are_no_obstacle() {
    let stop = |at, side, gap| Stop::rigid(at, Direction::Axial, side, gap);
    let (up, down) = (Side::Positive, Side::Negative);
    let cases: Vec<(&str, Vec<Stop>)> = vec![
        ("touching", vec![stop(1.0, up, 0.0)]),
        ("touching on both sides, one soft", vec![stop(1.0, up, 0.0), stop(1.0, down, 0.0).on_spring(5.0)]),
        ("a narrow slot", vec![stop(1.0, up, 1e-6), stop(1.0, down, 1e-6)]),
        ("pressed twice", vec![stop(1.0, up, -0.3), stop(0.5, up, -0.1)]),
        ("neighbours that touch at once", vec![stop(0.5, up, 0.2), stop(0.75, up, 0.3), stop(1.0, up, 0.4)]),
    ];
    for (name, stops) in cases {
        let model = massless(&rod_with(8, &stops));
        let mut dynamics = ContactDynamics::new(model.clone()).unwrap();
        let m = dynamics.n_modes();
        let mut seed = 12345_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        for start in 0..20 {
            // From rest in equilibrium without stops, and from anywhere.
            let size = if start == 0 { 0.0 } else { 1.0 };
            let mut coordinates = |scale: f64| (0..m).map(|k| size * scale * random() / (k + 1) as f64).collect();
            let state = ModalState { z: coordinates(1.0), v: coordinates(3.0) };
            let trajectory = dynamics.propagate(&state, 20.0).unwrap();
            let energies = trajectory.energies();
            let largest = energies.iter().fold(f64::MIN_POSITIVE, |m, e| m.max(*e));
            let drift = energies.iter().fold(0.0_f64, |m, e| m.max((e - energies[0]).abs()));
            assert!(drift < 1e-11 * largest, "{name}, {start}: {drift:e} of {largest:e}");
            for j in 0..50 {
                let at = trajectory.at(0.4 * f64::from(j));
                for (i, c) in model.contacts().iter().enumerate() {
                    let gap = c.gap - c.side.sign() * at.displacement[c.dof] + at.forces[i] * c.law.compliance();
                    assert!(gap > -1e-10 && at.forces[i] > -1e-9, "{name}, {start}: {gap:e}, {:e}", at.forces[i]);
                }
            }
        }
    }
}

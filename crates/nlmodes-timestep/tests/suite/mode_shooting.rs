//! The reduction to fixed-interface modes, the exact Fourier coefficients, and the shooting equations.

use crate::support;

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes_continuation::{Bound, Continuation, Linearization, ParametricSystem};
use nlmodes_fem::{Direction, Stop};
use nlmodes_linalg::{SparseCholesky, bilinear};
use nlmodes_modal::{HarmonicBasis, HarmonicCoefficients};
use nlmodes_model::{MasslessContactModel, Side, StructuralModel};
use nlmodes_timestep::{ContactDynamics, GalerkinReduction, ModalState, ModeShooting, ShootingScales, TimestepError};
use num_complex::Complex64;
use support::{beam, massless, rod_of, rod_with, unit_rod};

/// The lowest mode.
const LOWEST: ShootingScales = ShootingScales { omega: 0.0, energy: 1.0 };

fn two_stops() -> StructuralModel {
    rod_with(
        6,
        &[
            Stop::rigid(1.0, Direction::Axial, Side::Positive, 1.0).on_spring(4.0),
            Stop::rigid(0.5, Direction::Axial, Side::Positive, 0.8),
        ],
    )
}

fn transverse(elements: usize) -> MasslessContactModel {
    massless(&beam(elements, &[Stop::rigid(0.62975520, Direction::Transverse, Side::Positive, 1e-3)]))
}

/// The nonlinear mode, and the unknowns of a motion of `ratio` times the energy at grazing.
fn mode(model: MasslessContactModel, modes: usize, ratio: f64) -> (ModeShooting, Vec<f64>, f64) {
    let reduced = GalerkinReduction::new(model, modes).unwrap();
    let mut shooting = ModeShooting::new(reduced, LOWEST, 8).unwrap();
    let (x, direction) = shooting.start();
    let bounds = vec![Bound { coordinate: shooting.dim(), min: -1.0, max: ratio.ln() }];
    let method = Continuation { bounds, max_points: 300, ..Continuation::default() };
    let branch = method.run(&mut *shooting, &x, 0.0, &direction, |_| ControlFlow::Continue(())).unwrap();
    let last = branch.points.last().unwrap();
    assert!((last.p - ratio.ln()).abs() < 1e-12, "{:?}", branch.stop);
    (shooting, last.x.clone(), last.p)
}

#[test]
fn the_jacobian_is_the_derivative_of_the_residual() {
    for (model, modes) in [(massless(&two_stops()), 6), (massless(&two_stops()), 3), (transverse(4), 12)] {
        let reduced = GalerkinReduction::new(model, modes).unwrap();
        let mut shooting = ModeShooting::new(reduced, LOWEST, 8).unwrap();
        // Not a solution: the linear mode beyond grazing, with small amplitudes of all others.
        let (start, p) = (shooting.start().0, 0.6);
        let last = start.len() - 1;
        let x: Vec<f64> =
            (0..=last).map(|k| start[k] * if k < last { 1.4 } else { 1.05 } + 0.02 / (k + 1) as f64).collect();
        assert!(!shooting.motion(&x).unwrap().trajectory.closed_intervals().is_empty());
        let n = shooting.dim();
        let mut at = Linearization::new(n);
        shooting.linearize(&x, p, &mut at).unwrap();
        let (mut above, mut below) = (Linearization::new(n), Linearization::new(n));
        for j in 0..=n {
            let h = 1e-6;
            let shifted = |s: f64| (0..n).map(|k| x[k] + if k == j { s * h } else { 0.0 }).collect::<Vec<f64>>();
            let p_of = |s: f64| if j == n { p + s * h } else { p };
            shooting.linearize(&shifted(1.0), p_of(1.0), &mut above).unwrap();
            shooting.linearize(&shifted(-1.0), p_of(-1.0), &mut below).unwrap();
            for i in 0..n {
                let difference = (above.residual[i] - below.residual[i]) / (2.0 * h);
                // The second derivative of the residual jumps at contact instants: errors are of order h.
                let tolerance = 1e-4 * (1.0 + at.jacobian[(i, j)].abs());
                assert!((at.jacobian[(i, j)] - difference).abs() < tolerance, "({i}, {j}): {difference}");
            }
        }
    }
}

#[test]
fn modes_that_leave_the_contacts_at_rest_change_nothing_when_they_are_left_out() {
    let full = transverse(4);
    let reduced = GalerkinReduction::new(full.clone(), usize::MAX).unwrap();
    // Four axial degrees of freedom of the beam, and the mass of the tip's deflection, are removed.
    assert_eq!((full.linear_dofs().len(), reduced.n_modes()), (11, 7));
    let (mut all, mut few) =
        (ContactDynamics::new(full.clone()).unwrap(), ContactDynamics::new(reduced.model().clone()).unwrap());
    let start = all.grazing(0.0).unwrap();
    let bent = ModalState { z: start.state.z.iter().map(|z| 3.0 * z).collect(), v: start.state.v.clone() };
    let (q, _) = all.displacement_and_velocity(&bent).unwrap();
    let projected = reduced.project(&q).unwrap();
    let state = few.state(&projected, &vec![0.0; projected.len()]).unwrap();
    let duration = 2.3 * TAU / start.omega;
    let (long, short) = (all.propagate(&bent, duration).unwrap(), few.propagate(&state, duration).unwrap());
    assert!(long.closed_intervals().len() > 2);
    let translation = |d: &usize| full.dofs()[*d].kind != nlmodes_model::DofKind::Rotation;
    for j in 0..=40 {
        let t = duration * f64::from(j) / 40.0;
        let (a, b) = (long.at(t), reduced.expand(&short.at(t).displacement));
        let gap = (0..b.len()).filter(translation).map(|d| (a.displacement[d] - b[d]).abs()).fold(0.0, f64::max);
        // The lowest eigenvalue of the beam with its axial modes is about 1e-9 of the largest, so seven of its digits
        // remain in double precision; 3e-3 m times 1e-7 times the phase, 14 rad, are 4e-9 m.
        assert!(gap < 4e-9, "at {t}: {gap:e} m beside a gap of 1e-3 m");
        assert!((a.forces[0] - short.at(t).forces[0]).abs() < 1e-5 * long.peak_force(0));
    }
}

#[test]
fn what_is_left_out_answers_statically() {
    // The residual mass is relative to the total, however small that is.
    for area in [1.0, 1e-14] {
        let stop = |at, gap| Stop::rigid(at, Direction::Axial, Side::Positive, gap);
        answers_statically(area, massless(&rod_of(area, 6, &[stop(1.0, 1.0).on_spring(4.0 * area), stop(0.5, 0.8)])));
    }
}

fn answers_statically(area: f64, full: MasslessContactModel) {
    let stiffness = SparseCholesky::factor(full.stiffness(), "the rod").unwrap();
    for modes in 1..4 {
        let reduced = GalerkinReduction::new(full.clone(), modes).unwrap();
        // A static shape for each contact, unless the four fixed-interface modes are exhausted.
        assert_eq!((reduced.n_kept_modes(), reduced.n_modes()), (modes, (modes + 2).min(4)));
        let small = SparseCholesky::factor(reduced.model().stiffness(), "the reduced rod").unwrap();
        for (contact, own) in full.contacts().iter().zip(reduced.model().contacts()) {
            let (mut q, mut y) = (vec![0.0; full.dofs().len()], vec![0.0; reduced.n_modes() + 2]);
            (q[contact.dof], y[own.dof]) = (1.0, 1.0);
            stiffness.solve_in_place(&mut q);
            small.solve_in_place(&mut y);
            for (a, b) in q.iter().zip(reduced.expand(&y)) {
                assert!((a - b).abs() < 1e-13 / area, "{a} and {b} with {modes} modes");
            }
        }
    }
}

#[test]
fn with_more_held_modes_the_frequency_runs_into_that_of_the_full_structure() {
    let omega = |modes: usize| {
        let (shooting, x, _) = mode(massless(&unit_rod(8)), modes, 1.1);
        shooting.omega(&x)
    };
    let exact = omega(7);
    let errors = [1, 2, 3, 4, 5, 6].map(|modes| (omega(modes) / exact - 1.0).abs());
    // One mode less than all, with its static shape, spans the same space.
    assert!(errors[0] < 1e-2 && errors[1] < 1e-3 && errors[5] < 1e-12, "{errors:?}");
    assert!(errors[2..5].iter().all(|error| *error < 1e-4), "{errors:?}");
}

#[test]
fn coefficients_are_those_of_the_motion() {
    let (mut shooting, x, _) = mode(massless(&two_stops()), 6, 1.5);
    let trajectory = shooting.motion(&x).unwrap().trajectory;
    let (harmonics, samples) = (12, 1 << 13);
    let exact = trajectory.harmonics(harmonics);
    let mut basis = HarmonicBasis::new(harmonics, samples).unwrap();
    let mut found = vec![Complex64::default(); harmonics + 1];
    let all: Vec<_> = (0..samples).map(|j| trajectory.at(trajectory.duration() * j as f64 / samples as f64)).collect();
    for d in 0..exact.n_coordinates() {
        let q: Vec<f64> = all.iter().map(|s| s.displacement[d]).collect();
        basis.analyze(&q, &mut found);
        for (n, (a, b)) in exact.of(d).iter().zip(&found).enumerate() {
            // The slope of the massless nodes jumps: sums converge with the square of the step, 6e-7.
            assert!((a - b).norm() < 1e-6, "coordinate {d}, harmonic {n}: {a} and {b}");
        }
    }
    let point = shooting.modal_point(&x, 0.0).unwrap();
    let sum: f64 = point.harmonic_energy.iter().sum();
    assert!(sum < point.kinetic_energy && sum > 0.999 * point.kinetic_energy, "{sum} of {}", point.kinetic_energy);
    // With half of the harmonics no energy is missing from the coefficients of the full structure.
    let dynamics = ContactDynamics::new(massless(&two_stops())).unwrap();
    let own = dynamics.averaged_kinetic_energy(&point.coefficients, point.omega).unwrap();
    assert!((own / sum - 1.0).abs() < 1e-12, "{own} and {sum}");
    let (again, p) = shooting.unknowns(&point.coefficients, point.omega).unwrap();
    assert!(again.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-2) && (p - 1.5_f64.ln()).abs() < 1e-3);
}

/// The first stop is reached, or too far away.
#[test]
fn the_peak_is_the_largest_displacement_of_the_first_contact_toward_its_stop() {
    for (side, gap, touched) in
        [(Side::Positive, 1.0, true), (Side::Negative, 9.0, false), (Side::Positive, 9.0, false)]
    {
        let stop = |at, side, gap| Stop::rigid(at, Direction::Axial, side, gap);
        let model = massless(&rod_with(6, &[stop(1.0, side, gap).on_spring(4.0), stop(0.5, Side::Positive, 0.8)]));
        let (mut shooting, x, _) = mode(model, 6, 1.3);
        let point = shooting.modal_point(&x, 0.0).unwrap();
        let history = shooting.equidistant_histories(&x, 4000, "").unwrap().swap_remove(0);
        let largest = history.displacement.iter().map(|q| side.sign() * q).fold(f64::NEG_INFINITY, f64::max);
        assert_eq!(history.force.iter().any(|force| *force > 0.0), touched);
        assert_eq!(point.contacts[0].touches > 0, touched);
        assert_eq!((shooting.structure().full().contacts().len(), point.contacts.len()), (2, 2));
        let mut faster = x.clone();
        faster[shooting.frequency_index()] *= 1.5;
        assert!((shooting.omega(&faster) / shooting.omega(&x) - 1.5).abs() < 1e-15);
        // Instants are 1/4000 of a period apart, and the curvature there is that of a few modes.
        assert!((point.peak - largest).abs() < 1e-5, "{} and {largest}", point.peak);
        assert_eq!(shooting.scaling().map(|scaling| scaling.unknowns), Some(vec![1.0; x.len() + 1]));
    }
}

/// The history of a contact is the motion of its degree of freedom, with its derivatives.
#[test]
fn histories_of_contacts_are_the_motion_of_their_nodes() {
    for (side, modes) in [(Side::Positive, 6), (Side::Negative, 6), (Side::Positive, 2)] {
        let stop = |at, side, gap| Stop::rigid(at, Direction::Axial, side, gap);
        let model = massless(&rod_with(6, &[stop(1.0, side, 1.0).on_spring(4.0), stop(0.5, Side::Positive, 0.8)]));
        let dofs: Vec<usize> = model.contacts().iter().map(|c| c.dof).collect();
        let (mut shooting, x, _) = mode(model, modes, 1.3);
        let trajectory = shooting.motion(&x).unwrap().trajectory;
        let exact = shooting.time_histories(&x, 128, "").unwrap();
        let mut touched = 0;
        for (i, dof) in dofs.into_iter().enumerate() {
            let even = shooting.equidistant_histories(&x, 64, "").unwrap().swap_remove(i);
            for history in [&even, &exact[i]] {
                assert!((history.stop - [side.sign(), 0.8][i]).abs() < 1e-15);
                for (j, &t) in history.time.iter().enumerate() {
                    let whole = |t: f64| {
                        let at = trajectory.at(t);
                        let of = |q: &[f64]| shooting.structure().expand(q)[dof];
                        (of(&at.displacement), of(&at.velocity), at.forces[i])
                    };
                    let (h, (q, v, force)) = (1e-6, whole(t));
                    assert!((history.displacement[j] - q).abs() < 1e-9, "{i} {t}: {} {q}", history.displacement[j]);
                    assert!((history.force[j] - force).abs() < 1e-8, "{i} {t}: {} {force}", history.force[j]);
                    // Velocities of massless nodes jump at contact changes, and finite differences must not cross them.
                    let far = |instant: f64| (t - instant).abs() > 1e-5;
                    let within = exact.iter().flat_map(|h| &h.instants).all(|instant| far(instant.time));
                    if within && far(0.0) && far(trajectory.duration()) {
                        assert!((history.velocity[j] - v).abs() < 1e-9, "{i} {t}: {} {v}", history.velocity[j]);
                        let slope = (whole(t + h).1 - whole(t - h).1) / (2.0 * h);
                        let found = history.acceleration[j];
                        assert!((found - slope).abs() < 1e-4 * (1.0 + slope.abs()), "{i} {t}: {found} {slope}");
                    }
                    touched += usize::from(force > 0.0);
                }
            }
        }
        assert!(touched > 20, "{touched}");
    }
}

/// A motion given by its coefficients: its initial state, and the averaged kinetic energy `¼ Σ (nω)² qᵀ M q`.
#[test]
fn unknowns_of_a_given_motion_are_its_beginning_and_its_energy() {
    let model = massless(&two_stops());
    let reduced = GalerkinReduction::new(model.clone(), usize::MAX).unwrap();
    let mut shooting = ModeShooting::new(reduced, LOWEST, 8).unwrap();
    let (dofs, omega, harmonics) = (model.dofs().len(), 1.3, 4);
    let mut motion = HarmonicCoefficients::zeros(dofs, harmonics);
    let q = |d: usize, n: usize| 0.3 * (1.3 * d as f64 + 2.1 * n as f64 + 0.2).sin() / (1.0 + n as f64);
    for d in 0..dofs {
        (0..=harmonics).for_each(|n| motion.of_mut(d)[n] = Complex64::from(q(d, n)));
    }
    let first: Vec<f64> = (0..dofs).map(|d| (0..=harmonics).map(|n| q(d, n)).sum()).collect();
    let part = |n: usize| (0..dofs).map(|d| q(d, n)).collect::<Vec<f64>>();
    let energy: f64 =
        (1..=harmonics).map(|n| 0.25 * (n as f64 * omega).powi(2) * bilinear(&part(n), model.mass(), &part(n))).sum();
    let (x, p) = shooting.unknowns(&motion, omega).unwrap();
    assert!((p - (energy / shooting.scales().energy).ln()).abs() < 1e-12);
    assert!((shooting.omega(&x) / omega - 1.0).abs() < 1e-14);
    let found = shooting.first_displacement(&x).unwrap();
    for &d in model.linear_dofs() {
        assert!((found[d] - first[d]).abs() < 1e-12, "{d}: {} {}", found[d], first[d]);
    }
}

#[test]
fn a_stop_that_presses_at_rest_begins_where_its_force_vanishes() {
    let model = massless(&rod_with(4, &[Stop::rigid(1.0, Direction::Axial, Side::Positive, -0.1)]));
    let mut dynamics = ContactDynamics::new(model).unwrap();
    let start = dynamics.grazing(0.0).unwrap();
    // Fixed at both ends: about π, and at rest the force is 0.1 EA/L.
    assert!((start.omega / std::f64::consts::PI - 1.0).abs() < 0.03);
    let trajectory = dynamics.propagate(&start.state, TAU / start.omega).unwrap();
    assert_eq!(trajectory.closed_intervals().len(), 1);
    assert!((trajectory.peak_force(0) - 0.2).abs() < 1e-10, "{}", trajectory.peak_force(0));
    assert!(trajectory.contact_state(0, 0.0).force[0].abs() < 1e-10);
}

#[test]
fn too_many_modes_are_refused() {
    let model = massless(&unit_rod(220));
    let error = ModeShooting::new(GalerkinReduction::new(model, 210).unwrap(), LOWEST, 3).unwrap_err();
    assert_eq!(error, TimestepError::TooManyModes { found: 210, most: nlmodes_timestep::MAX_SHOOTING_MODES });
}

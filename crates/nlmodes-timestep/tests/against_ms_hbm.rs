//! Mixed shooting-harmonic balance against exact motions, and against the global contact problem.

mod support;

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes_contact::solver_by_name;
use nlmodes_continuation::{Bound, Continuation, ParametricSystem};
use nlmodes_fem::{Direction, Stop};
use nlmodes_hbm::{
    CondensedStructure, Grazing, MixedShooting, MixedShootingSettings, Switching, Symmetry, grazing,
};
use nlmodes_linalg::DenseLu;
use nlmodes_modal::ModalPoint;
use nlmodes_model::{MasslessContactModel, Side};
use nlmodes_timestep::{
    ContactDynamics, GlobalContactProblem, PeriodicMotion, Shooting, ShootingScales, Verification,
};
use support::{ClosedForm, dynamics, fitted_slope, massless, rod_with, settle, unit_rod};

fn condensed(model: &MasslessContactModel) -> CondensedStructure {
    CondensedStructure::new(model.clone(), usize::MAX).unwrap()
}

fn mixed_shooting(structure: &CondensedStructure, harmonics: usize, switching: Switching) -> (MixedShooting<'_>, Grazing) {
    let start = grazing(structure, 1).unwrap();
    let settings = MixedShootingSettings { harmonics, symmetry: Symmetry::Even, switching };
    let solver = solver_by_name("active-set").unwrap();
    (MixedShooting::new(structure, settings, start.scales(), solver.as_ref()).unwrap(), start)
}

/// The point at `ratio` times the energy of grazing to which the branch leads.
fn point_at(structure: &CondensedStructure, harmonics: usize, switching: Switching, ratio: f64) -> ModalPoint {
    let (mut problem, start) = mixed_shooting(structure, harmonics, switching);
    let dim = problem.dim();
    let (x, direction) = (start.unknowns(problem.series(), dim), start.direction(problem.series(), dim));
    let bounds = vec![Bound { coordinate: dim, min: -8.0, max: f64::ln(ratio) }];
    let method = Continuation { bounds, max_points: 2000, ..Default::default() };
    let branch = method.run(&mut problem, &x, 0.0, &direction, |_| ControlFlow::Continue(())).unwrap();
    let last = branch.points.last().unwrap();
    assert!((last.p - ratio.ln()).abs() < 1e-12, "ended at {}: {:?}", last.p.exp(), branch.stop);
    let (x, residual) = settle(&mut problem, last.x.clone(), last.p);
    problem.modal_point(&x, residual).unwrap()
}

/// The exact motion of the same energy next to the point, and the scales.
fn exact(dynamics: ContactDynamics, point: &ModalPoint) -> PeriodicMotion {
    let scales = ShootingScales { omega: point.omega, energy: point.kinetic_energy };
    let start = dynamics.state_of_harmonics(&point.coefficients, point.omega, 0.0).unwrap();
    let mut shooting = Shooting::new(dynamics, scales).unwrap();
    let guess = shooting.unknowns(&start, point.omega);
    let (x, residual) = settle(&mut shooting, guess, 0.0);
    assert!(residual < 1e-11, "{residual:e}");
    shooting.motion(&x).unwrap()
}

/// Errors of the ten-element rod by number of harmonics: frequency at the energy of grazing times `ratio`, and what verification finds.
fn study(elements: usize, ratio: f64, harmonics: &[usize]) -> Vec<(usize, f64, f64, f64)> {
    let model = massless(&unit_rod(elements));
    let structure = condensed(&model);
    let reference = exact(
        ContactDynamics::new(model.clone()).unwrap(),
        &point_at(&structure, *harmonics.last().unwrap(), Switching::Exact, ratio),
    );
    let mut full = ContactDynamics::new(model.clone()).unwrap();
    harmonics
        .iter()
        .map(|&h| {
            let point = point_at(&structure, h, Switching::Exact, ratio);
            let state = full.state_of_harmonics(&point.coefficients, point.omega, 0.0).unwrap();
            let found = Verification::new(&mut full, &state, TAU / point.omega).unwrap();
            // L2 error of the tip over a period.
            let tip = elements - 1;
            let (mut error, mut size) = (0.0, 0.0);
            for j in 0..2000 {
                let τ = TAU * f64::from(j) / 2000.0;
                let exact = reference.trajectory.at(τ / reference.omega).displacement[tip];
                error += (point.coefficients.value(tip, τ) - exact).powi(2);
                size += exact * exact;
            }
            (h, (point.omega / reference.omega - 1.0).abs(), f64::sqrt(error / size), found.energy_norm)
        })
        .collect()
}

#[test]
fn explore() {
    for (h, frequency, tip, returned) in study(10, 3.0, &[1, 2, 3, 5, 7, 10, 14, 20, 28, 40, 56, 80, 113, 160, 226, 320]) {
        println!("{h:5} {frequency:.2e} {tip:.2e} {returned:.2e}");
    }
}

/// Contact forces at the samples from the Fourier coefficients alone: `b = −K_NN⁻¹ K_NL q_L`, and a contact problem each.
fn forces_at_samples(model: &MasslessContactModel, point: &ModalPoint, samples: usize) -> Vec<f64> {
    let k_nn = DenseLu::factor(model.k_nn()).unwrap();
    let structure = condensed(model);
    let mut workspace = solver_by_name("lemke").unwrap().workspace(structure.compliance()).unwrap();
    let c = model.contacts().len();
    let mut forces = Vec::new();
    for j in 0..samples {
        let τ = TAU * j as f64 / samples as f64;
        let q: Vec<f64> = model.linear_dofs().iter().map(|&d| point.coefficients.value(d, τ)).collect();
        let mut b: Vec<f64> = (0..model.k_nn().nrows())
            .map(|d| -(0..q.len()).map(|i| model.k_ln()[(i, d)] * q[i]).sum::<f64>())
            .collect();
        k_nn.solve_in_place(&mut b);
        let y: Vec<f64> = (0..c)
            .map(|i| model.contacts()[i].gap + (0..b.len()).map(|d| model.w()[(d, i)] * b[d]).sum::<f64>())
            .collect();
        let (mut closed, mut lambda) = (vec![false; c], vec![0.0; c]);
        workspace.solve(&y, &mut closed, &mut lambda).unwrap();
        forces.extend(lambda);
    }
    forces
}

#[test]
fn sampled_solutions_solve_the_global_contact_problem() {
    let stop = |at, side, gap| Stop::rigid(at, Direction::Axial, side, gap);
    let two = [stop(1.0, Side::Positive, 0.5), stop(0.5, Side::Positive, 0.33)];
    let soft = [stop(1.0, Side::Positive, 0.5).on_spring(10.0), stop(1.0, Side::Negative, 0.7)];
    let models = [("one stop", unit_rod(5)), ("two stops", rod_with(6, &two)), ("soft and hard", rod_with(4, &soft))];
    for (name, model) in models {
        let model = massless(&model);
        let structure = condensed(&model);
        for (harmonics, samples) in [(1, 32), (4, 64), (9, 128)] {
            let point = point_at(&structure, harmonics, Switching::Sampled { samples }, 1.8);
            let problem = GlobalContactProblem::new(&model, point.omega, harmonics, samples).unwrap();
            let forces = forces_at_samples(&model, &point, samples);
            assert!(forces.iter().filter(|λ| **λ > 0.0).count() > 3, "{name}: hardly any contact");
            let violation = problem.violation(&forces).unwrap();
            println!("{name}, {harmonics} harmonics, {samples} samples: {violation:.1e}");
            assert!(violation < 1e-10, "{name}, {harmonics} harmonics, {samples} samples: {violation:e}");
            // It is a test that can fail: a frequency that is off shows.
            let other = GlobalContactProblem::new(&model, 1.001 * point.omega, harmonics, samples).unwrap();
            assert!(other.violation(&forces).unwrap() > 1e-5, "{name}");
            // Nor does the solution with exact switching solve the sampled problem.
            let exact = point_at(&structure, harmonics, Switching::Exact, 1.8);
            let problem = GlobalContactProblem::new(&model, exact.omega, harmonics, samples).unwrap();
            let forces = forces_at_samples(&model, &exact, samples);
            assert!(problem.violation(&forces).unwrap() > 1e-8, "{name}");
        }
    }
}

#[test]
fn the_exact_motion_of_the_two_element_rod_is_found_from_one_harmonic() {
    let closed = ClosedForm::new(2.0);
    let model = massless(&unit_rod(2));
    let point = point_at(&condensed(&model), 1, Switching::Exact, closed.kinetic() / 0.5);
    let motion = exact(dynamics(&unit_rod(2)), &point);
    assert!((point.omega / closed.omega() - 1.0).abs() > 1e-4);
    assert!((motion.omega / closed.omega() - 1.0).abs() < 1e-12);
}

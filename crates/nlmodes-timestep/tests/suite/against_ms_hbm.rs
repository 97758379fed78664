//! Mixed shooting-harmonic balance compared with exact motions and with the global contact problem.

use crate::global_problem::GlobalContactProblem;
use crate::support;

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes_contact::solver_by_name;
use nlmodes_continuation::{Bound, Continuation, ParametricSystem};
use nlmodes_fem::{Direction, Stop};
use nlmodes_hbm::{CondensedStructure, Grazing, PeriodicSettings, PeriodicSystem, Switching, Symmetry, grazing};
use nlmodes_linalg::DenseLu;
use nlmodes_modal::ModalPoint;
use nlmodes_model::{MasslessContactModel, Side};
use nlmodes_timestep::{ContactDynamics, PeriodicMotion, Shooting, ShootingScales, Verification};
use support::{ClosedForm, dynamics, fitted_slope, massless, rod_with, settle, unit_rod};

fn condensed(model: &MasslessContactModel) -> CondensedStructure {
    CondensedStructure::new(model.clone(), usize::MAX).unwrap()
}

fn mixed_shooting(structure: &CondensedStructure, harmonics: usize, switching: Switching) -> (PeriodicSystem, Grazing) {
    let start = grazing(structure, 1).unwrap();
    let settings = (PeriodicSettings { harmonics, switching, ..PeriodicSettings::default() }, Symmetry::Even);
    let solver = solver_by_name("active-set").unwrap();
    (structure.conservative_mode(settings, start.scales(), solver.as_ref()).unwrap(), start)
}

/// The point of the branch at `ratio` times the grazing energy.
fn point_at(structure: &CondensedStructure, harmonics: usize, switching: Switching, ratio: f64) -> ModalPoint {
    let (mut problem, start) = mixed_shooting(structure, harmonics, switching);
    let dim = problem.dim();
    let (x, direction) = problem.start(&start);
    let bounds = vec![Bound { coordinate: dim, min: -8.0, max: f64::ln(ratio) }];
    let method = Continuation { bounds, max_points: 2000, ..Default::default() };
    let branch = method.run(&mut problem, &x, 0.0, &direction, |_| ControlFlow::Continue(())).unwrap();
    let last = branch.points.last().unwrap();
    assert!((last.p - ratio.ln()).abs() < 1e-12, "ended at {}: {:?}", last.p.exp(), branch.stop);
    let (x, residual) = settle(&mut problem, last.x.clone(), last.p);
    structure.modal_point(&mut problem, &x, residual).unwrap()
}

/// The exact motion of the same energy next to the point, and the scales.
fn exact(dynamics: ContactDynamics, point: &ModalPoint) -> PeriodicMotion {
    let scales = ShootingScales { omega: point.omega, energy: point.kinetic_energy };
    let start = dynamics.state_of_harmonics(&point.coefficients, point.omega, 0.0).unwrap();
    let energy = dynamics.averaged_kinetic_energy(&point.coefficients, point.omega).unwrap();
    assert!((energy / point.kinetic_energy - 1.0).abs() < 1e-12);
    let mut shooting = Shooting::new(dynamics, scales).unwrap();
    let guess = shooting.unknowns(&start, point.omega);
    let (x, residual) = settle(&mut shooting, guess, 0.0);
    assert!(residual < 1e-11, "{residual:e}");
    shooting.motion(&x).unwrap()
}

/// Errors against an exact motion.
#[derive(Debug, Clone, Copy)]
struct Errors {
    /// Of the frequency at the same energy, relative.
    frequency: f64,
    /// Of the displacement of the massive node next to the tip and of the tip itself, L2 over a period, relative.
    neighbour: f64,
    tip: f64,
    /// Failure of the full structure to return, in the energy norm.
    returned: f64,
}

/// The rod's motion of `ratio` times the energy of grazing, and MS-HBM with other numbers of harmonics, begun from it.
struct Comparison {
    model: MasslessContactModel,
    structure: CondensedStructure,
    reference: PeriodicMotion,
    /// `b` at equidistant instants; for a rod it is the position of the neighbour of the tip.
    b_t: Vec<f64>,
}

const SAMPLES: usize = 1 << 12;

impl Comparison {
    fn new(elements: usize, ratio: f64, harmonics: usize) -> Self {
        let model = massless(&unit_rod(elements));
        let structure = condensed(&model);
        let point = point_at(&structure, harmonics, Switching::Exact, ratio);
        let reference = exact(ContactDynamics::new(model.clone()).unwrap(), &point);
        let period = TAU / reference.omega;
        let b = |j: usize| reference.trajectory.at(period * j as f64 / SAMPLES as f64).displacement[elements - 2];
        let b_t = (0..SAMPLES).map(b).collect();
        Self { model, structure, reference, b_t }
    }

    fn point(&self, harmonics: usize) -> ModalPoint {
        let (mut problem, start) = mixed_shooting(&self.structure, harmonics, Switching::Exact);
        let cosine = |n: usize| {
            let phase = |j: usize| TAU * ((n * j) % SAMPLES) as f64 / SAMPLES as f64;
            let sum: f64 = self.b_t.iter().enumerate().map(|(j, b)| b * phase(j).cos()).sum();
            sum * if n == 0 { 1.0 } else { 2.0 } / SAMPLES as f64
        };
        // The gap opens by −b.
        let mut x: Vec<f64> = (0..=harmonics).map(|n| -cosine(n) / start.scales().length).collect();
        x.push(self.reference.omega / start.omega);
        let p = (self.reference.kinetic_energy / start.energy).ln();
        let (x, residual) = settle(&mut problem, x, p);
        assert!(residual < 1e-11, "{harmonics} harmonics: {residual:e}");
        self.structure.modal_point(&mut problem, &x, residual).unwrap()
    }

    fn errors(&self, harmonics: usize) -> Errors {
        let point = self.point(harmonics);
        let mut full = ContactDynamics::new(self.model.clone()).unwrap();
        let state = full.state_of_harmonics(&point.coefficients, point.omega, 0.0).unwrap();
        let returned = Verification::new(&mut full, &state, TAU / point.omega).unwrap().energy_norm;
        let l2 = |dof: usize| {
            let (mut error, mut size) = (0.0, 0.0);
            for j in 0..500 {
                let phase = TAU * f64::from(j) / 500.0;
                let exact = self.reference.trajectory.at(phase / self.reference.omega).displacement[dof];
                error += (point.coefficients.value(dof, phase) - exact).powi(2);
                size += exact * exact;
            }
            f64::sqrt(error / size)
        };
        let tip = self.model.dofs().len() - 1;
        let frequency = (point.omega / self.reference.omega - 1.0).abs();
        Errors { frequency, neighbour: l2(tip - 1), tip: l2(tip), returned }
    }

    /// Largest errors among some numbers of harmonics of each octave: single ones oscillate with the positions of the
    /// kinks.
    fn octaves(&self, from: usize, count: usize, each: usize) -> Vec<(f64, Errors)> {
        let octave = |k: usize| {
            let low = from << k;
            let all: Vec<Errors> = (0..each).map(|i| self.errors(low + low * i / each)).collect();
            let largest = |of: fn(&Errors) -> f64| all.iter().map(of).fold(0.0, f64::max);
            let errors = Errors {
                frequency: largest(|e| e.frequency),
                neighbour: largest(|e| e.neighbour),
                tip: largest(|e| e.tip),
                returned: largest(|e| e.returned),
            };
            (low as f64, errors)
        };
        (0..count).map(octave).collect()
    }
}

fn order(errors: &[(f64, Errors)], of: fn(&Errors) -> f64) -> f64 {
    fitted_slope(&errors.iter().map(|(h, e)| (*h, of(e))).collect::<Vec<_>>())
}

#[test]
fn ms_hbm_converges_to_the_exact_motion_of_the_rod_of_ten_elements() {
    let errors = Comparison::new(10, 3.0, 20).octaves(20, 4, 4);
    let orders = [order(&errors, |e| e.frequency), order(&errors, |e| e.neighbour), order(&errors, |e| e.tip)];
    // The velocity of the tip jumps, so its coefficients decay like n⁻², and the third derivative of its neighbour
    // jumps, so n⁻⁴; in the L2 norm the truncation error has half a power less. The frequency is stationary.
    assert!((-5.6..-4.4).contains(&orders[0]), "{orders:?}");
    assert!((-3.9..-3.2).contains(&orders[1]), "{orders:?}");
    assert!((-1.8..-1.3).contains(&orders[2]), "{orders:?}");
    assert!(errors[3].1.frequency < 1e-9, "{errors:?}");
}

#[test]
fn there_is_no_floor_above_rounding() {
    let comparison = Comparison::new(10, 3.0, 20);
    for harmonics in [500, 600] {
        let error = comparison.errors(harmonics).frequency;
        assert!(error < 1e-11, "{harmonics} harmonics: {error:e}");
    }
}

#[test]
#[ignore = "figures of benchmarks/results/exact_motions.md; half a minute in the dev profile"]
fn figures_of_the_rod_of_a_hundred_elements() {
    let errors = Comparison::new(100, 3.0, 20).octaves(20, 7, 2);
    errors.iter().for_each(|(h, e)| println!("{h:5} {e:?}"));
    assert!(errors[6].1.frequency < 1e-11, "{errors:?}");
    println!("{} {} {}", order(&errors, |e| e.frequency), order(&errors, |e| e.neighbour), order(&errors, |e| e.tip));
}

/// Contact forces at the samples from the Fourier coefficients alone: `b = −K_NN⁻¹ K_NL q_L`, and a contact problem
/// each.
fn forces_at_samples(model: &MasslessContactModel, point: &ModalPoint, samples: usize) -> Vec<f64> {
    let k_nn = DenseLu::factor(model.k_nn()).unwrap();
    let structure = condensed(model);
    let mut workspace = solver_by_name("lemke").unwrap().workspace(structure.compliance()).unwrap();
    let c = model.contacts().len();
    let mut forces = Vec::new();
    for j in 0..samples {
        let phase = TAU * j as f64 / samples as f64;
        let q: Vec<f64> = model.linear_dofs().iter().map(|&d| point.coefficients.value(d, phase)).collect();
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
            let problem = GlobalContactProblem::new(&model, point.omega, harmonics, samples);
            let forces = forces_at_samples(&model, &point, samples);
            assert!(forces.iter().filter(|λ| **λ > 0.0).count() > 3, "{name}: hardly any contact");
            let violation = problem.violation(&forces);
            assert!(violation < 1e-10, "{name}, {harmonics} harmonics, {samples} samples: {violation:e}");
            // This test can fail: a wrong frequency is detected.
            let other = GlobalContactProblem::new(&model, 1.001 * point.omega, harmonics, samples);
            assert!(other.violation(&forces) > 1e-5, "{name}");
            // Nor does the solution with exact switching solve the sampled problem.
            let exact = point_at(&structure, harmonics, Switching::Exact, 1.8);
            let problem = GlobalContactProblem::new(&model, exact.omega, harmonics, samples);
            let forces = forces_at_samples(&model, &exact, samples);
            assert!(problem.violation(&forces) > 1e-8, "{name}");
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

//! Bodies that their contacts alone carry: a mass that bounces on a spring, in closed form, and a rod on its end.

use crate::support;

use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

use nlmodes_continuation::{Bound, Continuation, ParametricSystem};
use nlmodes_hbm::{
    Coordinates, ModalDamping, ModalStructure, ModeAtRest, PeriodicSystem, Switching, Symmetry, grazing,
    modal_lift_off_opened,
};
use nlmodes_linalg::{Mat, sparse_from_triplets};
use nlmodes_model::reduction::RestState;
use nlmodes_model::{Contact, Dof, DofKind, ModelError, Side, SteadyForce, StructuralModel};
use support::modal::{settings, solver, worst_column};
use support::{bisect, condense, follow, problem};

/// A mass m under the weight w above a massless tip on a spring k, and a rigid base under the tip.
#[derive(Clone, Copy)]
struct Bounce {
    m: f64,
    w: f64,
    k: f64,
    gap: f64,
}

impl Bounce {
    fn model(&self) -> StructuralModel {
        let k = self.k;
        let matrix = |entries: &[_]| sparse_from_triplets(2, 2, entries).unwrap();
        let stiffness = matrix(&[(0, 0, k), (0, 1, -k), (1, 0, -k), (1, 1, k)]);
        let dofs = (0..2).map(|node| Dof { node, position: node as f64, kind: DofKind::Axial }).collect();
        let base = Contact::rigid(1, Side::Negative, self.gap);
        StructuralModel::new(matrix(&[(0, 0, self.m)]), stiffness, dofs, vec![base]).unwrap()
    }

    fn heavy(&self) -> StructuralModel {
        let motions = Mat::from_fn(2, 1, |_, _| 1.0);
        self.model().with_steady_force(SteadyForce { force: vec![-self.w, 0.0], motions }).unwrap()
    }

    /// Frequency and averaged kinetic energy of the motion with this amplitude about rest on the spring: half a period
    /// from the lowest place, on the spring until it lets go, `cos ωt = −w/(k a)`, and then free.
    fn motion(&self, amplitude: f64) -> [f64; 2] {
        let (omega, g) = ((self.k / self.m).sqrt(), self.w / self.m);
        let pressed = (-self.w / (self.k * amplitude)).max(-1.0).acos() / omega;
        let speed = amplitude * omega * (omega * pressed).sin();
        let half = pressed + speed / g;
        let on_spring = (amplitude * omega).powi(2) * (0.5 * pressed - (2.0 * omega * pressed).sin() / (4.0 * omega));
        [PI / half, 0.5 * self.m * (on_spring + speed.powi(3) / (3.0 * g)) / half]
    }

    /// The amplitude with this energy.
    fn amplitude(&self, energy: f64) -> f64 {
        let least = self.w / self.k;
        bisect(|a| self.motion(a)[1] - energy, least, 100.0 * least)
    }
}

/// In metres and kilograms, with the base below the drawn tip, and in millimetres and grams.
fn bounces() -> [Bounce; 3] {
    let first = Bounce { m: 1.0, w: 10.0, k: 1000.0, gap: 0.0 };
    [first, Bounce { gap: 0.3, ..first }, Bounce { m: 1e3, w: 1e7, k: 1e6, gap: 0.0 }]
}

/// Values of another code: 17.4399335571773 rad/s, 0.3150133724484 J and 50 N at 0.04 m.
#[test]
fn the_closed_form_is_the_one_known_elsewhere() {
    let bounce = bounces()[0];
    let [omega, energy] = bounce.motion(0.04);
    assert!((omega / 17.439_933_557_177_3 - 1.0).abs() < 1e-13, "{omega}");
    assert!((energy / 0.315_013_372_448_4 - 1.0).abs() < 1e-12, "{energy}");
    assert_eq!(bounce.k * (bounce.w / bounce.k + 0.04), 50.0);
}

#[test]
fn a_bouncing_mass_is_that_of_the_closed_form() {
    for bounce in bounces() {
        let structure = condense(&bounce.heavy());
        let start = grazing(&structure, 1).unwrap();
        let sag = bounce.w / bounce.k;
        assert!(start.lifts_off && (start.omega / (bounce.k / bounce.m).sqrt() - 1.0).abs() < 1e-12);
        assert!((start.energy / (0.25 * bounce.k * sag * sag) - 1.0).abs() < 1e-12, "{start:?}");
        // From the drawing: the base is reached by falling through the gap, and the spring yields.
        assert!((start.contacts_at_rest(&structure)[0] / -(bounce.gap + sag) - 1.0).abs() < 1e-12, "{start:?}");
        let at_rest = structure.energy_at_rest().unwrap();
        assert!((at_rest / -(bounce.w * (bounce.gap + 0.5 * sag)) - 1.0).abs() < 1e-12, "{at_rest}");
        let (mut problem, start) = problem(&structure, 1, 60, Symmetry::Even, Switching::Exact);
        let branch = follow(&mut problem, &start, 20.0);
        assert!((branch.points.last().unwrap().p - 20.0_f64.ln()).abs() < 1e-12, "{:?}", branch.stop);
        for point in &branch.points[1..] {
            let modal = structure.modal_point(&mut problem, &point.x, 0.0).unwrap();
            let amplitude = bounce.amplitude(modal.kinetic_energy);
            let [omega, _] = bounce.motion(amplitude);
            assert!((modal.omega / omega - 1.0).abs() < 1e-8, "{} {omega}", modal.omega);
            let force = bounce.k * (sag + amplitude);
            assert!((modal.peak_contact_force / force - 1.0).abs() < 2e-6, "{} {force}", modal.peak_contact_force);
            let above_rest = 0.5 * bounce.k * amplitude * amplitude;
            assert!(((modal.total_energy - at_rest) / above_rest - 1.0).abs() < 1e-8, "{above_rest}");
            // Its mean force is its weight, and its mean place that of the mass.
            assert!((modal.contacts[0].mean_force / bounce.w - 1.0).abs() < 1e-10);
            let below = modal.coefficients.of(0)[0].re - modal.coefficients.of(1)[0].re;
            assert!((below / -sag - 1.0).abs() < 1e-9, "{below}");
        }
    }
}

/// The same structure in open modes: its only mode has no frequency, and the load that no level multiplies is in the
/// mean.
fn modal(bounce: Bounce) -> ModalStructure {
    let massless = nlmodes_model::MasslessContactModel::new(&bounce.heavy(), &nlmodes_model::Drop).unwrap();
    ModalStructure::of_massless(&massless).unwrap()
}

#[test]
fn in_open_modes_it_is_the_same_motion() {
    for bounce in bounces() {
        let structure = modal(bounce);
        assert!(structure.is_pressed() && structure.omega_squared()[0].abs() < 1e-9 * bounce.k / bounce.m);
        let root = bounce.m.sqrt();
        let sign = structure.steady_force()[0].signum();
        let mut rest = RestState::still(1, structure.gaps());
        rest.eta = vec![sign * (bounce.gap + bounce.w / bounce.k) * root];
        (rest.forces, rest.closed) = (vec![bounce.w], vec![true]);
        let at = ModeAtRest { mode: 1, omega_squared: bounce.k / bounce.m, shape: &[1.0], rest: &rest };
        let start = modal_lift_off_opened(&structure, at, 1.0).unwrap();
        for (symmetry, coordinates) in [Symmetry::Even, Symmetry::None]
            .into_iter()
            .flat_map(|s| [Coordinates::Contact, Coordinates::Modal].map(|c| (s, c)))
        {
            let (settings, scales) = (settings(40, coordinates), start.scales());
            let mut system =
                PeriodicSystem::conservative_mode(&structure, symmetry, settings, scales, solver().as_ref()).unwrap();
            let (x, direction) = (start.unknowns(&system), start.direction(&system));
            system.hold_phase(&x);
            let dim = system.dim();
            let bounds = vec![Bound { coordinate: dim, min: -8.0, max: 10.0_f64.ln() }];
            let continuation = Continuation { bounds, max_points: 2000, ..Default::default() };
            let branch = continuation.run(&mut system, &x, 0.0, &direction, |_| ControlFlow::Continue(())).unwrap();
            let last = branch.points.last().unwrap();
            assert!((last.p - 10.0_f64.ln()).abs() < 1e-12, "{symmetry:?} {coordinates:?} {:?}", branch.stop);
            let motion = system.motion(&last.x, last.p).unwrap();
            let amplitude = bounce.amplitude(motion.kinetic_energy);
            let [omega, _] = bounce.motion(amplitude);
            assert!((motion.at.omega / omega - 1.0).abs() < 1e-7, "{symmetry:?} {coordinates:?} {}", motion.at.omega);
            assert!((motion.contacts[0].mean_force / bounce.w - 1.0).abs() < 1e-9);
            let at_rest = -bounce.w * (bounce.gap + 0.5 * bounce.w / bounce.k);
            let above_rest = 0.5 * bounce.k * amplitude * amplitude;
            assert!(((motion.total_energy - at_rest) / above_rest - 1.0).abs() < 1e-6, "{}", motion.total_energy);
            let defect = worst_column(&mut system, &last.x, last.p, 1e-6);
            assert!(defect < 1e-6, "{symmetry:?} {coordinates:?} {defect:e}");
        }
    }
}

/// A steady force that a level multiplied would vanish at rest: a response begins at rest on the base, and a small one
/// is that of a mass on a spring.
#[test]
fn a_response_begins_on_the_base() {
    let bounce = bounces()[1];
    let structure = modal(bounce).with_damping(ModalDamping::ratios(&[bounce.k / bounce.m], &[0.02])).unwrap();
    let omega = 0.6 * (bounce.k / bounce.m).sqrt();
    let sag = bounce.w / bounce.k;
    let term = nlmodes_hbm::LoadTerm {
        harmonic: 1,
        omega_power: 0,
        modal: vec![num_complex::Complex64::new(1.0 / bounce.m.sqrt(), 0.0)],
        gaps: vec![num_complex::Complex64::default()],
    };
    for coordinates in [Coordinates::Contact, Coordinates::Modal] {
        let load = nlmodes_hbm::Load::new(&structure, vec![term.clone()]).unwrap();
        let scales = nlmodes_hbm::Scales::new(sag, omega, 1.0);
        let settings = settings(3, coordinates);
        let mut system =
            PeriodicSystem::force_response(&structure, load, omega, 1.0, settings, scales, solver().as_ref()).unwrap();
        let sign = structure.steady_force()[0].signum();
        let mut x = system.coefficients_at_rest(&[sign * (bounce.gap + sag) * bounce.m.sqrt()], &[bounce.w]);
        x.resize(system.dim(), 0.0);
        let level = 0.1 * bounce.w;
        let (x, residual) = support::modal::newton(&mut system, x, level);
        assert!(residual < 1e-12, "{residual:e}");
        let motion = system.motion(&x, level).unwrap();
        let damping = structure.damping().entry(0, 0) * bounce.m;
        let stiffness = num_complex::Complex64::new(bounce.k - bounce.m * omega * omega, damping * omega);
        let expected = level / stiffness.norm() * bounce.m.sqrt();
        assert!((motion.eta[1][0].norm() / expected - 1.0).abs() < 1e-9, "{coordinates:?}");
        assert!(
            motion.contacts[0].closed_share == 1.0 && (motion.contacts[0].mean_force / bounce.w - 1.0).abs() < 1e-9
        );
    }
}

/// Weight on a contact node has no mass to act on: it belongs into the gap.
#[test]
fn a_steady_force_acts_where_there_is_mass() {
    let model = bounces()[0].model();
    let motions = Mat::from_fn(2, 1, |_, _| 1.0);
    let heavy = model.with_steady_force(SteadyForce { force: vec![-1.0, -2.0], motions }).unwrap();
    let error = nlmodes_model::MasslessContactModel::new(&heavy, &nlmodes_model::Drop).unwrap_err();
    assert_eq!(error, ModelError::ForceAtContact { dof: 1, force: -2.0 });
    assert!(error.to_string().contains("in the gap"), "{error}");
}

/// A free rod of which the weight is that of its massive nodes, on its massless lower end: as stiff as one that is
/// fixed there, it begins at the frequency of that, and each point returns after a period, integrated with small steps
/// of a Runge-Kutta method of fourth order.
#[test]
fn a_rod_bounces_on_its_end_and_returns() {
    let n = 6;
    let l = 1.0 / n as f64;
    let (mut k, mut m) = (Vec::new(), Vec::new());
    for e in 0..n {
        for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            k.push((e + a, e + b, if a == b { 1.0 / l } else { -1.0 / l }));
            m.push((e + a, e + b, l / 6.0 * if a == b { 2.0 } else { 1.0 }));
        }
    }
    let matrix = |entries: &[_]| sparse_from_triplets(n + 1, n + 1, entries).unwrap();
    let dofs = (0..=n).map(|node| Dof { node, position: l * node as f64, kind: DofKind::Axial }).collect();
    let base = Contact::rigid(0, Side::Negative, 0.0);
    let model = StructuralModel::new(matrix(&m), matrix(&k), dofs, vec![base]).unwrap();
    let force: Vec<f64> = (0..=n).map(|i| if i == 0 { 0.0 } else { -0.1 * l }).collect();
    let motions = Mat::from_fn(n + 1, 1, |_, _| 1.0);
    let model = model.with_steady_force(SteadyForce { force: force.clone(), motions }).unwrap();
    let structure = condense(&model);
    let (mut problem, start) = problem(&structure, 1, 40, Symmetry::Even, Switching::Exact);
    assert!((start.omega / TAU / 0.25 - 1.0).abs() < 5e-3, "{}", start.omega);
    let branch = follow(&mut problem, &start, 2.0);
    let point = structure.modal_point(&mut problem, &branch.points.last().unwrap().x, 0.0).unwrap();
    assert!(point.contact_fraction < 0.99, "{}", point.contact_fraction);
    let full = support::FullMatrices::of(&model);
    let mass: Vec<Vec<f64>> = (1..=n).map(|i| full.m[i][1..].to_vec()).collect();
    let acceleration = |q: &[f64]| -> Vec<f64> {
        // The massless end follows the next node until it meets the base.
        let end = (-full.k[0][1] * q[0] / full.k[0][0]).max(0.0);
        let at = |i: usize| -> f64 { (1..=n).map(|j| full.k[i][j] * q[j - 1]).sum::<f64>() + full.k[i][0] * end };
        support::solve_dense(mass.clone(), (1..=n).map(|i| force[i] - at(i)).collect())
    };
    let first: Vec<f64> = (1..=n).map(|d| point.coefficients.value(d, 0.0)).collect();
    let (mut q, mut v) = (first.clone(), vec![0.0; n]);
    let steps = 4000;
    let h = TAU / point.omega / f64::from(steps);
    let moved = |x: &[f64], d: &[f64], by: f64| x.iter().zip(d).map(|(x, d)| x + by * d).collect::<Vec<f64>>();
    for _ in 0..steps {
        let a1 = acceleration(&q);
        let v2 = moved(&v, &a1, 0.5 * h);
        let a2 = acceleration(&moved(&q, &v, 0.5 * h));
        let v3 = moved(&v, &a2, 0.5 * h);
        let a3 = acceleration(&moved(&q, &v2, 0.5 * h));
        let v4 = moved(&v, &a3, h);
        let a4 = acceleration(&moved(&q, &v3, h));
        for i in 0..n {
            q[i] += h / 6.0 * (v[i] + 2.0 * v2[i] + 2.0 * v3[i] + v4[i]);
            v[i] += h / 6.0 * (a1[i] + 2.0 * a2[i] + 2.0 * a3[i] + a4[i]);
        }
    }
    let size = first.iter().fold(0.0_f64, |m, q| m.max(q.abs()));
    let missing = q.iter().zip(&first).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    assert!(missing < 1e-4 * size, "{missing:e} of {size:e}");
}

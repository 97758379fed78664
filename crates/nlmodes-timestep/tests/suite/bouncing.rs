//! A body under its weight that contacts alone carry: parabolas while it flies, in closed form.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use nlmodes_continuation::{Bound, Continuation, Linearization, ParametricSystem};
use nlmodes_linalg::{Mat, sparse_from_triplets};
use nlmodes_model::{Contact, Dof, DofKind, Drop, MasslessContactModel, Side, SteadyForce, StructuralModel};
use nlmodes_timestep::{ContactDynamics, GalerkinReduction, ModeShooting, ShootingScales, Verification};

/// The lowest mode.
const LOWEST: ShootingScales = ShootingScales { omega: 0.0, energy: 1.0 };

/// Masses one above the other on springs of stiffness k, the lowest on a massless tip with a base under it; each has
/// the same weight.
fn tower(masses: &[f64], k: f64, weight: f64, gap: f64) -> MasslessContactModel {
    let n = masses.len() + 1;
    let mut stiffness = Vec::new();
    for i in 1..n {
        stiffness.extend([(i, i, k), (i - 1, i - 1, k), (i, i - 1, -k), (i - 1, i, -k)]);
    }
    let mass: Vec<_> = masses.iter().enumerate().map(|(i, m)| (i + 1, i + 1, *m)).collect();
    let matrix = |entries: &[_]| sparse_from_triplets(n, n, entries).unwrap();
    let dofs = (0..n).map(|node| Dof { node, position: node as f64, kind: DofKind::Axial }).collect();
    let base = Contact::rigid(0, Side::Negative, gap);
    let model = StructuralModel::new(matrix(&mass), matrix(&stiffness), dofs, vec![base]).unwrap();
    let force = (0..n).map(|i| if i == 0 { 0.0 } else { -weight }).collect();
    let steady = SteadyForce { force, motions: Mat::from_fn(n, 1, |_, _| 1.0) };
    MasslessContactModel::new(&model.with_steady_force(steady).unwrap(), &Drop).unwrap()
}

/// Frequency and averaged kinetic energy of one mass with this amplitude about rest on its spring.
fn bounce([m, k, w]: [f64; 3], amplitude: f64) -> [f64; 2] {
    let (omega, g) = ((k / m).sqrt(), w / m);
    let pressed = (-w / (k * amplitude)).acos() / omega;
    let speed = amplitude * omega * (omega * pressed).sin();
    let half = pressed + speed / g;
    let on_spring = (amplitude * omega).powi(2) * (0.5 * pressed - (2.0 * omega * pressed).sin() / (4.0 * omega));
    [PI / half, 0.5 * m * (on_spring + speed.powi(3) / (3.0 * g)) / half]
}

#[test]
fn a_mass_that_bounces_flies_along_parabolas() {
    for (m, k, w, gap) in [(1.0, 1000.0, 10.0, 0.0), (1.0, 1000.0, 10.0, 0.2), (1e3, 1e6, 1e7, 0.0)] {
        let model = tower(&[m], k, w, gap);
        let mut dynamics = ContactDynamics::new(model.clone()).unwrap();
        let start = dynamics.grazing(0.0).unwrap();
        let sag = w / k;
        assert!((start.omega / (k / m).sqrt() - 1.0).abs() < 1e-12);
        assert!((start.energy / (0.25 * k * sag * sag) - 1.0).abs() < 1e-12);
        assert!((dynamics.energy_at_rest().unwrap() / (-w * (gap + 0.5 * sag)) - 1.0).abs() < 1e-12);
        // Thrown up from the base at 4 times the amplitude that lets go.
        let amplitude = 4.0 * sag;
        let [omega, energy] = bounce([m, k, w], amplitude);
        let state = dynamics.state(&[0.0, -(gap + sag) - amplitude], &[0.0; 2]).unwrap();
        let trajectory = dynamics.propagate(&state, 2.0 * PI / omega).unwrap();
        assert!((trajectory.end.z[0] / state.z[0] - 1.0).abs() < 1e-11 && trajectory.end.v[0].abs() < 1e-9);
        assert!((trajectory.kinetic_integral() * omega / (2.0 * PI) / energy - 1.0).abs() < 1e-12);
        assert!((trajectory.peak_force(0) / (5.0 * w) - 1.0).abs() < 1e-11);
        assert!((trajectory.impulse(0) * omega / (2.0 * PI) / w - 1.0).abs() < 1e-11, "its mean force is its weight");
        let found = Verification::new(&mut dynamics, &state, 2.0 * PI / omega).unwrap();
        assert!((found.energy / (0.5 * k * amplitude * amplitude) - 1.0).abs() < 1e-11, "above rest");
        assert!(found.energy_norm < 1e-9 && found.energy_drift < 1e-11 && found.n_intervals == 1, "{found:?}");
        // Highest it is at the speed that it left with: h = v²/2g above the tip.
        let speed2 = k / m * (amplitude * amplitude - sag * sag);
        let top = trajectory.at(PI / omega).displacement[1];
        assert!((top / (speed2 * m / (2.0 * w) - gap) - 1.0).abs() < 1e-10, "{top}");
    }
}

/// The whole nonlinear mode by shooting, with the Jacobian by differences; of two masses with few modes too, the second
/// of which follows statically.
#[test]
fn the_mode_of_a_bouncing_body_is_found_by_shooting() {
    for (masses, modes) in [(&[1.0][..], 1), (&[1.0, 0.3], 2), (&[1.0, 0.3, 0.2], 2)] {
        let (k, w) = (1000.0, 10.0);
        let reduced = GalerkinReduction::new(tower(masses, k, w, 0.1), modes).unwrap();
        let mut shooting = ModeShooting::new(reduced, LOWEST, 8).unwrap();
        let (x, direction) = shooting.start();
        let bounds = vec![Bound { coordinate: shooting.dim(), min: -1.0, max: 1.05_f64.ln() }];
        let method = Continuation { bounds, max_points: 300, ..Continuation::default() };
        let branch = method.run(&mut *shooting, &x, 0.0, &direction, |_| ControlFlow::Continue(())).unwrap();
        let last = branch.points.last().unwrap();
        let motion = shooting.motion(&last.x).unwrap();
        let closed: f64 = motion.trajectory.closed_intervals().iter().map(|of| of.to - of.from).sum();
        assert!(closed < 0.99 * motion.trajectory.duration(), "{masses:?}: it lets go");
        if masses.len() == 1 {
            let energy = motion.kinetic_energy;
            let sag = w / k;
            let amplitude = 0.5 * (motion.trajectory.peak_force(0) - w) / (0.5 * k);
            let [omega, expected] = bounce([1.0, k, w], amplitude);
            assert!((motion.omega / omega - 1.0).abs() < 1e-9 && (energy / expected - 1.0).abs() < 1e-9, "{sag}");
        }
        let n = shooting.dim();
        let (mut at, mut above, mut below) = (Linearization::new(n), Linearization::new(n), Linearization::new(n));
        shooting.linearize(&last.x, last.p, &mut at).unwrap();
        for j in 0..n {
            let shifted = |h: f64| {
                let mut x = last.x.clone();
                x[j] += h;
                x
            };
            shooting.linearize(&shifted(1e-6), last.p, &mut above).unwrap();
            shooting.linearize(&shifted(-1e-6), last.p, &mut below).unwrap();
            for i in 0..n {
                let difference = (above.residual[i] - below.residual[i]) / 2e-6;
                let entry = at.jacobian[(i, j)];
                assert!(
                    (difference - entry).abs() < 1e-5 * (1.0 + entry.abs()),
                    "{masses:?} {i} {j}: {difference} {entry}"
                );
            }
        }
        shooting.floquet(&last.x).unwrap();
    }
}

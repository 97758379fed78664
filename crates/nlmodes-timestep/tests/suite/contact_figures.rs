//! Contact quantities, units of unknowns, and sizes, compared with closed forms.

use crate::support;

use std::f64::consts::{PI, TAU};

use nlmodes_continuation::{Linearization, ParametricSystem};
use nlmodes_fem::{Direction, MassMatrix, Material, Mesh, Rod, Stop, Support};
use nlmodes_modal::{HarmonicCoefficients, shifted};
use nlmodes_model::Side;
use nlmodes_timestep::{ContactDynamics, GalerkinReduction, Shooting, ShootingScales, TimestepError, Verification};
use num_complex::Complex64;
use support::{ClosedForm, OMEGA_CONTACT, OMEGA_FREE, massless, rod_with, settle, unit_rod};

/// The rod of two elements in the closed form; a second stop, behind the tip, is not reached at amplitude 2.
fn rod_in_a_wide_slot() -> ContactDynamics {
    let stop = |side, gap| Stop::rigid(1.0, Direction::Axial, side, gap);
    ContactDynamics::new(massless(&rod_with(2, &[stop(Side::Positive, 1.0), stop(Side::Negative, 5.0)]))).unwrap()
}

#[test]
fn figures_of_a_contact_are_those_of_the_closed_form() {
    let (mut rod, closed) = (rod_in_a_wide_slot(), ClosedForm::new(2.0));
    for begin in [0.0, 0.3, 0.5, 0.8] {
        let t = begin * closed.period();
        let h = 1e-6;
        let [before, at, after] = [-h, 0.0, h].map(|h| closed.position(t + h));
        let speed = (after[0] - before[0]) / (2.0 * h);
        let state = rod.state(&at, &[speed, 0.0]).unwrap();
        let trajectory = rod.propagate(&state, closed.period()).unwrap();
        let periods = trajectory.contact_periods(2);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-7, "from {begin}: {a}, not {b}");
        // λ = 2 (x − 1) while x = ½ + B cos ω_c t is beyond 1.
        let half = closed.half[0];
        near(periods[0].peak_force, 2.0 * (closed.b - 0.5));
        near(periods[0].impulse, 4.0 * (closed.b * (OMEGA_CONTACT * half).sin() / OMEGA_CONTACT - 0.5 * half));
        near(periods[0].mean_force, periods[0].impulse / closed.period());
        near(periods[0].closed_share, 2.0 * half / closed.period());
        // The tip follows the node with mass until it touches: 3 (A² − 1) = ½ ẋ².
        near(periods[0].approach_velocity, (6.0 * (closed.a * closed.a - 1.0)).sqrt());
        assert_eq!(periods[0].touches, 1);
        near(trajectory.smallest_gap(0), 0.0);
        let other = &periods[1];
        let nothing = [other.peak_force, other.impulse, other.mean_force, other.closed_share, other.approach_velocity];
        assert_eq!((nothing, other.touches), ([0.0; 5], 0), "a stop out of reach");
        near(trajectory.smallest_gap(1), 5.0 - closed.a);
        let instants = trajectory.contact_instants(0);
        assert_eq!(instants.len(), 2, "{instants:?}");
        for instant in instants {
            near(closed.position(t + instant.time)[0], 1.0);
        }
    }
}

#[test]
fn instants_of_contact_are_those_of_the_closed_form_right_after_the_beginning_too() {
    let (mut rod, closed) = (rod_in_a_wide_slot(), ClosedForm::new(2.0));
    let half = closed.half[0];
    for early in [0.3, 0.05, 1e-3] {
        let (t, h) = (closed.period() - half - early, 1e-6);
        let [before, at, after] = [-h, 0.0, h].map(|h| closed.position(t + h));
        let state = rod.state(&at, &[(after[0] - before[0]) / (2.0 * h), 0.0]).unwrap();
        let instants = rod.propagate(&state, 1.1 * (early + 2.0 * half)).unwrap().contact_instants(0);
        let found: Vec<(f64, bool)> = instants.iter().map(|instant| (instant.time, instant.touching)).collect();
        let [(touching, true), (leaving, false)] = found[..] else { panic!("{found:?}") };
        assert!((touching - early).abs() < 1e-8 && (leaving - early - 2.0 * half).abs() < 1e-8, "{found:?}");
    }
}

#[test]
fn a_stretch_without_contact_has_the_smallest_gap_of_its_own() {
    // Only while it is free, on its way out and back.
    let (mut rod, closed) = (rod_in_a_wide_slot(), ClosedForm::new(2.0));
    let state = rod.state(&closed.position(0.0), &[0.0; 2]).unwrap();
    for share in [0.3, 0.4, 0.6] {
        let end = share * closed.period();
        let trajectory = rod.propagate(&state, end).unwrap();
        let farthest = if share > 0.5 { -closed.a } else { closed.position(end)[0] };
        assert!((trajectory.smallest_gap(1) - (5.0 + farthest)).abs() < 1e-12, "{share}");
        assert!((trajectory.duration() - end).abs() < 1e-15);
        let mean = trajectory.impulse(0);
        let half = 2.0 * (closed.b * (OMEGA_CONTACT * closed.half[0]).sin() / OMEGA_CONTACT - 0.5 * closed.half[0]);
        assert!((mean - half).abs() < 1e-12, "half of the contact");
    }
}

#[test]
fn a_stop_that_touches_at_rest_is_not_grazed_and_one_at_any_distance_is() {
    for (gap, fine) in [(1.0, true), (1e-3, true), (0.0, false)] {
        let model = rod_with(6, &[Stop::rigid(1.0, Direction::Axial, Side::Positive, gap)]);
        let found = ContactDynamics::new(massless(&model)).unwrap().grazing(1.6);
        match found {
            Ok(start) => assert!(fine && start.energy > 0.0),
            Err(TimestepError::TouchesAtRest { omega }) => assert!(!fine && omega > 1.5, "{omega}"),
            Err(other) => panic!("{other}"),
        }
    }
}

/// Sines have the same energy as cosines: the energy does not depend on the initial instant.
#[test]
fn the_averaged_kinetic_energy_does_not_depend_on_where_the_motion_begins() {
    let rod = ContactDynamics::new(massless(&unit_rod(6))).unwrap();
    let mut motion = HarmonicCoefficients::zeros(6, 3);
    for (d, n) in (0..6).flat_map(|d| (0..=3).map(move |n| (d, n))) {
        motion.of_mut(d)[n] =
            Complex64::new((1.3 * d as f64 + n as f64).sin(), if n == 0 { 0.0 } else { (d * n) as f64 });
    }
    let energy = rod.averaged_kinetic_energy(&motion, 1.3).unwrap();
    assert!(energy > 0.0);
    for phase in [0.3, 0.5 * PI, -2.0] {
        let later = rod.averaged_kinetic_energy(&shifted(&motion, phase), 1.3).unwrap();
        assert!((later / energy - 1.0).abs() < 1e-13, "{later} {energy}");
    }
}

#[test]
fn each_linear_mode_grazes_by_itself() {
    let mut rod = ContactDynamics::new(massless(&unit_rod(6))).unwrap();
    let omegas = rod.omega().to_vec();
    for (k, omega) in omegas.iter().enumerate().take(3) {
        let start = rod.grazing(1.01 * omega).unwrap();
        assert!((start.omega / omega - 1.0).abs() < 1e-12 && start.contact == 0, "mode {}", k + 1);
        let expected = 0.25 * (omega * start.amplitude[k]).powi(2);
        assert!((start.energy / expected - 1.0).abs() < 1e-9, "mode {}", k + 1);
        let trajectory = rod.propagate(&start.state, 1.5 * TAU / omega).unwrap();
        assert!(trajectory.smallest_gap(0).abs() < 1e-9 && trajectory.impulse(0) < 1e-6, "mode {}", k + 1);
    }
}

#[test]
fn unknowns_of_shooting_are_in_the_units_that_are_told() {
    let rod = ContactDynamics::new(massless(&unit_rod(4))).unwrap();
    let (omegas, scales) = (rod.omega().to_vec(), ShootingScales { omega: 2.0, energy: 0.3 });
    let shooting = Shooting::new(rod, scales).unwrap();
    let mut x = vec![0.0; omegas.len() + 1];
    for (k, omega) in omegas.iter().enumerate() {
        x[k] = 0.7;
        let expected = 0.7 * 0.6_f64.sqrt() / omega.max(2.0);
        let state = shooting.state(&x);
        assert!((state.z[k] / expected - 1.0).abs() < 1e-14 && state.v.iter().all(|v| *v == 0.0), "mode {}", k + 1);
        x[k] = 0.0;
    }
}

/// A distant guess at another energy leads to the same motion.
#[test]
fn a_motion_near_a_guess_has_the_energy_of_the_parameter() {
    let (mut shooting, x, direction) =
        Shooting::from_grazing(ContactDynamics::new(massless(&unit_rod(3))).unwrap(), 1).unwrap();
    let guess: Vec<f64> = x.iter().zip(&direction).map(|(x, t)| x + 0.02 * t).collect();
    let motion = shooting.motion_near(&guess, 0.04).unwrap();
    assert!((motion.kinetic_energy / shooting.energy(0.04) - 1.0).abs() < 1e-7, "{}", motion.kinetic_energy);
    let (settled, _) = settle(&mut shooting, guess, 0.04);
    assert!((motion.omega / shooting.omega(&settled) - 1.0).abs() < 1e-8);
}

#[test]
fn a_reduced_structure_counts_its_modes() {
    let two = [
        Stop::rigid(1.0, Direction::Axial, Side::Positive, 1.0),
        Stop::rigid(0.5, Direction::Axial, Side::Positive, 0.5),
    ];
    for (stops, contacts) in [(&two[..1], 1), (&two[..], 2)] {
        let model = massless(&rod_with(12, stops));
        let massive = model.linear_dofs().len();
        for count in [2, 4] {
            let reduced = GalerkinReduction::new(model.clone(), count).unwrap();
            assert_eq!((reduced.n_held_modes(), reduced.n_kept_modes()), (count, count));
            assert_eq!(reduced.n_modes(), count + contacts, "with a static shape a contact");
            // A static shape of the reduced structure is that of the full one.
            let full: Vec<f64> = (0..model.dofs().len()).map(|i| (i + 1) as f64).collect();
            let back = reduced.expand(&reduced.project(&full).unwrap());
            if contacts == 1 {
                // A rod that is pulled at its tip is straight.
                for dof in model.linear_dofs() {
                    assert!((back[*dof] / full[*dof] - 1.0).abs() < 1e-9, "{dof}: {}", back[*dof]);
                }
            }
        }
        let whole = GalerkinReduction::new(model, 100).unwrap();
        assert_eq!((whole.n_held_modes(), whole.n_kept_modes(), whole.n_modes()), (massive, massive, massive));
    }
}

/// Gap and force with their first two derivatives, in contact and free.
#[test]
fn the_state_of_a_contact_is_that_of_the_closed_form_at_every_instant() {
    let (mut rod, closed) = (rod_in_a_wide_slot(), ClosedForm::new(2.0));
    let state = rod.state(&closed.position(0.0), &[0.0; 2]).unwrap();
    let trajectory = rod.propagate(&state, closed.period()).unwrap();
    for share in [0.01, 0.1, 0.3, 0.45, 0.6, 0.8, 0.97] {
        let t = share * closed.period();
        let found = trajectory.contact_state(0, t);
        let to_the_middle = t.min(closed.period() - t);
        let (gap, force) = if to_the_middle < closed.half[0] {
            let (sin, cos) = (OMEGA_CONTACT * if share < 0.5 { t } else { t - closed.period() }).sin_cos();
            let x = [0.5 + closed.b * cos, -closed.b * OMEGA_CONTACT * sin, -closed.b * OMEGA_CONTACT.powi(2) * cos];
            ([0.0; 3], [2.0 * (x[0] - 1.0), 2.0 * x[1], 2.0 * x[2]])
        } else {
            let (sin, cos) = (OMEGA_FREE * (0.5 * closed.period() - t)).sin_cos();
            let x = [-closed.a * cos, -closed.a * OMEGA_FREE * sin, closed.a * OMEGA_FREE.powi(2) * cos];
            ([1.0 - x[0], -x[1], -x[2]], [0.0; 3])
        };
        let pairs = found.gap.iter().zip(gap).chain(found.force.iter().zip(force));
        pairs.for_each(|(a, b)| assert!((a - b).abs() < 1e-10, "{share}: {found:?}, not {gap:?} and {force:?}"));
    }
}

/// A rod that vibrates by a micrometre, in seconds, hours and microseconds.
#[test]
fn slow_and_small_motions_are_motions_too() {
    for density in [1.0, 1e6, 1e-12] {
        let rod = Rod {
            material: Material::new(1.0, density).unwrap(),
            area: 1.0,
            mesh: Mesh::uniform(1.0, 3).unwrap(),
            mass_matrix: MassMatrix::Consistent,
            start: Support::Clamped,
            end: Support::Free,
        };
        let stop = Stop::rigid(1.0, Direction::Axial, Side::Positive, 1e-6);
        let mut dynamics = ContactDynamics::new(massless(&rod.assemble(&[stop]).unwrap())).unwrap();
        let omega = dynamics.omega()[0];
        // Waves take √ρ to run through the rod.
        let unit = ContactDynamics::new(massless(&unit_rod(3))).unwrap().omega()[0];
        assert!((omega * density.sqrt() / unit - 1.0).abs() < 1e-9, "{omega} {unit}");
        let mut start = dynamics.grazing(omega).unwrap().state;
        start.z.iter_mut().for_each(|z| *z *= 0.9);
        let free = Verification::new(&mut dynamics, &start, TAU / omega).unwrap();
        assert!(free.energy > 0.0 && free.energy < 1e-9 && free.energy_norm < 1e-12, "{free:?}");
        let (mut shooting, x, direction) = Shooting::from_grazing(dynamics, 1).unwrap();
        let n = shooting.dim();
        assert!(shooting.scaling().is_some(), "unknowns are over their sizes");
        let mut at = Linearization::new(n);
        shooting.linearize(&x, 0.0, &mut at).unwrap();
        let along = (0..n).map(|i| (0..=n).map(|j| at.jacobian[(i, j)] * direction[j]).sum::<f64>().abs());
        assert!(at.residual_norm() < 1e-10 && along.fold(0.0, f64::max) < 1e-5, "{density}: {:e}", at.residual_norm());
    }
}

//! Rest under interference and preload, and linear modes with closed contacts.

use nlmodes_contact::solver_by_name;
use nlmodes_fem::{Direction, MassMatrix, Material, Mesh, Rod, Stop, Support};
use nlmodes_linalg::{SparseMatrix, add_scaled, sparse_from_triplets, triplets};
use nlmodes_model::reduction::{ModeCount, OpenModes, ReductionError};
use nlmodes_model::{Drop, MasslessContactModel, Side, StructuralModel, held_modes, linear_modes};

const ELEMENTS: usize = 24;

/// A rod of EA = 3 and mass per length 5 on a length of 2, in units of `metre` and `kilogram`; stops at its tip and
/// middle with these gaps.
fn rod(start: Support, gaps: [f64; 2], spring: Option<f64>, metre: f64, kilogram: f64) -> StructuralModel {
    let rod = Rod {
        material: Material::new(3.0 * metre / kilogram, 5.0 * metre.powi(3) / kilogram).unwrap(),
        area: 1.0 / metre.powi(2),
        mesh: Mesh::uniform(2.0 / metre, ELEMENTS).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start,
        end: Support::Free,
    };
    let at = |x: f64, gap: f64| {
        let stop = Stop::rigid(x / metre, Direction::Axial, Side::Positive, gap / metre);
        // N/m is kg/s².
        spring.map_or(stop, |k| stop.on_spring(k / kilogram))
    };
    rod.assemble(&[at(2.0, gaps[0]), at(1.0, gaps[1])]).unwrap()
}

fn open(model: &StructuralModel, modes: usize) -> OpenModes {
    OpenModes::of_model(model, ModeCount::Lowest(modes)).unwrap()
}

#[test]
fn interference_presses_with_the_stiffness_of_the_structure() {
    let solver = solver_by_name("active-set").unwrap();
    for (metre, kilogram) in [(1.0, 1.0), (1e-3, 1e3)] {
        for modes in [1, 4, 11] {
            // The tip is pushed back by 0.1 against EA/L = 1.5; the middle follows by half of it and stays open.
            let pressed = open(&rod(Support::Clamped, [-0.1, 1.0], None, metre, kilogram), modes);
            let rest = pressed.rest(&[], solver.as_ref()).unwrap();
            assert_eq!(rest.closed, [true, false]);
            let newton = kilogram * metre;
            assert!((rest.forces[0] * newton - 0.15).abs() < 1e-11, "{}", rest.forces[0] * newton);
            assert!(rest.gaps[0].abs() < 1e-12 / metre && (rest.gaps[1] * metre - 1.05).abs() < 1e-11);
            // On a spring of the same stiffness half the force.
            let soft = open(&rod(Support::Clamped, [-0.1, 1.0], Some(1.5), metre, kilogram), modes);
            let rest = soft.rest(&[], solver.as_ref()).unwrap();
            assert!((rest.forces[0] * newton - 0.075).abs() < 1e-11);
        }
    }
}

#[test]
fn a_preload_closes_the_contact_that_it_pushes_against() {
    let solver = solver_by_name("active-set").unwrap();
    let free = open(&rod(Support::Clamped, [0.1, 1.0], None, 1.0, 1.0), 5);
    assert_eq!(free.rest(&[], solver.as_ref()).unwrap().closed, [false, false]);
    // P = 0.6 at the middle moves everything beyond by P/(EA/1) = 0.2: the tip is stopped at 0.1, which takes λ =
    // 0.1·EA/L.
    let mut force = vec![0.0; ELEMENTS];
    force[ELEMENTS / 2 - 1] = 0.6;
    let load = free.load(&force).unwrap();
    let rest = free.rest(&[&load], solver.as_ref()).unwrap();
    assert_eq!(rest.closed, [true, false]);
    assert!((rest.forces[0] - 0.15).abs() < 1e-11, "{rest:?}");
    let rows = free.rows_of_dofs(&[ELEMENTS / 2 - 1, ELEMENTS - 1]).unwrap();
    let moved = |row: usize, dof: usize| rows.value(row, &rest.eta, &rest.forces) + load.residual[dof];
    assert!((moved(1, ELEMENTS - 1) - 0.1).abs() < 1e-12);
    assert!((moved(0, ELEMENTS / 2 - 1) - (0.2 - 0.15 / 3.0)).abs() < 1e-12);
}

#[test]
fn closed_contacts_give_the_modes_of_the_held_structure() {
    for (metre, kilogram) in [(1.0, 1.0), (1e-3, 1e3)] {
        let model = rod(Support::Clamped, [0.0, 0.0], None, metre, kilogram);
        let massless = MasslessContactModel::new(&model, &Drop).unwrap();
        let all = OpenModes::of_massless(&massless, ModeCount::Lowest(ELEMENTS)).unwrap();
        let closed = all.closed_modes(&[true, true]).unwrap();
        let held = held_modes(&massless, ELEMENTS).unwrap();
        for (found, expected) in closed.omega_squared.iter().zip(&held.omega) {
            assert!((found.sqrt() / expected - 1.0).abs() < 1e-9, "{found} {expected}");
        }
    }
    // On springs: those of the structure with the springs in its stiffness, with mass everywhere, as modes are added.
    let model = rod(Support::Clamped, [0.0, 0.0], Some(2.0), 1.0, 1.0);
    let springs = [(ELEMENTS - 1, ELEMENTS - 1, 2.0), (ELEMENTS / 2 - 1, ELEMENTS / 2 - 1, 2.0)];
    let springs = nlmodes_linalg::sparse_from_triplets(ELEMENTS, ELEMENTS, &springs).unwrap();
    let k = nlmodes_linalg::add_scaled(model.stiffness(), 1.0, &springs).unwrap();
    let exact = linear_modes(model.mass(), &k, 1).unwrap().omega[0];
    let error = |m| open(&model, m).closed_modes(&[true, true]).unwrap().omega_squared[0].sqrt() / exact - 1.0;
    assert!(error(3) > error(6) && error(6) > 4.0 * error(12) && error(12) > -1e-12, "{} {}", error(6), error(12));
    assert!(error(12) < 1e-4);
}

#[test]
fn the_estimate_of_the_truncation_bounds_its_error() {
    let model = rod(Support::Clamped, [0.0, 0.0], None, 1.0, 1.0);
    // Fixed at tip and middle: the halves of length 1, the element matrices of which have this exact solution.
    let theta = std::f64::consts::PI / (ELEMENTS / 2) as f64;
    let h = 2.0 / ELEMENTS as f64;
    let exact = (6.0 * 0.6 / (h * h) * (1.0 - theta.cos()) / (2.0 + theta.cos())).sqrt();
    for m in [6, 10, 16] {
        let open = open(&model, m);
        let frequency = open.closed_modes(&[true, true]).unwrap().omega_squared[0].sqrt();
        let (error, estimate) = ((frequency / exact - 1.0).abs(), open.truncation_error(&[true, true], 0).unwrap());
        assert!(error < estimate && estimate < 60.0 * error + 1e-9, "{m}: {error:e} {estimate:e}");
    }
}

#[test]
fn a_floating_structure_rests_only_where_nothing_presses() {
    let solver = solver_by_name("active-set").unwrap();
    let apart = open(&rod(Support::Free, [0.1, 0.2], None, 1.0, 1.0), 6);
    assert!(apart.floats());
    assert_eq!(apart.rest(&[], solver.as_ref()).unwrap().closed, [false, false]);
    let pressed = open(&rod(Support::Free, [-0.1, 0.2], None, 1.0, 1.0), 6);
    assert_eq!(pressed.rest(&[], solver.as_ref()).unwrap_err(), ReductionError::FloatingRest);
    // With its tip fixed it is a rod fixed at one end: there is no rigid-body motion.
    let closed = apart.closed_modes(&[true, false]).unwrap();
    assert!(closed.omega_squared[0].sqrt() > 0.5);
    assert!(matches!(apart.closed_modes(&[true]).unwrap_err(), ReductionError::Dimension { .. }));
}

#[test]
fn the_estimate_for_two_equal_bodies_is_that_of_one_before_a_wall() {
    let (model, n) = (rod(Support::Clamped, [0.0, 0.0], None, 1.0, 1.0), ELEMENTS);
    let twice = |a: &nlmodes_linalg::SparseMatrix| {
        let both = nlmodes_linalg::triplets(a).flat_map(|(i, j, v)| [(i, j, v), (n + i, n + j, v)]);
        nlmodes_linalg::sparse_from_triplets(2 * n, 2 * n, &both.collect::<Vec<_>>()).unwrap()
    };
    let directions =
        |rows: usize, entries: &[(usize, usize, f64)]| nlmodes_linalg::sparse_from_triplets(rows, 1, entries).unwrap();
    let wall = directions(n, &[(n - 1, 0, -1.0)]);
    let pair = directions(2 * n, &[(n - 1, 0, -1.0), (2 * n - 1, 0, 1.0)]);
    let estimate = |mass, stiffness, w, modes| {
        let open = OpenModes::new(mass, stiffness, w, vec![0.1], vec![0.0], ModeCount::Lowest(modes)).unwrap();
        open.truncation_error(&[true], 0).unwrap()
    };
    let one = estimate(model.mass().clone(), model.stiffness().clone(), wall, 8);
    let two = estimate(twice(model.mass()), twice(model.stiffness()), pair, 16);
    assert!(one > 1e-6 && (two / one - 1.0).abs() < 1e-5, "{one:e} {two:e}");
}

/// Two rods side by side, one a little softer, joined by a spring that ranges from nothing to a hundredth of them:
/// their modes come in pairs of hardly different frequency, one of which hardly moves the contact.
#[test]
fn the_estimate_compares_a_mode_with_itself_however_little_bodies_are_joined() {
    let (model, n) = (rod(Support::Clamped, [0.0, 0.0], None, 1.0, 1.0), ELEMENTS);
    let twice = |a: &nlmodes_linalg::SparseMatrix, factor: f64, spring: f64| {
        let both = nlmodes_linalg::triplets(a).flat_map(|(i, j, v)| [(i, j, v), (n + i, n + j, factor * v)]);
        let (i, j) = (n / 3, n + n / 3);
        let joined = [(i, i, spring), (j, j, spring), (i, j, -spring), (j, i, -spring)];
        nlmodes_linalg::sparse_from_triplets(2 * n, 2 * n, &both.chain(joined).collect::<Vec<_>>()).unwrap()
    };
    let wall = || nlmodes_linalg::sparse_from_triplets(2 * n, 1, &[(n - 1, 0, -1.0)]).unwrap();
    for exponent in -28..-3 {
        let spring = 10.0_f64.powf(0.5 * f64::from(exponent));
        let (mass, stiffness) = (twice(model.mass(), 1.0, 0.0), twice(model.stiffness(), 0.8, spring));
        let of = |count| OpenModes::new(mass.clone(), stiffness.clone(), wall(), vec![0.1], vec![0.0], count).unwrap();
        let reduced = of(ModeCount::Lowest(16));
        for mode in 0..4 {
            let estimate = reduced.truncation_error(&[true], mode).unwrap();
            assert!(estimate < 0.02, "{spring:e} {mode}: {estimate:e}");
        }
    }
}

/// The rod twice, without a coupling, and contacts of the first one alone.
fn twice(model: &StructuralModel) -> OpenModes {
    let n = model.dofs().len();
    let both = |a: &SparseMatrix| {
        let entries: Vec<_> = triplets(a).flat_map(|(i, j, v)| [(i, j, v), (n + i, n + j, v)]).collect();
        sparse_from_triplets(2 * n, 2 * n, &entries).unwrap()
    };
    let tip = sparse_from_triplets(2 * n, 1, &[(n - 1, 0, -1.0)]).unwrap();
    let (mass, stiffness) = (both(model.mass()), both(model.stiffness()));
    OpenModes::new(mass, stiffness, tip, vec![1e-3], vec![0.0], ModeCount::Lowest(8)).unwrap()
}

#[test]
fn rigid_motions_are_those_that_contacts_hold_and_others() {
    for (metre, kilogram) in [(1.0, 1.0), (1e-3, 1e3)] {
        let rod = |start| rod(start, [0.1, 0.2], None, metre, kilogram);
        assert_eq!(open(&rod(Support::Clamped), 5).rigid_motions(), Ok((0, 0)));
        assert_eq!(open(&rod(Support::Free), 5).rigid_motions(), Ok((1, 0)), "a translation, which the stops feel");
        assert_eq!(twice(&rod(Support::Free)).rigid_motions(), Ok((2, 1)), "the second rod touches nothing");
    }
}

#[test]
fn a_negative_stiffness_is_named_with_its_mode() {
    let model = rod(Support::Clamped, [0.1, 0.2], None, 1.0, 1.0);
    let own = linear_modes(model.mass(), model.stiffness(), 3).unwrap().omega;
    // K − σ M has the same modes, with ω² − σ.
    let less = |sigma: f64, modes: usize| {
        let stiffness = add_scaled(model.stiffness(), -sigma, model.mass()).unwrap();
        let tip = sparse_from_triplets(ELEMENTS, 1, &[(ELEMENTS - 1, 0, -1.0)]).unwrap();
        OpenModes::new(model.mass().clone(), stiffness, tip, vec![0.1], vec![0.0], ModeCount::Lowest(modes))
    };
    assert!(less(0.99 * own[0] * own[0], 5).is_ok());
    let (sigma, expected) = (1.01 * own[0] * own[0], -0.01 * own[0] * own[0]);
    match less(sigma, 5).unwrap_err() {
        ReductionError::Unstable { mode: 1, omega_squared } => {
            assert!((omega_squared / expected - 1.0).abs() < 1e-9, "{omega_squared} {expected}")
        }
        other => panic!("{other}"),
    }
}

/// The free rod pressed onto elastic stops at its tip and middle by its weight.
#[test]
fn a_floating_structure_rests_where_its_contacts_carry_its_load() {
    let solver = solver_by_name("active-set").unwrap();
    for (metre, kilogram) in [(1.0, 1.0), (1e-3, 1e3)] {
        let newton = kilogram * metre;
        for modes in [3, 6, ELEMENTS + 1] {
            // The tip stands 0.05 before its stop, the middle 0.2.
            let model = rod(Support::Free, [0.05, 0.2], Some(30.0), metre, kilogram);
            let weight = nlmodes_linalg::multiply(model.mass(), &[0.6; ELEMENTS + 1]);
            let floating = open(&model, modes);
            let load = floating.load(&weight.iter().map(|f| f / metre).collect::<Vec<_>>()).unwrap();
            // 0.6 m/s² of 10 kg are 6 N.
            let (force, rigid) = (load.modal[..1].to_vec(), floating.n_rigid());
            assert_eq!((rigid, floating.unfelt_motions()), (1, Vec::new()));
            let loaded = floating.clone().with_steady_force(force.clone()).unwrap();
            let rest = loaded.rest(&[], solver.as_ref()).unwrap();
            let carried = (rest.forces[0] + rest.forces[1]) * newton;
            assert!((carried - 6.0).abs() < 1e-9, "{carried}");
            // N(x) = −λ₁ + 3 (2 − x) stretches the part between the stops: u₂ − u₁ = (λ₁ − 1.5)/3, and λ = 30 (u − g).
            let forces = [rest.forces[0] * newton, rest.forces[1] * newton];
            assert!((forces[0] - 2.125).abs() < 1e-8 && (forces[1] - 3.875).abs() < 1e-8, "{modes}: {forces:?}");
            // Upward it leaves them.
            let away = floating.with_steady_force(vec![-force[0]]).unwrap().rest(&[], solver.as_ref()).unwrap_err();
            let ReductionError::FallsAway { motion } = away else { panic!("{away}") };
            assert!(motion.iter().all(|q| (q + 1.0).abs() < 1e-6), "{motion:?}");
        }
    }
    // What no contact feels is refused if it is pushed, and rests otherwise.
    let two = twice(&rod(Support::Free, [0.1, 0.2], None, 1.0, 1.0));
    assert_eq!((two.n_rigid(), two.unfelt_motions()), (2, vec![1]));
    let pushed = two.clone().with_steady_force(vec![1.0, 0.5]).unwrap_err();
    assert!(matches!(pushed, ReductionError::FallsUnfelt { .. }), "{pushed}");
    // The stop is on the positive side: the tip goes there if the mode moves it that way.
    let toward = if two.contact_rows()[(0, 0)] < 0.0 { 1.0 } else { -1.0 };
    let carried = two.with_steady_force(vec![toward, 0.0]).unwrap();
    assert_eq!(carried.rest(&[], solver.as_ref()).unwrap().closed, [true]);
}

/// A free rod between a stop at each end, longer than their distance: pressed as the held rod would be, and the same
/// with a load, which adds to one of them.
#[test]
fn a_floating_structure_is_pressed_between_stops() {
    let solver = solver_by_name("active-set").unwrap();
    let rod = Rod {
        material: Material::new(3.0, 5.0).unwrap(),
        area: 1.0,
        mesh: Mesh::uniform(2.0, ELEMENTS).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Free,
        end: Support::Free,
    };
    let stop = |x: f64, side: Side| Stop::rigid(x, Direction::Axial, side, -0.05);
    let model = rod.assemble(&[stop(2.0, Side::Positive), stop(0.0, Side::Negative)]).unwrap();
    for modes in [4, 9] {
        let pressed = open(&model, modes);
        // Squeezed by 0.1 against EA/L = 1.5.
        let rest = pressed.rest(&[], solver.as_ref()).unwrap();
        assert!(rest.closed == [true, true] && rest.forces.iter().all(|f| (f - 0.15).abs() < 1e-9), "{rest:?}");
        assert!(rest.eta[0].abs() < 1e-9);
        let ends = |i: usize| if i == 0 || i == ELEMENTS { 0.2 } else { 0.0 };
        let force = pressed.load(&(0..=ELEMENTS).map(ends).collect::<Vec<_>>()).unwrap();
        let loaded = pressed.with_steady_force(force.modal[..1].to_vec()).unwrap();
        let rest = loaded.rest(&[], solver.as_ref()).unwrap();
        assert!((rest.forces[0] - rest.forces[1] - 0.4).abs() < 1e-9, "{rest:?}");
    }
}

//! Where a branch begins, and structures that have no beginning.

use crate::support;

use std::f64::consts::PI;

use nlmodes_contact::solver_by_name;
use nlmodes_fem::{Beam, Direction, MassMatrix, Material, Mesh, Section, Stop, Support};
use nlmodes_hbm::{HbmError, MAX_HARMONICS, PeriodicSettings, Switching, Symmetry, grazing};
use nlmodes_linalg::sparse_from_triplets;
use nlmodes_model::{Contact, Dof, DofKind, Side, StructuralModel, linear_modes};
use support::{condense, follow, problem, rod, settle, two_element_rod};

/// Equal masses on a string of equal springs between two walls, a stop at one of them.
fn chain_between_walls(masses: usize, stop: usize) -> StructuralModel {
    let m: Vec<_> = (0..masses).map(|i| (i, i, 1.0)).collect();
    let mut k: Vec<_> = (0..masses).map(|i| (i, i, 2.0)).collect();
    k.extend((1..masses).flat_map(|i| [(i, i - 1, -1.0), (i - 1, i, -1.0)]));
    StructuralModel::new(
        sparse_from_triplets(masses, masses, &m).unwrap(),
        sparse_from_triplets(masses, masses, &k).unwrap(),
        (0..masses).map(|i| Dof { node: i, position: i as f64, kind: DofKind::Axial }).collect(),
        vec![Contact::rigid(stop, Side::Positive, 0.1)],
    )
    .unwrap()
}

#[test]
fn a_stop_at_a_node_of_the_mode_is_never_touched() {
    let structure = condense(&chain_between_walls(7, 3));
    // Antisymmetric modes leave the middle at rest, symmetric ones do not.
    for mode in [2, 4, 6] {
        let error = grazing(&structure, mode).unwrap_err();
        assert!(matches!(error, HbmError::NeverTouches { mode: m, .. } if m == mode), "{error}");
        assert!(error.to_string().contains("never touches"), "{error}");
    }
    for mode in [1, 3, 5] {
        grazing(&structure, mode).unwrap();
    }
}

/// With the middle pressed the halves vibrate alike or against each other at one frequency: the latter changes no
/// force.
#[test]
fn a_pressed_mode_that_leaves_its_stop_alone_names_the_next_one_that_lifts_off() {
    let of = |gap: f64| {
        let chain = chain_between_walls(7, 3);
        let contacts = vec![Contact::rigid(3, Side::Positive, gap)];
        let (m, k, dofs) = (chain.mass().clone(), chain.stiffness().clone(), chain.dofs().to_vec());
        condense(&StructuralModel::new(m, k, dofs, contacts).unwrap())
    };
    let pressed = of(-0.1);
    let [first, third] = [1, 3].map(|mode| grazing(&pressed, mode).unwrap());
    assert!(first.lifts_off && third.lifts_off && !grazing(&of(0.1), 1).unwrap().lifts_off);
    let error = grazing(&pressed, 2).unwrap_err();
    let HbmError::NeverTouches { mode: 2, is_pressed: true, first: Some((3, hz)), .. } = error else {
        panic!("{error}");
    };
    assert!((2.0 * PI * hz / third.omega - 1.0).abs() < 1e-12, "{hz}");
    let said = error.to_string();
    assert!(said.contains("never lifts off") && said.contains("the next one that does is mode 3"), "{said}");
}

/// The mode touches the stop that it meets first once a period and comes no further at any other; none is set back.
#[test]
fn a_mode_at_grazing_just_touches_the_stop_that_it_meets_first() {
    let stops = [(6, Side::Positive, 0.05), (3, Side::Negative, 0.01), (4, Side::Positive, 0.2)];
    let model = rod(6, 2.0, 3.0, 1.0, &stops);
    let structure = condense(&model);
    for mode in [1, 2, 3] {
        let found = grazing(&structure, mode).unwrap();
        let (at_rest, amplitudes) = (found.contacts_at_rest(&structure), found.contact_amplitudes(&structure));
        let closest = |(i, (node, side, gap)): (usize, &(usize, Side, f64))| {
            let d = structure.model().contact_dofs().iter().position(|dof| dof + 1 == *node).unwrap();
            // Toward its stop: the motion at τ = 0 of the one that grazes, either way of the others.
            let [mean, swing] = [at_rest[d], amplitudes[d]].map(|q| side.sign() * q);
            gap - mean - if i == found.contact { swing } else { swing.abs() }
        };
        let gaps: Vec<f64> = stops.iter().enumerate().map(closest).collect();
        assert!(gaps[found.contact].abs() < 1e-15 && gaps.iter().all(|gap| *gap > -1e-15), "{mode}: {gaps:?}");
        let largest = amplitudes.iter().fold(0.0_f64, |most, q| most.max(q.abs()));
        assert!(largest > 0.0 && largest < 0.2, "{largest}");
        assert!(found.opening == [0.0; 3] && !found.touches_at_rest(), "{:?}", found.opening);
    }
}

#[test]
fn an_axial_mode_never_touches_a_transverse_stop() {
    let beam = Beam {
        material: Material::new(210e9, 7800.0).unwrap(),
        section: Section::rectangle(0.01, 0.1).unwrap(),
        mesh: Mesh::uniform(0.6, 8).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let stop = Stop::rigid(0.6, Direction::Transverse, Side::Positive, 1e-3);
    let model = beam.assemble(&[stop]).unwrap();
    let structure = condense(&model);
    // f = c/4L of the rod lies between the second and the third bending mode; the mesh raises it by less than 1 %.
    let axial = 2.0 * PI * (210e9_f64 / 7800.0).sqrt() / (4.0 * 0.6);
    let modes = linear_modes(structure.model().mass(), structure.model().stiffness(), 5).unwrap();
    let mode = 1 + modes.omega.iter().position(|omega| (omega / axial - 1.0).abs() < 0.01).unwrap();
    let error = grazing(&structure, mode).unwrap_err();
    assert!(matches!(error, HbmError::NeverTouches { .. }), "{error}");
    (1..=5).filter(|other| *other != mode).for_each(|other| drop(grazing(&structure, other).unwrap()));
}

#[test]
fn what_has_lost_all_mass_behind_its_contacts_is_told_from_a_mode_that_stays_away() {
    // A row of masses along the axis, and one deflection, whose mass goes with its contact.
    for unit in [1.0, 1e-6] {
        let m = sparse_from_triplets(3, 3, &[(0, 0, unit), (1, 1, unit), (2, 2, unit)]).unwrap();
        let k = [(0, 0, 2.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 1.0), (2, 2, 1.0)];
        let k = sparse_from_triplets(3, 3, &k).unwrap();
        let kinds = [DofKind::Axial, DofKind::Axial, DofKind::Deflection];
        let dofs = (0..3).map(|i| Dof { node: i, position: i as f64, kind: kinds[i] }).collect();
        let model = StructuralModel::new(m, k, dofs, vec![Contact::rigid(2, Side::Positive, 0.1)]).unwrap();
        let error = grazing(&condense(&model), 1).unwrap_err();
        assert!(matches!(error, HbmError::NoMassBehindContacts { mode: 1, .. }), "{error}");
    }
}

#[test]
fn a_rigid_body_between_walls_is_told_the_first_mode_that_vibrates() {
    for (mass, stiffness) in [(1.0, 1.0), (1e-3, 1e9)] {
        let masses: Vec<_> = (0..6).map(|i| (i, i, mass)).collect();
        let mut k = Vec::new();
        for i in 1..6 {
            let [s, t] = [stiffness, -stiffness];
            k.extend([(i - 1, i - 1, s), (i, i, s), (i - 1, i, t), (i, i - 1, t)]);
        }
        let dofs = (0..6).map(|i| Dof { node: i, position: i as f64, kind: DofKind::Axial }).collect();
        let matrix = |entries: &[(usize, usize, f64)]| sparse_from_triplets(6, 6, entries).unwrap();
        let walls = vec![Contact::rigid(0, Side::Negative, 0.1), Contact::rigid(5, Side::Positive, 0.1)];
        let model = StructuralModel::new(matrix(&masses), matrix(&k), dofs, walls).unwrap();
        let structure = condense(&model);
        let error = grazing(&structure, 1).unwrap_err();
        assert_eq!(error, HbmError::RigidBodyMode { mode: 1, first_elastic: Some(2) });
        grazing(&structure, 2).unwrap();
    }
}

#[test]
fn modes_that_do_not_exist_are_named_with_the_number_there_is() {
    let structure = condense(&rod(5, 1.0, 1.0, 1.0, &[(5, Side::Positive, 1.0)]));
    for mode in [0, 5, 1000] {
        let error = grazing(&structure, mode).unwrap_err();
        assert!(matches!(error, HbmError::NoSuchMode { mode: m, .. } if m == mode), "{mode}: {error}");
    }
    assert_eq!(grazing(&structure, 5).unwrap_err(), HbmError::NoSuchMode { mode: 5, available: 4 });
}

#[test]
fn a_stop_that_touches_at_rest_has_no_linear_motion_before_it() {
    let structure = condense(&rod(5, 1.0, 1.0, 1.0, &[(5, Side::Positive, 0.0)]));
    assert_eq!(grazing(&structure, 1).unwrap_err(), HbmError::TouchesAtRest { contact: 0, gap: 0.0 });
}

fn set_up(harmonics: usize, switching: Switching) -> Result<(), HbmError> {
    let structure = two_element_rod();
    let scales = grazing(&structure, 1).unwrap().scales();
    let settings = (PeriodicSettings { harmonics, switching, ..PeriodicSettings::default() }, Symmetry::Even);
    structure.conservative_mode(settings, scales, solver_by_name("active-set").unwrap().as_ref()).map(drop)
}

#[test]
fn a_series_needs_a_harmonic_and_two_samples_for_each_and_one_more() {
    for harmonics in [0, MAX_HARMONICS + 1] {
        assert_eq!(
            set_up(harmonics, Switching::Exact).unwrap_err(),
            HbmError::Harmonics { found: harmonics, most: MAX_HARMONICS }
        );
    }
    assert_eq!(
        set_up(5, Switching::Sampled { samples: 10 }).unwrap_err(),
        HbmError::Samples { harmonics: 5, samples: 10, needed: 11 }
    );
    for samples in [11, 12, 64] {
        set_up(5, Switching::Sampled { samples }).unwrap();
    }
}

#[test]
fn a_pressed_rod_begins_at_the_held_mode_with_the_force_just_vanishing() {
    // Pressed by 0.1 m: force EA/L·0.1, which the held mode sin(πj/N) takes away at one instant of the period.
    let (n, ea, rho_a, length, pressed) = (100, 210e9, 9000.0, 20.0, 0.1);
    let structure = condense(&rod(n, ea, rho_a, length, &[(n, Side::Positive, -pressed)]));
    let start = grazing(&structure, 1).unwrap();
    let (l, kappa) = (length / n as f64, PI / n as f64);
    let omega = (6.0 * ea / (rho_a * l * l) * (2.0 - 2.0 * kappa.cos()) / (4.0 + 2.0 * kappa.cos())).sqrt();
    assert!((start.omega / omega - 1.0).abs() < 1e-11 && (omega / 2.0 / PI - 120.766_439_06).abs() < 1e-7);
    let amplitude = pressed * ea / length / (ea / l * (kappa * (n as f64 - 1.0)).sin());
    let shape = |j: usize| (kappa * j as f64).sin();
    let square: f64 = (1..n).map(|j| rho_a * l / 6.0 * shape(j) * (4.0 * shape(j) + 2.0 * shape(j + 1))).sum();
    let energy = 0.25 * (omega * amplitude).powi(2) * square;
    assert!((start.energy / energy - 1.0).abs() < 1e-9, "{} against {energy}", start.energy);
    // Once it lifts off it is softer than held. (With a second harmonic the second held mode, at 2.001 times the first,
    // joins in at once.)
    let (mut problem, start) = problem(&structure, 1, 1, Symmetry::Even, Switching::Exact);
    let branch = follow(&mut problem, &start, 2.0);
    assert!((branch.points.last().unwrap().p - 2.0_f64.ln()).abs() < 1e-12, "{:?}", branch.stop);
    let frequency = problem.n_coefficients();
    assert!(branch.points[1..].windows(2).all(|w| w[1].x[frequency] < w[0].x[frequency]));
    // Describing function of max(b, stop) with the contact angle as parameter, in Python: 1 − 0.004048549926833.
    let end = branch.points.last().unwrap().x[frequency];
    assert!((end - 1.0 + 0.004_048_549_926_8).abs() < 1e-10, "{end}");
}

#[test]
fn a_pressed_two_element_rod_meets_its_closed_form() {
    // The tip is pushed to −1. Held: x about −½ with ω_c² = 12; off the stop, x < −1: about 0 with ω_f² = 6.
    let structure = condense(&rod(2, 1.0, 1.0, 1.0, &[(2, Side::Positive, -1.0)]));
    let start = grazing(&structure, 1).unwrap();
    // x from −1 to 0: B = ½, E_av = ¼ m ω² B² = ¼.
    assert!((start.omega - 12.0_f64.sqrt()).abs() < 1e-12 && (start.energy - 0.25).abs() < 1e-12);
    let b: f64 = 0.9;
    let a = (1.0 + 2.0 * (b * b - 0.25)).sqrt();
    let (omega_c, omega_f) = (12.0_f64.sqrt(), 6.0_f64.sqrt());
    let held = PI - (0.5 / b).acos();
    let free = (1.0 / a).acos();
    let period = 2.0 * (held / omega_c + free / omega_f);
    let integral = |theta: f64| theta - theta.sin() * theta.cos();
    let kinetic = (2.0 * b * b / omega_c * integral(held) + a * a / omega_f * integral(free)) / period;
    let (mut problem, start) = problem(&structure, 1, 60, Symmetry::Even, Switching::Exact);
    let branch = follow(&mut problem, &start, 1.5);
    let (x, residual) = settle(&mut problem, branch.points.last().unwrap().x.clone(), (kinetic / 0.25).ln());
    assert!(residual < 1e-11, "{residual:e}");
    let omega = problem.omega(&x);
    // The error falls with the fifth power of the harmonics, and is about 1e-10 at 60: see two_element_rod.rs.
    assert!((omega * period / 2.0 / PI - 1.0).abs() < 1e-9, "{omega} against {}", 2.0 * PI / period);
}

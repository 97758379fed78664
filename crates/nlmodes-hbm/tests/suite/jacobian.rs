//! The Jacobian of mixed shooting against differences of its residual.

use crate::support;

use nlmodes_continuation::conformance::jacobian_defect;
use nlmodes_continuation::{Linearization, ParametricSystem};
use nlmodes_hbm::{CondensedStructure, PeriodicSystem, Switching, Symmetry};
use nlmodes_model::reduction::{HeldMode, HeldModes};
use nlmodes_model::{MasslessContactModel, Side, StructuralModel};
use support::{condense, condense_tips, on_springs, problem, rod};

const STEP: f64 = 1e-6;

/// With a step of 1e-6 differences are good to about 1e-10 of rounding and 1e-12 of curvature; 1e-6 leaves room for the
/// third derivatives near a pole.
const TOLERANCE: f64 = 1e-6;

fn one_stop() -> CondensedStructure {
    condense(&rod(6, 1.0, 1.0, 1.0, &[(6, Side::Positive, 1.0)]))
}

fn two_degrees_of_freedom() -> CondensedStructure {
    condense(&rod(6, 1.0, 1.0, 1.0, &[(6, Side::Positive, 1.0), (2, Side::Negative, 0.45)]))
}

fn facing_stops() -> CondensedStructure {
    condense(&rod(6, 1.0, 1.0, 1.0, &[(6, Side::Positive, 1.0), (6, Side::Negative, 0.7)]))
}

/// A motion with all coefficients, `amplitude` times grazing, at `omega` times the linear frequency.
fn unknowns(model: &MasslessContactModel, problem: &PeriodicSystem, amplitude: f64, omega: f64) -> Vec<f64> {
    let (width, n) = (problem.series().width(), problem.n_coefficients());
    let mut x: Vec<f64> = (0..problem.dim())
        .map(|i| {
            let (m, d) = (i % width, i / width);
            let (harmonic, _) = problem.series().harmonic(m);
            0.17 * amplitude * (1.7 * i as f64 + 0.6 + d as f64).sin() / (1.0 + harmonic as f64).powi(2)
        })
        .collect();
    // The outer degrees of freedom move most, as in the linear mode.
    (0..n).rev().filter(|i| i % width == 1).enumerate().for_each(|(d, i)| x[i] = amplitude * (1.0 - 0.3 * d as f64));
    // The unknowns are how gaps open, from one direction after the other in the order of the contacts.
    let (w, dofs, moved) = (model.w(), model.contact_dofs(), x.clone());
    let mut seen: Vec<(usize, usize)> = (0..w.nrows())
        .filter(|d| !dofs[..*d].contains(&dofs[*d]))
        .map(|d| ((0..w.ncols()).find(|&i| w[(d, i)] != 0.0).unwrap(), d))
        .collect();
    seen.sort_unstable();
    for (j, (contact, d)) in seen.into_iter().enumerate() {
        (0..width).for_each(|m| x[j * width + m] = w[(d, contact)] * moved[d * width + m]);
    }
    x[n] = omega;
    if problem.dim() > n + 1 {
        x[n + 1] = 0.03;
    }
    x
}

/// Largest difference in a column, over the largest entry of that column: small columns count as much as large ones.
fn worst_column(problem: &mut PeriodicSystem, x: &[f64], p: f64, step: f64) -> f64 {
    let n = problem.dim();
    let (mut at, mut plus, mut minus) = (Linearization::new(n), Linearization::new(n), Linearization::new(n));
    problem.linearize(x, p, &mut at).unwrap();
    let mut worst = 0.0_f64;
    for j in 0..n {
        let shifted = |s: f64| {
            let mut x = x.to_vec();
            x[j] += s;
            x
        };
        problem.linearize(&shifted(step), p, &mut plus).unwrap();
        problem.linearize(&shifted(-step), p, &mut minus).unwrap();
        let difference = |i: usize| (plus.residual[i] - minus.residual[i]) / (2.0 * step);
        let size = (0..n).fold(f64::MIN_POSITIVE, |m, i| m.max(at.jacobian[(i, j)].abs()));
        worst = (0..n).fold(worst, |w, i| w.max((difference(i) - at.jacobian[(i, j)]).abs() / size));
    }
    worst
}

/// The modes with the contacts held that move these.
fn held(structure: &CondensedStructure) -> Vec<HeldMode> {
    HeldModes::new(structure.model(), usize::MAX).unwrap().modes
}

/// Checks the Jacobian and returns the share of the period in contact.
fn check(
    structure: &CondensedStructure,
    harmonics: usize,
    symmetry: Symmetry,
    switching: Switching,
    at: [f64; 2],
) -> f64 {
    check_with_step(structure, harmonics, symmetry, switching, at, STEP)
}

fn check_with_step(
    structure: &CondensedStructure,
    harmonics: usize,
    symmetry: Symmetry,
    switching: Switching,
    at: [f64; 2],
    step: f64,
) -> f64 {
    let (mut problem, _) = problem(structure, 1, harmonics, symmetry, switching);
    let x = unknowns(structure.model(), &problem, at[0], at[1]);
    let defect = jacobian_defect(&mut problem, &x, 0.2, step).unwrap();
    assert!(defect < TOLERANCE, "{harmonics} harmonics, {symmetry:?}, {switching:?}, {at:?}: {defect:e}");
    let worst = worst_column(&mut problem, &x, 0.2, step);
    assert!(worst < TOLERANCE, "{harmonics} harmonics, {symmetry:?}, {switching:?}, {at:?}: a column by {worst:e}");
    structure.modal_point(&mut problem, &x, 0.0).unwrap().contact_fraction
}

const SYMMETRIES: [Symmetry; 2] = [Symmetry::Even, Symmetry::None];
const SWITCHINGS: [Switching; 2] = [Switching::Exact, Switching::Sampled { samples: 64 }];

#[test]
fn jacobian_is_right_while_the_contact_stays_open() {
    for symmetry in SYMMETRIES {
        for switching in SWITCHINGS {
            for harmonics in [1, 3, 8] {
                assert_eq!(check(&one_stop(), harmonics, symmetry, switching, [0.5, 1.03]), 0.0);
            }
        }
    }
}

#[test]
fn jacobian_is_right_in_contact_for_one_to_twelve_harmonics() {
    for symmetry in SYMMETRIES {
        for switching in SWITCHINGS {
            for harmonics in [1, 2, 3, 5, 12] {
                let closed = check(&one_stop(), harmonics, symmetry, switching, [1.7, 1.13]);
                assert!(closed > 0.05 && closed < 0.95, "{closed}");
            }
        }
    }
}

#[test]
fn jacobian_is_right_at_and_beside_every_held_eigenfrequency_that_a_harmonic_meets() {
    let structure = one_stop();
    let linear = nlmodes_hbm::grazing(&structure, 1).unwrap().omega;
    for symmetry in SYMMETRIES {
        for mode in &held(&structure)[..3] {
            for harmonic in [2.0, 3.0, 5.0] {
                for beside in [0.0, 1e-12, -1e-8, 1e-4, -1e-2] {
                    let omega = mode.lambda.sqrt() / harmonic / linear * (1.0 + beside);
                    check(&structure, 5, symmetry, Switching::Exact, [1.6, omega]);
                }
            }
        }
    }
}

#[test]
fn jacobian_is_right_with_two_contacts_at_different_places() {
    for symmetry in SYMMETRIES {
        for switching in SWITCHINGS {
            for harmonics in [1, 4] {
                let structure = two_degrees_of_freedom();
                let closed = check(&structure, harmonics, symmetry, switching, [1.9, 1.07]);
                assert!(closed > 0.05 && closed < 0.95, "{closed}");
                let pole = held(&structure)[0].lambda.sqrt() / 3.0 / nlmodes_hbm::grazing(&structure, 1).unwrap().omega;
                check(&structure, harmonics, symmetry, switching, [1.9, pole * (1.0 + 1e-6)]);
            }
        }
    }
}

/// So many contacts that products go by blocks, some of them closed and others not.
#[test]
fn jacobian_is_right_with_eighteen_contacts() {
    let stops: Vec<_> = (1..=18).rev().map(|i| (2 * i, Side::Positive, 0.05 * (i % 5 + i) as f64)).collect();
    let structure = condense(&rod(36, 1.0, 1.0, 1.0, &stops));
    for symmetry in SYMMETRIES {
        let closed = check(&structure, 2, symmetry, Switching::Exact, [2.5, 1.04]);
        assert!(closed > 0.05 && closed < 0.95, "{closed}");
    }
}

#[test]
fn jacobian_is_right_between_two_stops_that_face_each_other() {
    for symmetry in SYMMETRIES {
        for switching in SWITCHINGS {
            for harmonics in [1, 4] {
                let closed = check(&facing_stops(), harmonics, symmetry, switching, [2.1, 1.2]);
                assert!(closed > 0.05 && closed < 0.95, "{closed}");
            }
        }
    }
}

/// A rod clamped at both ends with a stop in the middle: held there, both halves have the same frequencies.
fn stop_in_the_middle() -> CondensedStructure {
    let free = rod(8, 1.0, 1.0, 1.0, &[(4, Side::Positive, 1.0)]);
    let inner: Vec<usize> = (0..7).collect();
    let part = |m| nlmodes_linalg::select(m, &inner, &inner).unwrap();
    let (dofs, contacts) = (free.dofs()[..7].to_vec(), free.contacts().to_vec());
    condense(&StructuralModel::new(part(free.mass()), part(free.stiffness()), dofs, contacts).unwrap())
}

#[test]
fn jacobian_is_right_where_held_modes_of_the_same_frequency_meet_a_harmonic() {
    let equal_spans = condense(&rod(6, 1.0, 1.0, 1.0, &[(6, Side::Positive, 1.0), (3, Side::Negative, 0.6)]));
    for structure in [equal_spans, stop_in_the_middle()] {
        let linear = nlmodes_hbm::grazing(&structure, 1).unwrap().omega;
        for symmetry in SYMMETRIES {
            for beside in [0.0, 1e-12, -1e-8, 1e-4, -1e-2] {
                let omega = held(&structure)[0].lambda.sqrt() / 4.0 / linear * (1.0 + beside);
                check(&structure, 4, symmetry, Switching::Exact, [1.9, omega]);
            }
        }
    }
}

/// Elastic stops in front of massless nodes, with a rigid one among them; and harmonic balance with contact mass,
/// without, and with two springs at one node. Soft, like the structure, and stiff.
fn with_elastic_stops() -> Vec<CondensedStructure> {
    let one = rod(6, 1.0, 1.0, 1.0, &[(6, Side::Positive, 1.0)]);
    let two = rod(6, 1.0, 1.0, 1.0, &[(6, Side::Positive, 1.0), (2, Side::Negative, 0.45)]);
    let facing = rod(6, 1.0, 1.0, 1.0, &[(6, Side::Positive, 1.0), (6, Side::Negative, 0.7)]);
    let mut structures = vec![condense(&on_springs(&two, &[3.0, f64::INFINITY]))];
    for k in [2.0, 400.0] {
        structures.push(condense(&on_springs(&one, &[k])));
        structures.push(condense(&on_springs(&facing, &[k, 0.5 * k])));
        for model in [&one, &two, &facing] {
            let elastic = on_springs(model, &[k, 1.7 * k][..model.contacts().len()]);
            structures.push(condense_tips(&elastic, None));
            structures.push(condense_tips(&elastic, Some(&nlmodes_model::Drop)));
        }
    }
    structures
}

#[test]
fn jacobian_is_right_with_elastic_stops_and_in_harmonic_balance() {
    for (i, structure) in with_elastic_stops().iter().enumerate() {
        for symmetry in SYMMETRIES {
            for switching in SWITCHINGS {
                for harmonics in [1, 4] {
                    let closed = check(structure, harmonics, symmetry, switching, [1.9, 1.07]);
                    assert!(closed > 0.05 && closed < 0.95, "structure {i}: {closed}");
                    let linear = nlmodes_hbm::grazing(structure, 1).unwrap().omega;
                    let pole = held(structure)[1].lambda.sqrt() / harmonics as f64 / linear;
                    // A mode that hardly moves the contact has a narrow pole, with larger third derivatives: a shorter
                    // step.
                    check_with_step(structure, harmonics, symmetry, switching, [1.9, pole * (1.0 - 1e-7)], 0.2 * STEP);
                }
            }
        }
    }
}

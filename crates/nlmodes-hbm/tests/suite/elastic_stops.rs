//! Structures before elastic stops, against their equations in dense matrices.

use crate::support;

use std::f64::consts::TAU;

use nlmodes_hbm::{CondensedStructure, DampedStop, HbmError, ModalDamping, Switching, Symmetry, grazing};
use nlmodes_linalg::{Mat, lowest_modes, sparse_from_triplets, triplets};
use nlmodes_modal::{HarmonicCoefficients, ModalPoint};
use nlmodes_model::reduction::{ModeCount, OpenModes, ReducedStructure};
use nlmodes_model::{Drop, MasslessContactModel, ModelError, Side, StructuralModel};
use num_complex::Complex64;
use support::modal::Open;
use support::{FullMatrices, condense, condense_tips, dense, fitted_slope, follow, on_springs, problem, rod, stops};

fn two_places() -> StructuralModel {
    on_springs(&rod(8, 1.0, 1.0, 1.0, &[(8, Side::Positive, 1.0), (4, Side::Positive, 0.8)]), &[9.0, 30.0])
}

fn facing() -> StructuralModel {
    on_springs(&rod(8, 1.0, 1.0, 1.0, &[(8, Side::Positive, 1.0), (8, Side::Negative, 1.02)]), &[9.0, 4.0])
}

/// Full matrices with the contact mass in its place.
fn with_mass(model: &StructuralModel) -> FullMatrices {
    FullMatrices { k: dense(model.stiffness()), m: dense(model.mass()), contact: Vec::new() }
}

/// Largest defect of `(K − ν² M) q_n = 𝓕_n(W λ(q(t)))` with the penalty forces of eq. (3) at `samples` instants, over
/// all harmonics and all degrees of freedom, relative to the largest product: alternating frequency-time from the
/// definition.
fn harmonic_balance_defect(full: &FullMatrices, model: &StructuralModel, point: &ModalPoint, samples: usize) -> f64 {
    let (mut defect, mut scale) = (0.0_f64, f64::MIN_POSITIVE);
    for n in 0..=point.coefficients.n_harmonics() {
        let nu2 = (n as f64 * point.omega).powi(2);
        let mut load = vec![Complex64::default(); full.size()];
        for contact in stops(model) {
            for j in 0..samples {
                let tau = TAU * j as f64 / samples as f64;
                let gap = contact.gap + contact.direction() * point.coefficients.value(contact.dof, tau);
                let force = (-gap).max(0.0) / contact.law.compliance();
                let mean = if n == 0 { 1.0 } else { 2.0 } / samples as f64;
                load[contact.dof] += Complex64::cis(-(n as f64) * tau) * (mean * contact.direction() * force);
            }
        }
        for (i, load) in load.iter().enumerate() {
            let q = |j: usize| point.coefficients.of(j)[n];
            let row: Complex64 = (0..full.size()).map(|j| q(j) * (full.k[i][j] - nu2 * full.m[i][j])).sum();
            defect = defect.max((row - load).norm());
            scale = scale.max((0..full.size()).map(|j| (q(j) * full.k[i][j]).norm()).sum());
        }
    }
    defect / scale
}

#[test]
fn harmonic_balance_solves_its_equations_by_alternating_frequency_time_from_the_definition() {
    for model in [two_places(), facing()] {
        for symmetry in [Symmetry::Even, Symmetry::None] {
            for rule in [None, Some(&Drop as _)] {
                let full = if rule.is_none() { with_mass(&model) } else { FullMatrices::of(&model) };
                let structure = condense_tips(&model, rule);
                let (mut problem, start) = problem(&structure, 1, 3, symmetry, Switching::Sampled { samples: 64 });
                let branch = follow(&mut problem, &start, 5.0);
                let mut touched = 0.0_f64;
                for point in branch.points.iter().step_by(4) {
                    let modal = structure.modal_point(&mut problem, &point.x, point.residual).unwrap();
                    let defect = harmonic_balance_defect(&full, &model, &modal, 64);
                    assert!(defect < 1e-9, "{symmetry:?}: {defect:e}");
                    assert!((full.kinetic_energy(&modal) / modal.kinetic_energy - 1.0).abs() < 1e-10);
                    assert!(point.x.get(problem.n_coefficients() + 1).is_none_or(|delta| delta.abs() < 1e-9));
                    touched = touched.max(modal.contact_fraction);
                }
                assert!(touched > 0.1, "{touched}");
            }
        }
    }
}

/// The structure in all its modes: nothing is left that could be pressed but the stops.
fn in_all_modes(model: &StructuralModel) -> (OpenModes, ReducedStructure) {
    let open = OpenModes::of_model(model, ModeCount::Lowest(model.dofs().len())).unwrap();
    let places: Vec<_> = stops(model).iter().map(|stop| (stop.dof, model.dofs()[stop.dof].position)).collect();
    let reduced = ReducedStructure::along_axes(&open, &places, model.dofs()).unwrap();
    (open, reduced)
}

/// Displacements of all degrees of freedom of a motion in reduced coordinates.
fn recovered(open: &OpenModes, reduced: &ReducedStructure, of: &HarmonicCoefficients) -> HarmonicCoefficients {
    let dofs: Vec<usize> = (0..open.n_dofs()).collect();
    let mut all = HarmonicCoefficients::zeros(dofs.len(), of.n_harmonics());
    for n in 0..=of.n_harmonics() {
        let part = |of_part: fn(&Complex64) -> f64| {
            let x = Mat::from_fn(of.n_coordinates(), 1, |d, _| of_part(&of.of(d)[n]));
            reduced.displacements(open, &dofs, &x)
        };
        let (re, im) = (part(|z| z.re), part(|z| z.im));
        dofs.iter().for_each(|&d| all.of_mut(d)[n] = Complex64::new(re[(d, 0)], im[(d, 0)]));
    }
    all
}

#[test]
fn with_all_modes_retained_the_motion_at_an_elastic_stop_is_that_of_the_structure() {
    for model in [two_places(), facing()] {
        let ((open, reduced), full) = (in_all_modes(&model), with_mass(&model));
        let structure = condense(reduced.model());
        for symmetry in [Symmetry::Even, Symmetry::None] {
            let (mut problem, start) = problem(&structure, 1, 3, symmetry, Switching::Sampled { samples: 64 });
            let branch = follow(&mut problem, &start, 5.0);
            let (tip, mut yielded) = (model.dofs().len() - 1, 0.0_f64);
            for point in branch.points.iter().step_by(4) {
                let own = structure.modal_point(&mut problem, &point.x, point.residual).unwrap();
                let coefficients = recovered(&open, &reduced, &own.coefficients);
                let of_structure = ModalPoint { coefficients, ..own.clone() };
                let defect = harmonic_balance_defect(&full, &model, &of_structure, 64);
                assert!(defect < 1e-9, "{symmetry:?}: {defect:e}");
                let at = |j: u32| of_structure.coefficients.value(tip, TAU * f64::from(j) / f64::from(1 << 14));
                let peak = (0..1 << 14).map(at).fold(f64::MIN, f64::max);
                assert!((own.peak / peak - 1.0).abs() < 1e-6, "{} of {peak}", own.peak);
                let fundamental = of_structure.coefficients.of(tip)[1].norm();
                assert!((own.fundamental.abs() / fundamental - 1.0).abs() < 1e-10, "{} {fundamental}", own.fundamental);
                let history = problem
                    .equidistant_histories(&point.x, structure.model().contacts(), 64, "")
                    .unwrap()
                    .swap_remove(0);
                for (j, displacement) in history.displacement.iter().enumerate() {
                    let expected = of_structure.coefficients.value(tip, TAU * j as f64 / 64.0);
                    assert!((displacement - expected).abs() < 1e-9, "{displacement} {expected}");
                }
                yielded = yielded.max(peak - 1.0);
            }
            assert!(yielded > 0.01, "{yielded}");
        }
    }
}

/// Between stops that both press, each yields to its own force alone: two springs to the ground.
#[test]
fn stops_that_press_from_both_sides_are_two_springs_in_all_modes_too() {
    let model =
        on_springs(&rod(8, 1.0, 1.0, 1.0, &[(8, Side::Positive, -0.1), (8, Side::Negative, -0.1)]), &[9.0, 4.0]);
    let start = grazing(&condense(in_all_modes(&model).1.model()), 1).unwrap();
    let stiffness: Vec<_> = triplets(model.stiffness()).chain([(7, 7, 13.0)]).collect();
    let stiffness = sparse_from_triplets(8, 8, &stiffness).unwrap();
    let expected = lowest_modes(&stiffness, model.mass(), 1).unwrap().eigenvalues[0].sqrt();
    assert!((start.omega / expected - 1.0).abs() < 1e-10, "{} of {expected}", start.omega);
}

/// Mean strain energy `½ ⟨qᵀ K q⟩ + ½ Σ ⟨λ²⟩/k_c` of a motion that is in the coefficients entirely.
fn strain(full: &FullMatrices, model: &StructuralModel, point: &ModalPoint) -> f64 {
    let quadratic = |n: usize| {
        let q: Vec<Complex64> = (0..full.size()).map(|j| point.coefficients.of(j)[n]).collect();
        let sum: f64 =
            (0..q.len()).map(|i| (0..q.len()).map(|j| full.k[i][j] * (q[i].conj() * q[j]).re).sum::<f64>()).sum();
        sum * if n == 0 { 0.5 } else { 0.25 }
    };
    let samples = 1 << 14;
    let springs = stops(model).into_iter().map(|contact| {
        let yields = (0..samples).map(|j| {
            let tau = TAU * j as f64 / samples as f64;
            (-contact.gap - contact.direction() * point.coefficients.value(contact.dof, tau)).max(0.0)
        });
        0.5 / contact.law.compliance() * yields.map(|y| y * y).sum::<f64>() / samples as f64
    });
    (0..=point.coefficients.n_harmonics()).map(quadratic).sum::<f64>() + springs.sum::<f64>()
}

#[test]
fn total_energy_counts_the_springs_of_the_stops() {
    for model in [two_places(), facing()] {
        let (structure, full) = (condense_tips(&model, None), with_mass(&model));
        let (mut problem, start) = problem(&structure, 1, 3, Symmetry::Even, Switching::Exact);
        let branch = follow(&mut problem, &start, 5.0);
        for point in branch.points.iter().step_by(4) {
            let modal = structure.modal_point(&mut problem, &point.x, point.residual).unwrap();
            let expected = modal.kinetic_energy + strain(&full, &model, &modal);
            assert!((modal.total_energy / expected - 1.0).abs() < 1e-9, "{} against {expected}", modal.total_energy);
        }
    }
}

#[test]
fn massless_nodes_before_elastic_stops_are_in_static_equilibrium_at_every_instant() {
    for model in [two_places(), facing()] {
        let (structure, full) = (condense(&model), FullMatrices::of(&model));
        let (mut problem, start) = problem(&structure, 1, 3, Symmetry::Even, Switching::Exact);
        let branch = follow(&mut problem, &start, 5.0);
        let mut touched = [false; 2];
        for point in branch.points.iter().step_by(4) {
            let modal = structure.modal_point(&mut problem, &point.x, point.residual).unwrap();
            assert!(full.equation_8_defect(&modal) < 1e-11);
            let histories = [0, 1].map(|c| {
                problem.equidistant_histories(&point.x, structure.model().contacts(), 200, "").unwrap().swap_remove(c)
            });
            for j in 0..=200 {
                let b = full.free_position(&modal, TAU * j as f64 / 200.0);
                let (mut load, mut q) = (vec![0.0; b.len()], b.clone());
                for (c, (contact, history)) in stops(&model).iter().zip(&histories).enumerate() {
                    let d = full.contact.iter().position(|&dof| dof == contact.dof).unwrap();
                    load[d] += contact.direction() * history.force[j];
                    q[d] = history.displacement[j];
                    // The force is that of the spring, eq. (3).
                    let gap = contact.gap + contact.direction() * history.displacement[j];
                    let force = (-gap).max(0.0) / contact.law.compliance();
                    assert!((history.force[j] - force).abs() < 1e-11 * 30.0, "{} against {force}", history.force[j]);
                    touched[c] |= force > 1e-2;
                }
                for (d, &row) in full.contact.iter().enumerate() {
                    let held: f64 = (0..b.len()).map(|e| full.k[row][full.contact[e]] * (q[e] - b[e])).sum();
                    assert!((held - load[d]).abs() < 1e-10 * full.k[row][row], "{held} against {}", load[d]);
                }
            }
            let peak = histories[0].displacement.iter().fold(0.0_f64, |m, q| m.max(*q));
            assert!(modal.peak > peak - 1e-12 && modal.peak < peak + 1e-3, "{} and {peak}", modal.peak);
        }
        assert_eq!(touched, [true; 2]);
    }
}

#[test]
fn velocity_and_acceleration_in_an_elastic_stop_are_the_derivatives_of_the_displacement() {
    let model = two_places();
    for structure in [condense(&model), condense_tips(&model, None)] {
        let (mut problem, start) = problem(&structure, 1, 3, Symmetry::Even, Switching::Exact);
        let branch = follow(&mut problem, &start, 2.5);
        let x = &branch.points.last().unwrap().x;
        let n = 20_000;
        let history = problem.equidistant_histories(x, structure.model().contacts(), n, "").unwrap().swap_remove(0);
        let step = history.time[1];
        let mut wrong = 0;
        for j in 1..n {
            let q = &history.displacement;
            let slope = (q[j + 1] - q[j - 1]) / (2.0 * step);
            let curvature = (q[j + 1] - 2.0 * q[j] + q[j - 1]) / (step * step);
            wrong += usize::from((slope - history.velocity[j]).abs() > 1e-4)
                + usize::from((curvature - history.acceleration[j]).abs() > 1e-2);
        }
        // The slope of a massless node jumps where its contact or the other one changes; each spoils three samples at
        // most.
        assert!(wrong <= 40, "{wrong}");
    }
}

/// Frequency over that at grazing, at three times its energy.
fn frequency(structure: &CondensedStructure, harmonics: usize) -> f64 {
    support::frequency_ratio(structure, harmonics, Switching::Exact, 3.0)
}

#[test]
fn elastic_stops_of_a_rod_run_into_rigid_ones_like_their_compliance() {
    let rigid = rod(8, 1.0, 1.0, 1.0, &[(8, Side::Positive, 1.0), (4, Side::Positive, 0.8)]);
    let limit = frequency(&condense(&rigid), 3);
    let differences =
        [1e3, 1e4, 1e5].map(|k| (k, (frequency(&condense(&on_springs(&rigid, &[k, 0.5 * k])), 3) - limit).abs()));
    let slope = fitted_slope(&differences);
    assert!((-1.05..-0.95).contains(&slope), "order {slope}: {differences:?}");
}

#[test]
fn a_stop_that_presses_on_its_spring_at_rest_starts_from_the_mode_with_the_spring() {
    // A spring of 5 at the tip of a rod with EA = ρA = L = 1 and many elements: κ cot κ = −5.
    let kappa = support::bisect(|kappa| kappa / kappa.tan() + 5.0, 1.6, 3.1);
    let elements = 200;
    let pressed = rod(elements, 1.0, 1.0, 1.0, &[(elements, Side::Positive, -0.1)]);
    let model = on_springs(&pressed, &[5.0]);
    let tips = condense_tips(&model, None);
    let with_mass = grazing(&tips, 1).unwrap();
    // Linear elements with consistent mass: too high by (κ/elements)²/24.
    assert!((with_mass.omega / kappa - 1.0).abs() < 1e-5, "{} against {kappa}", with_mass.omega);
    for structure in [condense(&model), condense_tips(&model, Some(&Drop))] {
        let found = grazing(&structure, 1).unwrap();
        // A third of an element's mass is dropped at the tip, of 200.
        assert!((found.omega / kappa - 1.0).abs() < 5e-3, "{} against {kappa}", found.omega);
        // At rest the spring of 5 and the rod of 1 share 0.1; the mode leaves the stop when the force vanishes once a
        // period.
        assert!((found.energy / with_mass.energy - 1.0).abs() < 2e-2, "{} {}", found.energy, with_mass.energy);
    }
    assert_eq!(with_mass.contact, 0);
    let [mean, swing] = [with_mass.contacts_at_rest(&tips)[0], with_mass.contact_amplitudes(&tips)[0]];
    assert!((mean + 0.1 * 5.0 / 6.0).abs() < 1e-10, "{mean}");
    // With amplitude 0.1/6 the tip meets the unloaded end of the spring: the rest position is 0.1/6 inside of it.
    assert!((swing.abs() - 0.1 / 6.0).abs() < 1e-10, "{swing}");
}

#[test]
fn the_branch_of_a_pressed_elastic_stop_leads_away_from_rest() {
    let model = on_springs(&rod(8, 1.0, 1.0, 1.0, &[(8, Side::Positive, -0.1)]), &[5.0]);
    for structure in [condense(&model), condense_tips(&model, None)] {
        let (mut problem, start) = problem(&structure, 1, 3, Symmetry::Even, Switching::Exact);
        let branch = follow(&mut problem, &start, 4.0);
        let last = branch.points.last().unwrap();
        assert!((last.p - 4.0_f64.ln()).abs() < 1e-12);
        // It loses the spring for a part of the period: softer.
        assert!(problem.omega(&last.x) < start.omega);
        let modal = structure.modal_point(&mut problem, &last.x, last.residual).unwrap();
        assert!(modal.contact_fraction > 0.2 && modal.contact_fraction < 0.9, "{}", modal.contact_fraction);
    }
}

#[test]
fn harmonic_balance_refuses_a_rigid_stop() {
    let model = rod(4, 1.0, 1.0, 1.0, &[(4, Side::Positive, 1.0), (2, Side::Positive, 1.0)]);
    let half = on_springs(&model, &[3.0, f64::INFINITY]);
    let error = MasslessContactModel::with_spring_tips(&half, None).unwrap_err();
    assert_eq!(error, ModelError::RigidStop { contact: 1 });
    assert!(HbmError::from(error).to_string().contains("linear model"));
}

#[test]
fn the_peak_of_a_contact_that_stays_open_is_that_of_its_node_while_its_neighbour_is_pressed() {
    // Two massless nodes next to each other: the tip meets its stop, the one before it only comes near its own.
    let model = rod(8, 1.0, 1.0, 1.0, &[(7, Side::Positive, 5.0), (8, Side::Positive, 1.0)]);
    let structure = condense(&model);
    let (mut problem, start) = problem(&structure, 1, 3, Symmetry::Even, Switching::Exact);
    let branch = follow(&mut problem, &start, 3.0);
    let last = branch.points.last().unwrap();
    let modal = structure.modal_point(&mut problem, &last.x, last.residual).unwrap();
    let history =
        problem.equidistant_histories(&last.x, structure.model().contacts(), 4000, "").unwrap().swap_remove(0);
    let sampled = history.displacement.iter().fold(f64::NEG_INFINITY, |m, q| m.max(*q));
    assert!((modal.peak - sampled).abs() < 1e-6, "{} and {sampled}", modal.peak);
    assert!(
        problem
            .equidistant_histories(&last.x, structure.model().contacts(), 100, "")
            .unwrap()
            .swap_remove(1)
            .force
            .iter()
            .any(|f| *f > 1e-2)
    );
}

/// A spring and a damper behind a stop take the place of what it was: a rigid one and one on a spring become the same.
#[test]
fn a_stop_that_dissipates_does_not_remember_what_it_was() {
    let rigid = rod(6, 1.0, 1.0, 1.0, &[(6, Side::Positive, 1.0), (3, Side::Negative, 0.4)]);
    let soft = on_springs(&rigid, &[2.5, f64::INFINITY]);
    let stop = DampedStop { contact: 0, stiffness: 7.0, damper: 0.3 };
    let [hard, elastic] = [&rigid, &soft].map(|model| {
        let open = Open::massless(model);
        open.structure(ModalDamping::none(open.n_modes()))
    });
    let own = elastic.compliance().a()[(0, 0)] - hard.compliance().a()[(0, 0)];
    assert!((own - 1.0 / 2.5).abs() < 1e-12, "a spring yields by its own: {own}");
    let [hard, elastic] = [hard, elastic].map(|structure| structure.with_damped_stops(&[stop]).unwrap());
    for (i, j) in (0..2).flat_map(|i| (0..2).map(move |j| (i, j))) {
        let [a, b] = [&hard, &elastic].map(|structure| structure.compliance().a()[(i, j)]);
        assert!((a - b).abs() < 1e-12, "({i}, {j}): {a} {b}");
    }
    assert_eq!(hard.omega_squared().last(), Some(&7.0));
}

/// Beside a contact spring of more than 5·10⁸ times the stiffness of the structure at the stop that is lost in
/// rounding.
#[test]
fn springs_beside_which_the_structure_is_lost_are_refused_with_their_ratio() {
    // A rod of stiffness EA/L at its end, in three units.
    for (ea, length) in [(1.0, 1.0), (2e11, 0.5), (1e-6, 30.0)] {
        let condensed = |ratio: f64| {
            let rod = on_springs(&rod(5, ea, 1.0, length, &[(5, Side::Positive, 1e-3)]), &[ratio * ea / length]);
            CondensedStructure::new(MasslessContactModel::with_spring_tips(&rod, None).unwrap(), 5)
        };
        for ratio in [1e3, 4.6e8] {
            condensed(ratio).unwrap();
        }
        for expected in [5.5e8, 1e9] {
            let Err(HbmError::ContactTooStiff { contact: 0, ratio, most }) = condensed(expected) else { panic!() };
            assert!((ratio / expected - 1.0).abs() < 1e-4 && most == 5e8, "{ratio:e} of {expected:e}");
        }
    }
}

/// What the modes left out do to the rod falls with the third power of their number, or faster; a spring yields its
/// force over its stiffness with any number of them, and springs that face each other at one node share its motion.
#[test]
fn harmonic_balance_with_fewer_fixed_interface_modes_runs_into_that_with_all() {
    let rod = rod(40, 1.0, 1.0, 1.0, &[(40, Side::Positive, 1.0), (40, Side::Negative, 1.2)]);
    let model = on_springs(&rod, &[20.0, 30.0]);
    let found = |modes: usize| {
        let tips = MasslessContactModel::with_spring_tips(&model, None).unwrap();
        let structure = CondensedStructure::new(tips, modes).unwrap();
        let (mut problem, start) = problem(&structure, 1, 3, Symmetry::Even, Switching::Exact);
        assert_eq!(problem.n_coefficients(), problem.series().width(), "one direction");
        let branch = follow(&mut problem, &start, 3.0);
        let last = branch.points.last().unwrap();
        let modal = structure.modal_point(&mut problem, &last.x, last.residual).unwrap();
        let yields = modal.contacts[0].peak_force / 20.0;
        assert!(yields > 1e-3 && (modal.peak - 1.0 - yields).abs() < 1e-12, "{} {yields}", modal.peak);
        [modal.omega, modal.peak_contact_force, modal.total_energy, modal.coefficients.of(20)[3].re]
    };
    let (all, few, more) = (found(40), found(6), found(12));
    for k in 0..all.len() {
        let [coarse, fine] = [few[k], more[k]].map(|value| (value / all[k] - 1.0).abs());
        assert!(fine < 3e-2 && fine < 0.2 * coarse + 1e-9, "{k}: {coarse:e} {fine:e}");
    }
}

//! More than one contact: at different places, and facing each other.

use crate::support;

use nlmodes_contact::{SOLVER_NAMES, solver_by_name};
use nlmodes_continuation::EventKind;
use nlmodes_hbm::{CondensedStructure, PeriodicSettings, Switching, Symmetry, grazing};
use nlmodes_model::reduction::HeldModes;
use nlmodes_model::{Side, StructuralModel};
use support::{FullMatrices, condense, fitted_slope, follow, frequency_ratio, problem, rod, stops};

/// The middle of the rod moves 0.7 times as much as its tip, so with 0.8 it touches after the tip.
fn tip_and_middle() -> StructuralModel {
    rod(10, 1.0, 1.0, 1.0, &[(10, Side::Positive, 1.0), (5, Side::Positive, 0.8)])
}

fn facing() -> StructuralModel {
    rod(10, 1.0, 1.0, 1.0, &[(10, Side::Positive, 1.0), (10, Side::Negative, 1.3)])
}

fn both() -> [(&'static str, StructuralModel, f64); 2] {
    [("tip and middle", tip_and_middle(), 3.0), ("facing", facing(), 3.0)]
}

#[test]
fn contacts_obey_statics_and_complementarity_at_every_instant() {
    for (name, model, ratio) in both() {
        let (structure, full) = (condense(&model), FullMatrices::of(&model));
        let (mut problem, start) = problem(&structure, 1, 2, Symmetry::Even, Switching::Exact);
        let branch = follow(&mut problem, &start, ratio);
        assert!(branch.points.last().unwrap().p > ratio.ln() - 1e-12, "{name}: {:?}", branch.stop);
        let mut touched = [false; 2];
        for point in branch.points.iter().step_by(3) {
            let modal = structure.modal_point(&mut problem, &point.x, point.residual).unwrap();
            assert!(full.equation_8_defect(&modal) < 1e-11, "{name}: {:e}", full.equation_8_defect(&modal));
            let checked = problem.check_contact(&point.x, 500).unwrap();
            let worst = checked.penetration.max(checked.tension).max(checked.complementarity);
            assert!(worst < 1e-11, "{name}: {checked:?}");
            let histories = [0, 1].map(|c| {
                problem.equidistant_histories(&point.x, structure.model().contacts(), 200, "").unwrap().swap_remove(c)
            });
            for j in 0..=200 {
                let tau = std::f64::consts::TAU * j as f64 / 200.0;
                let b = full.free_position(&modal, tau);
                // K_NN (q_N − b) = W λ, eq. (13), with what the histories say about q_N and λ.
                let mut load = vec![0.0; b.len()];
                let mut q = b.clone();
                for (contact, history) in stops(&model).iter().zip(&histories) {
                    let d = full.contact.iter().position(|&c| c == contact.dof).unwrap();
                    load[d] += contact.direction() * history.force[j];
                    q[d] = history.displacement[j];
                }
                for (d, &row) in full.contact.iter().enumerate() {
                    let held: f64 = (0..b.len()).map(|e| full.k[row][full.contact[e]] * (q[e] - b[e])).sum();
                    assert!((held - load[d]).abs() < 1e-10 * full.k[row][row], "{name}: {held} against {}", load[d]);
                }
                for (c, (contact, history)) in stops(&model).iter().zip(&histories).enumerate() {
                    let gap = contact.gap + contact.direction() * history.displacement[j];
                    let push = history.force[j] / full.k[contact.dof][contact.dof];
                    touched[c] |= push > 1e-3;
                    assert!(gap > -1e-12 && push > -1e-12 && gap.min(push) < 1e-12, "{name}: {gap:e}, {push:e}");
                }
            }
        }
        assert_eq!(touched, [true; 2], "{name}: a stop was never touched");
    }
}

#[test]
fn sampled_contacts_approach_exact_ones_with_the_square_of_the_sample_distance() {
    for (name, model, ratio) in both() {
        let structure = condense(&model);
        let exact = frequency_ratio(&structure, 2, Switching::Exact, ratio);
        let mut errors = Vec::new();
        for samples in [64, 91, 128, 181, 256, 362, 512, 724, 1024] {
            let found = frequency_ratio(&structure, 2, Switching::Sampled { samples }, ratio);
            errors.push((samples as f64, (found / exact - 1.0).abs().max(1e-14)));
        }
        let slope = fitted_slope(&errors);
        // The trapezoidal rule on a function with corners: order 2, with a factor that depends on where the corners
        // fall.
        assert!((-2.6..-1.5).contains(&slope), "{name}: order {slope}, {errors:?}");
        assert!(errors.last().unwrap().1 < 1e-5, "{name}: {errors:?}");
    }
}

#[test]
fn facing_stops_at_equal_distance_give_a_motion_without_even_harmonics() {
    let structure = condense(&rod(10, 1.0, 1.0, 1.0, &[(10, Side::Positive, 1.0), (10, Side::Negative, 1.0)]));
    let (mut problem, start) = problem(&structure, 1, 4, Symmetry::Even, Switching::Exact);
    let branch = follow(&mut problem, &start, 2.0);
    assert!(branch.points.last().unwrap().p > 2.0_f64.ln() - 1e-12, "{:?}", branch.stop);
    for point in &branch.points {
        assert!([0, 2, 4].iter().all(|&n| point.x[n].abs() < 1e-9), "{:?}", point.x);
    }
}

#[test]
fn facing_stops_are_one_stop_until_the_far_one_is_reached() {
    // The same rod with the far stop out of reach; amplitudes grow by less than 1.4 up to twice the energy.
    let one = condense(&rod(10, 1.0, 1.0, 1.0, &[(10, Side::Positive, 1.0)]));
    let two = condense(&rod(10, 1.0, 1.0, 1.0, &[(10, Side::Positive, 1.0), (10, Side::Negative, 5.0)]));
    let [one, two] = [one, two].map(|s| frequency_ratio(&s, 3, Switching::Exact, 2.0));
    assert!((one / two - 1.0).abs() < 1e-11, "{one} against {two}");
}

fn with_solver(structure: &CondensedStructure, name: &str) -> Result<f64, String> {
    let start = grazing(structure, 1).map_err(|e| e.to_string())?;
    let settings = (PeriodicSettings { harmonics: 2, ..PeriodicSettings::default() }, Symmetry::Even);
    let solver = solver_by_name(name).map_err(|e| e.to_string())?;
    let mut problem =
        structure.conservative_mode(settings, start.scales(), solver.as_ref()).map_err(|e| format!("{e:?}"))?;
    let branch = follow(&mut problem, &start, 2.0);
    let last = branch.points.last().unwrap();
    if (last.p - 2.0_f64.ln()).abs() > 1e-12 {
        return Err(format!("{:?}", branch.stop));
    }
    Ok(problem.omega(&last.x))
}

#[test]
fn every_contact_solver_gives_the_same_frequency() {
    for (scene, model, _) in both() {
        let structure = condense(&model);
        let reference = with_solver(&structure, "active-set").unwrap();
        for name in SOLVER_NAMES.iter().filter(|name| **name != "closed-form") {
            let found = with_solver(&structure, name).unwrap_or_else(|e| panic!("{name}, {scene}: {e}"));
            assert!((found / reference - 1.0).abs() < 1e-8, "{name}, {scene}: {found} against {reference}");
        }
    }
    let structure = condense(&rod(10, 1.0, 1.0, 1.0, &[(10, Side::Positive, 1.0)]));
    let reference = with_solver(&structure, "active-set").unwrap();
    for name in SOLVER_NAMES {
        let found = with_solver(&structure, name).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!((found / reference - 1.0).abs() < 1e-8, "{name}: {found} against {reference}");
    }
}

#[test]
fn the_solver_for_one_contact_refuses_two() {
    let structure = condense(&tip_and_middle());
    assert!(with_solver(&structure, "closed-form").is_err());
}

#[test]
fn spans_of_the_same_frequency_do_not_feign_branch_points() {
    // With both contacts held, the halves of the rod have the same frequencies, near 3.49 and 7.31 times the first one
    // of the rod: harmonics 3, 7 and 8 cross them on the way, harmonics 2, 4 and 6 do not. Either way the backbone is
    // plain.
    let structure = condense(&tip_and_middle());
    let held: Vec<f64> = HeldModes::new(structure.model(), usize::MAX).unwrap().lambda;
    assert!((held[1] / held[0] - 1.0).abs() < 1e-12 && (held[3] / held[2] - 1.0).abs() < 1e-12);
    for harmonics in [2, 3, 4, 6, 7, 8] {
        let (mut problem, start) = problem(&structure, 1, harmonics, Symmetry::Even, Switching::Exact);
        let branch = follow(&mut problem, &start, 3.0);
        assert!((branch.points.last().unwrap().p - 3.0_f64.ln()).abs() < 1e-12, "{:?}", branch.stop);
        let crossing = branch.points.iter().find(|q| q.events.contains(&EventKind::BranchPoint));
        assert!(crossing.is_none(), "{harmonics} harmonics: {crossing:?}");
    }
}

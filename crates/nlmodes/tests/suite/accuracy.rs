//! Harmonics and held modes chosen for an accuracy, against the exact motion and against much finer computations.

use crate::support;

use std::ops::ControlFlow;

use nlmodes::branches::{
    Accuracy, BranchProgress, BranchSettings, BranchStart, ComputedBranch, ResonanceRule, StabilityRule,
    compute_branch, compute_tree,
};
use nlmodes::contact::solver_by_name;
use nlmodes::continuation::{Continuation, ParametricSystem};
use nlmodes::fem::{Beam, Direction, MassMatrix, Material, Mesh, Section, Stop, Support};
use nlmodes::hbm::{CondensedStructure, PeriodicSettings, Symmetry, TruncationEstimator, grazing};
use nlmodes::modal::{EndReason, Event, ModalPoint};
use nlmodes::model::{Drop, MasslessContactModel, Side};
use nlmodes::timestep::{ContactDynamics, Shooting, ShootingScales};
use support::{massless_beam, unit_rod};

fn rod(elements: usize) -> MasslessContactModel {
    unit_rod(elements, &[Stop::rigid(1.0, Direction::Axial, Side::Positive, 1.0)])
}

fn beam() -> MasslessContactModel {
    let beam = Beam {
        material: Material::new(181.36e9, 7730.0).unwrap().with_poissons_ratio(0.3).unwrap(),
        section: Section::rectangle(0.012, 0.020).unwrap(),
        mesh: Mesh::graded(0.629_755_20, 21, 9.195_853_6).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let stop = Stop::rigid(0.629_755_20, Direction::Transverse, Side::Positive, 1.03e-3);
    MasslessContactModel::new(&beam.assemble(&[stop]).unwrap(), &Drop).unwrap()
}

fn settings(error: f64, max_energy_ratio: f64) -> BranchSettings {
    BranchSettings {
        harmonics: 2,
        accuracy: Some(Accuracy { error, max_harmonics: 60 }),
        max_energy_ratio: Some(max_energy_ratio),
        stability: StabilityRule::Never,
        internal_resonance: ResonanceRule::Follow,
        ..BranchSettings::default()
    }
}

fn compute(model: &MasslessContactModel, settings: &BranchSettings) -> ComputedBranch {
    compute_branch(model.clone(), settings, |_| ControlFlow::Continue(())).unwrap()
}

fn harmonics(branch: &ComputedBranch) -> Vec<usize> {
    branch.branch.points.iter().map(|p| p.coefficients.n_harmonics()).collect()
}

/// Relative error of the frequency against the exact motion of the same energy, over the estimate, at a point.
fn against_exact(model: &MasslessContactModel, branch: &ComputedBranch, point: usize) -> (f64, f64) {
    error_of(model, &branch.branch.points[point])
}

fn error_of(model: &MasslessContactModel, point: &ModalPoint) -> (f64, f64) {
    let dynamics = ContactDynamics::new(model.clone()).unwrap();
    let state = dynamics.state_of_harmonics(&point.coefficients, point.omega, 0.0).unwrap();
    let scales = ShootingScales { omega: point.omega, energy: point.kinetic_energy };
    let mut shooting = Shooting::new(dynamics, scales).unwrap();
    let guess = shooting.unknowns(&state, point.omega);
    let exact = shooting.motion_near(&guess, 0.0).unwrap().omega;
    ((point.omega / exact - 1.0).abs(), point.error_estimate.unwrap())
}

#[test]
fn the_estimate_is_the_error_of_the_two_element_rod() {
    let model = rod(2);
    for (accuracy, expected) in [(1e-3, 2..=4), (1e-5, 4..=8), (1e-7, 9..=20), (1e-9, 20..=45)] {
        let branch = compute(&model, &settings(accuracy, 8.0));
        let points = &branch.branch.points;
        assert!(branch.branch.end.complete && points.len() > 20, "{}", branch.branch.end.message);
        let used = harmonics(&branch);
        let most = used.iter().max().unwrap();
        assert!(expected.contains(most), "{accuracy:e}: {used:?}");
        // Grazing itself is exact, and rounding bounds what can be compared.
        for k in (1..points.len()).filter(|k| k % 5 == 0) {
            let (error, estimate) = against_exact(&model, &branch, k);
            assert!(error < accuracy, "{accuracy:e}, point {k}: {error:e}");
            assert!(estimate < accuracy, "{accuracy:e}, point {k}: {estimate:e}");
            let ratio = estimate / error;
            assert!(
                error < 1e-12 || (0.3..10.0).contains(&ratio),
                "{accuracy:e}, point {k}: {estimate:e} for {error:e}"
            );
        }
    }
}

/// Every change of the number of harmonics is at the same energy, within the accuracy, and shown to be on the same
/// branch.
fn assert_changes(branch: &ComputedBranch, accuracy: f64) {
    let (points, reached) = (&branch.branch.points, branch.accuracy.unwrap());
    assert!(branch.branch.end.complete, "{}", branch.branch.end.message);
    assert!(reached.changes > 0 && reached.harmonics[0] < reached.harmonics[1], "{reached:?}");
    assert_eq!(reached.points_beyond, 0, "{reached:?}");
    let changes: Vec<usize> = (1..points.len()).filter(|&k| points[k].has_event(Event::Harmonics)).collect();
    assert!(!changes.is_empty());
    for k in changes {
        let (before, after) = (&points[k - 1], &points[k]);
        assert_ne!(before.coefficients.n_harmonics(), after.coefficients.n_harmonics());
        assert!((after.kinetic_energy / before.kinetic_energy - 1.0).abs() < 1e-9, "point {k}");
        assert!((after.omega / before.omega - 1.0).abs() < 2.0 * accuracy, "point {k}");
        assert!(!after.has_event(Event::HarmonicsUnproven), "point {k}");
    }
}

#[test]
fn harmonics_change_along_the_branch_of_the_beam() {
    let model = beam();
    let wanted = BranchSettings { frequency_hz: Some([39.0, 40.4]), ..settings(1e-3, 6.0) };
    let branch = compute(&model, &wanted);
    // No exact motion is at hand: shooting the whole beam from these points does not converge.
    assert_changes(&branch, 1e-3);
}

/// The beam's branch enters one internal-resonance branch after another, where no number of harmonics reaches the
/// accuracy: it goes on to its limit all the same.
#[test]
fn the_branch_of_the_beam_goes_on_where_more_harmonics_do_not_help() {
    let (model, asked) = (beam(), 1e-3);
    let accuracy = Some(Accuracy { error: asked, max_harmonics: 20 });
    let branch = compute(&model, &BranchSettings { accuracy, ..settings(asked, 6.0) });
    let (points, reached) = (&branch.branch.points, branch.accuracy.unwrap());
    assert_eq!(branch.branch.end.reasons, [EndReason::MaxEnergy], "{}", branch.branch.end.message);
    // Every point has its estimate, but for those that have no tangent.
    let singular = |k: usize| points[k].has_event(Event::Kink) || points[k].has_event(Event::BranchPoint);
    assert!((0..points.len()).all(|k| points[k].error_estimate.is_some() || singular(k)));
    assert!(points.iter().any(|p| p.has_event(Event::AccuracyLimit)));
    // The segments that are named have all points beyond the accuracy, and no others.
    let stretches = branch.beyond_accuracy();
    let named = |k: usize| stretches.iter().any(|s| (s.points[0]..=s.points[1]).contains(&k));
    let beyond = |k: usize| points[k].error_estimate.map(|e| e > asked);
    assert!((0..points.len()).all(|k| beyond(k).is_none_or(|beyond| beyond == named(k))));
    assert!(reached.points_beyond > 0 && reached.points_beyond < points.len(), "{reached:?}");
    // It does not turn back: after the linear mode has been left, the contact closes at every point.
    assert!(points[1..].iter().all(|p| p.contact_fraction > 0.0));
}

/// Points are found anew only with another number of harmonics, of which each is asked for once.
#[test]
fn points_are_not_taken_back_for_ever() {
    let (mut shown, mut tops) = (0, Vec::new());
    let watched = |progress: BranchProgress| {
        match progress {
            BranchProgress::Found { .. } => shown += 1,
            BranchProgress::Withdrawn { kept, .. } => {
                tops.push((shown, kept));
                shown = kept;
            }
            _ => {}
        }
        ControlFlow::Continue(())
    };
    let wanted = BranchSettings { frequency_hz: Some([39.0, 55.0]), ..settings(3e-3, 6.0) };
    let tree = compute_tree(massless_beam(), &wanted, watched).unwrap();
    let end = &tree.branches[0].branch.end;
    assert_eq!(end.reasons, [EndReason::MaxEnergy], "{}", end.message);
    // None is kept where the branch begins again with more held modes.
    for run in tops.split(|(_, kept)| *kept == 0) {
        assert!(run.len() <= 2 * 60, "{tops:?}");
    }
}

/// More harmonics cannot be had next to an internal resonance, but some points before it: without going back an eighth
/// of the branch misses the accuracy.
#[test]
fn hardly_a_point_of_the_rod_misses_the_accuracy() {
    let wanted = BranchSettings { frequency_hz: Some([50.0, 66.5]), harmonics: 3, ..settings(1e-3, 20.0) };
    let branch = compute(&support::rod(100, MassMatrix::Consistent), &wanted);
    let (points, reached) = (branch.branch.points.len(), branch.accuracy.unwrap());
    assert!(branch.branch.end.complete && points > 100, "{}", branch.branch.end.message);
    assert!(20 * reached.points_beyond < points, "{reached:?} of {points}");
}

/// With more harmonics the motion behind an internal-resonance branch may lie before its base point at the same energy:
/// such a beginning does not count.
#[test]
fn a_beginning_with_more_harmonics_that_lies_outside_of_the_limits_does_not_end_the_branch() {
    let internal_resonance = ResonanceRule::Skip;
    let accuracy = Some(Accuracy { error: 3e-3, max_harmonics: 20 });
    let stability = StabilityRule::default();
    let wanted = BranchSettings { accuracy, harmonics: 5, internal_resonance, stability, ..settings(3e-3, 8.0) };
    let branch = compute(&support::rod(10, MassMatrix::Consistent), &wanted);
    assert_eq!(branch.branch.end.reasons, [EndReason::MaxEnergy], "{}", branch.branch.end.message);
}

/// A loop that only more harmonics close is not the way on.
#[test]
fn a_branch_that_closes_after_a_change_goes_on_without_it() {
    let wanted = BranchSettings { frequency_hz: Some([50.0, 66.5]), harmonics: 5, ..settings(3e-3, 20.0) };
    let branch = compute(&support::rod(100, MassMatrix::Consistent), &wanted);
    assert_eq!(branch.branch.end.reasons, [EndReason::MaxEnergy], "{}", branch.branch.end.message);
}

/// Behind an internal-resonance branch the way back to its base point is bounded in frequency, whose place among the
/// unknowns changes with the number of harmonics.
#[test]
fn tongues_are_skipped_with_as_many_harmonics_as_it_takes() {
    let internal_resonance = ResonanceRule::Skip;
    let window = Some([50.0, 66.5]);
    let wanted = BranchSettings { frequency_hz: window, harmonics: 3, internal_resonance, ..settings(1e-3, 20.0) };
    let branch = compute(&support::rod(10, MassMatrix::Consistent), &wanted);
    let points = &branch.branch.points;
    assert!(branch.branch.end.complete, "{}", branch.branch.end.message);
    let count = |event| points.iter().filter(|point| point.has_event(event)).count();
    assert!(count(Event::TongueFoot) > 0 && count(Event::Resumed) > 0);
    // Behind an internal-resonance branch there are others than before it, and all reach the accuracy.
    let reached = branch.accuracy.unwrap();
    assert!(reached.harmonics[0] < reached.harmonics[1] && reached.points_beyond == 0, "{reached:?}");
    assert!(points.iter().all(|point| point.omega <= 66.5 * std::f64::consts::TAU * (1.0 + 1e-9)));
}

/// A resonance with a harmonic between 15 and 20 makes the error of the rod of 10 elements with 6 of them: the estimate
/// has to reach that far.
#[test]
fn the_estimate_sees_resonances_far_beyond_the_harmonics() {
    let model = rod(10);
    let start = BranchStart::Energy { ratio: 8.0, upward: true };
    let wanted = BranchSettings { accuracy: None, harmonics: 30, start, max_points: 1, ..settings(1e-3, 10.0) };
    let fine = compute(&model, &wanted);
    let begin = grazing(&fine.structure, 1).unwrap();
    let solver = solver_by_name("active-set").unwrap();
    let method = |harmonics| (PeriodicSettings { harmonics, ..PeriodicSettings::default() }, Symmetry::Even);
    let mut from = (fine.unknowns[0].clone(), fine.problem(0).unwrap().series());
    for harmonics in [20, 14, 10, 8, 6] {
        let mut problem = fine.structure.conservative_mode(method(harmonics), begin.scales(), solver.as_ref()).unwrap();
        let mut energy = vec![0.0; problem.dim() + 1];
        energy[problem.dim()] = 1.0;
        let one = Continuation { max_points: 1, ..Continuation::default() };
        let x = problem.resized(&from.0, from.1);
        let found = one.run(&mut problem, &x, 8_f64.ln(), &energy, |_| ControlFlow::Continue(())).unwrap();
        let point = found.points[0].clone();
        let mut modal = fine.structure.modal_point(&mut problem, &point.x, point.residual).unwrap();
        let mut estimator =
            TruncationEstimator::new(&fine.structure, method(harmonics), begin.scales(), solver.as_ref()).unwrap();
        modal.error_estimate = Some(estimator.estimate(&point.x, point.p, &point.tangent).frequency);
        let (error, estimate) = error_of(&model, &modal);
        assert!((0.5..10.0).contains(&(estimate / error)), "{harmonics}: {estimate:e} for {error:e}");
        from = (point.x, problem.series());
    }
}

#[test]
fn the_rod_goes_up_its_tongue_and_down_again_with_as_many_harmonics_as_it_takes() {
    let model = rod(10);
    let branch = compute(&model, &settings(1e-3, 3.0));
    let points = &branch.branch.points;
    assert_changes(&branch, 1e-3);
    for k in [points.len() / 4, points.len() / 2] {
        let (error, estimate) = against_exact(&model, &branch, k);
        assert!(error < 1e-3 && (error < 1e-12 || estimate / error > 0.3), "point {k}: {estimate:e} for {error:e}");
    }
}

#[test]
fn few_held_modes_carry_a_rod_of_2000_elements() {
    let model = rod(2000);
    let start = BranchStart::Energy { ratio: 4.0, upward: true };
    let wanted = BranchSettings { start, max_points: 2, ..settings(1e-4, 10.0) };
    let branch = compute(&model, &wanted);
    let (kept, point) = (branch.structure.n_held_modes(), &branch.branch.points[0]);
    assert!(kept < 100, "{kept}");
    // The same harmonics with three times as many modes: what these leave out is less by some 30.
    let n = point.coefficients.n_harmonics();
    let fine = CondensedStructure::new(model, 3 * kept).unwrap();
    let begin = grazing(&fine, 1).unwrap();
    let solver = solver_by_name("active-set").unwrap();
    let method = (PeriodicSettings { harmonics: n, ..PeriodicSettings::default() }, Symmetry::Even);
    let mut problem = fine.conservative_mode(method, begin.scales(), solver.as_ref()).unwrap();
    let mut energy = vec![0.0; problem.dim() + 1];
    energy[problem.dim()] = 1.0;
    let continuation = Continuation { max_points: 1, ..Continuation::default() };
    let p = (point.kinetic_energy / begin.energy).ln();
    let found = continuation.run(&mut problem, &branch.unknowns[0], p, &energy, |_| ControlFlow::Continue(())).unwrap();
    let error = (problem.omega(&found.points[0].x) / point.omega - 1.0).abs();
    assert!(error < 1e-4, "{error:e}");
    // And the estimate of these modes alone is that difference.
    let begin = grazing(&branch.structure, 1).unwrap();
    let mut estimator = TruncationEstimator::new(&branch.structure, method, begin.scales(), solver.as_ref()).unwrap();
    let estimate = estimator.estimate(&branch.unknowns[0], p, &found.points[0].tangent).held_modes;
    assert!((0.3..10.0).contains(&(estimate / error)), "{estimate:e} for {error:e}");
}

#[test]
fn too_few_harmonics_are_said_and_do_not_end_the_branch() {
    let wanted = BranchSettings { accuracy: Some(Accuracy { error: 1e-8, max_harmonics: 6 }), ..settings(1e-8, 5.0) };
    let branch = compute(&rod(2), &wanted);
    assert_eq!(branch.branch.end.reasons, [EndReason::MaxEnergy]);
    assert!(branch.branch.points.iter().any(|p| p.has_event(Event::AccuracyLimit)));
    let reached = branch.accuracy.unwrap();
    assert!(reached.points_beyond > 10 && reached.largest_estimate > 1e-8 && reached.harmonics[1] == 6, "{reached:?}");
}

/// With few held modes the linear mode before several stops is not quite that of the whole rod: the branch begins at
/// the mode that they have, and the error of its frequency falls with their number.
#[test]
fn branches_before_several_stops_begin_with_any_number_of_held_modes() {
    for length in [1.0, 2e-4] {
        for (at, gap) in [(0.5, 0.8), (0.25, 0.45), (0.75, 1.0)] {
            let stop = |at, gap| Stop::rigid(at, Direction::Axial, Side::Positive, gap * length);
            let model = unit_rod(40, &[stop(1.0, 1.0), stop(at, gap)]);
            let end = |held_modes| {
                let wanted = BranchSettings { accuracy: None, harmonics: 3, held_modes, ..settings(1e-3, 3.0) };
                let branch = compute(&model, &wanted);
                assert_eq!(branch.branch.end.reasons, [EndReason::MaxEnergy], "{}", branch.branch.end.message);
                assert!(branch.branch.points[0].has_event(Event::Grazing));
                branch.branch.points.last().unwrap().omega
            };
            let exact = end(None);
            let errors = [4, 8, 16].map(|held_modes| (end(Some(held_modes)) / exact - 1.0).abs());
            assert!(errors[0] < 0.03 && errors[1] < 0.5 * errors[0] && errors[2] < 0.5 * errors[1], "{at}: {errors:?}");
        }
    }
}

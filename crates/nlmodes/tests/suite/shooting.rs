//! Branches by exact shooting, and the stability of points, through the facade.

use crate::support;

use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

use nlmodes::branches::{
    BranchMethod, BranchSettings, BranchStart, ComputedBranch, Histories, ResonanceRule, StabilityRule, Watch,
    compute_branch,
};
use nlmodes::fem::{Direction, Stop};
use nlmodes::modal::{EndReason, Event, ModalPoint, Stability};
use nlmodes::model::{MasslessContactModel, Side};
use support::unit_rod as rod;

fn tip() -> Stop {
    Stop::rigid(1.0, Direction::Axial, Side::Positive, 1.0)
}

fn settings() -> BranchSettings {
    BranchSettings { method: BranchMethod::Shooting, harmonics: 3, max_points: 400, ..BranchSettings::default() }
}

fn branch(model: MasslessContactModel, settings: &BranchSettings) -> ComputedBranch {
    compute_branch(model, settings, |_| ControlFlow::Continue(())).unwrap()
}

/// Frequency and averaged kinetic energy of the rod of two elements with the total energy `A²`.
///
/// Its massive node has `m = 1/3`, on a spring of 2 about 0 while free, on one of 4 about ½ in contact.
fn closed_form(total_energy: f64) -> (f64, f64) {
    let (free, closed) = (6.0_f64.sqrt(), 12.0_f64.sqrt());
    let a = total_energy.sqrt();
    let b = (0.25 + 0.5 * (a * a - 1.0)).sqrt();
    let theta = [(0.5 / b).acos(), PI - (1.0 / a).acos()];
    let period = 2.0 * (theta[0] / closed + theta[1] / free);
    let integral = theta.map(|θ| θ - θ.sin() * θ.cos());
    let kinetic = 2.0 * b * b / closed * integral[0] + a * a / free * integral[1];
    (TAU / period, kinetic / period)
}

#[test]
fn the_branch_of_the_rod_of_two_elements_is_the_closed_form() {
    let settings = BranchSettings { max_energy_ratio: Some(200.0), ..settings() };
    let computed = branch(rod(2, &[tip()]), &settings);
    assert!(computed.branch.points.len() > 20 && computed.branch.end.has(EndReason::MaxEnergy));
    for point in &computed.branch.points[1..] {
        let (omega, kinetic) = closed_form(point.total_energy);
        // The closed form itself loses digits near grazing, where the phase is arccos(1/A).
        let lost = 1.0 / (1.0 - 1.0 / point.total_energy).sqrt();
        // A regular point counts as found where its residual is within the corrector's tolerance.
        assert!((point.omega / omega - 1.0).abs() < 1e-11 * lost, "{:e}", point.omega / omega - 1.0);
        assert!((point.kinetic_energy / kinetic - 1.0).abs() < 1e-11 * lost);
        assert_eq!(point.contact_intervals, 1);
        // One degree of freedom with mass: no multiplier but the double one.
        assert_eq!(point.stability, Some(Stability::conservative(true, [1.0, 0.0])));
    }
}

/// Share of the period, peak, impulse and approach velocity at the stop of the same rod: the tip pushes with
/// `2 (x − 1)`.
fn contact_in_closed_form(total_energy: f64) -> (f64, f64, f64, f64) {
    let (free, closed) = (6.0_f64.sqrt(), 12.0_f64.sqrt());
    let a = total_energy.sqrt();
    let b = (0.25 + 0.5 * (a * a - 1.0)).sqrt();
    let theta = [(0.5 / b).acos(), PI - (1.0 / a).acos()];
    let time = theta[0] / closed;
    let impulse = 4.0 * (b * theta[0].sin() / closed - 0.5 * time);
    (time / (time + theta[1] / free), 2.0 * (b - 0.5), impulse, (6.0 * (a * a - 1.0)).sqrt())
}

#[test]
fn share_force_impulse_and_approach_at_the_stop_are_the_closed_form_exactly_and_in_harmonics() {
    let exact = BranchSettings { max_energy_ratio: Some(20.0), ..settings() };
    let harmonic = BranchSettings { method: BranchMethod::HarmonicBalance, harmonics: 60, ..exact.clone() };
    // The displacement has a kink in its second derivative: coefficients fall with the cube of their number, forces
    // with the square.
    for (settings, tolerance) in [(exact, 1e-9), (harmonic, 2e-3)] {
        let computed = branch(rod(2, &[tip()]), &settings);
        for point in computed.branch.points.iter().filter(|point| point.total_energy > 1.5) {
            let contact = point.contacts[0];
            let (share, peak, impulse, approach) = contact_in_closed_form(point.total_energy);
            let found = [contact.closed_share, contact.peak_force, contact.impulse, contact.approach_velocity];
            for (found, wanted) in found.into_iter().zip([share, peak, impulse, approach]) {
                assert!((found / wanted - 1.0).abs() < tolerance, "{contact:?}: {found} against {wanted}");
            }
            assert_eq!((contact.touches, contact.peak_force), (1, point.peak_contact_force));
        }
    }
}

#[test]
fn histories_of_all_contacts_are_those_of_each_and_exact_where_they_close() {
    let stops = [tip(), Stop::rigid(1.0, Direction::Axial, Side::Negative, 1.2)];
    for method in [BranchMethod::Shooting, BranchMethod::HarmonicBalance] {
        let settings = BranchSettings { method, max_energy_ratio: Some(3.0), harmonics: 5, ..settings() };
        let computed = branch(rod(4, &stops), &settings);
        let last = computed.branch.points.len() - 1;
        let all = Histories::of(&computed).at(last, 800, "all").unwrap();
        assert_eq!((all.len(), all[0].time.len()), (2, 801));
        let each = Histories::of(&computed).equidistant(last, 64, "one").unwrap();
        for (contact, history) in all.iter().enumerate() {
            assert!(history.force.iter().copied().fold(0.0, f64::max) > 0.0);
            let single = computed.time_history(last, contact, 64, "one").unwrap();
            assert_eq!((&single.instants, &each[contact]), (&history.instants, &single));
            let (period, size) = (single.time[64], history.stop.abs());
            for (time, displacement) in single.time.iter().zip(&single.displacement) {
                let at = history.time.partition_point(|t| t < time).min(800);
                let near = (history.time[at] - time).abs() < 2e-3 * period;
                assert!(!near || (history.displacement[at] - displacement).abs() < 0.05 * size);
            }
            for instant in &history.instants {
                // Both sides of it, at the stop, a rounding apart.
                let at = history.time.partition_point(|t| *t < instant.time * (1.0 - 1e-13));
                for side in [at, at + 1] {
                    assert!((history.time[side] / instant.time - 1.0).abs() < 1e-12);
                    assert!((history.displacement[side] - history.stop).abs() < 1e-9 * size);
                }
                let [before, after] = [at, at + 1].map(|side| history.velocity[side] == 0.0);
                assert_eq!([before, after], [!instant.touching, instant.touching]);
            }
        }
    }
}

#[test]
fn the_rod_of_three_elements_has_the_energies_known_from_elsewhere() {
    let settings = BranchSettings { frequency_hz: Some([0.2, 0.34155]), ..settings() };
    let computed = branch(rod(3, &[tip()]), &settings);
    assert_eq!(computed.branch.end.reasons, [EndReason::FrequencyWindow], "{}", computed.branch.end.message);
    let last = computed.branch.points.last().unwrap();
    assert!((last.omega / TAU / 0.34155 - 1.0).abs() < 1e-13);
    // The frequency is given with its last digit exact; energies rise by 55 times its relative change.
    assert!((last.total_energy / 1.630_176_961_523_382 - 1.0).abs() < 1e-12, "{}", last.total_energy);
    assert!((last.kinetic_energy / 0.842_186_695_352_613 - 1.0).abs() < 1e-12, "{}", last.kinetic_energy);
}

#[test]
fn harmonic_balance_with_many_harmonics_runs_into_the_exact_branch() {
    let at = |method, harmonics| {
        let start = BranchStart::Energy { ratio: 2.0, upward: true };
        let settings = BranchSettings { method, harmonics, start, max_points: 1, ..settings() };
        branch(rod(6, &[tip()]), &settings).branch.points.swap_remove(0)
    };
    let exact = at(BranchMethod::Shooting, 12);
    let error = |harmonics| {
        let point = at(BranchMethod::HarmonicBalance, harmonics);
        assert!((point.kinetic_energy / exact.kinetic_energy - 1.0).abs() < 1e-10);
        // Exact coefficients beside those of MS-HBM, with the sign of the fundamental.
        let tip = point.coefficients.n_coordinates() - 1;
        let gap = |n: usize| (point.coefficients.of(tip)[n] - exact.coefficients.of(tip)[n]).norm();
        let worst = (0..=12).map(gap).fold(0.0, f64::max) / exact.fundamental.abs();
        (
            (point.omega / exact.omega - 1.0).abs(),
            worst,
            (point.peak_contact_force / exact.peak_contact_force - 1.0).abs(),
        )
    };
    let (coarse, fine) = (error(24), error(192));
    // The tolerance of the continuation is 1e-11 in scaled unknowns, whose length is a few units.
    assert!(fine.0 < 1e-11 && fine.0 < 1e-2 * coarse.0, "{coarse:?} {fine:?}");
    assert!(fine.1 < 1e-8 && fine.1 < 1e-3 * coarse.1, "{coarse:?} {fine:?}");
    assert!(fine.2 < 1e-5 && fine.2 < 1e-2 * coarse.2, "{coarse:?} {fine:?}");
}

#[test]
fn several_stops_and_springs_are_followed_from_grazing_too() {
    let stops = [
        Stop::rigid(1.0, Direction::Axial, Side::Positive, 1.0).on_spring(5.0),
        Stop::rigid(0.5, Direction::Axial, Side::Positive, 0.8),
        Stop::rigid(1.0, Direction::Axial, Side::Negative, 1.3),
    ];
    let settings = BranchSettings { max_energy_ratio: Some(2.0), harmonics: 30, ..settings() };
    let computed = branch(rod(4, &stops), &settings);
    assert_eq!(computed.branch.end.reasons, [EndReason::MaxEnergy], "{}", computed.branch.end.message);
    let last = computed.branch.points.last().unwrap();
    assert!(last.residual < 1e-10 && last.contact_intervals > 1);
    // The same force through the balance of the whole: ∫ of all forces over a period is what the clamped end takes.
    let history = computed.time_history(computed.branch.points.len() - 1, 0, 4000, "").unwrap();
    let peak = history.force.iter().copied().fold(0.0, f64::max);
    for (force, displacement) in history.force.iter().zip(&history.displacement) {
        // The spring: λ = k_c (q − g₀) beyond the stop, nothing before.
        assert!((force - 5.0 * (displacement - 1.0).max(0.0)).abs() < 1e-9 * peak.max(1.0));
    }
    assert!(last.peak >= history.displacement.iter().copied().fold(f64::NEG_INFINITY, f64::max) - 1e-12);
}

/// Growth of a disturbance from the period `from` to the period `to`, in the energy norm.
fn growth(computed: &ComputedBranch, point: usize, [from, to]: [usize; 2]) -> f64 {
    let mut problem = computed.exact().unwrap().unwrap();
    let motion = problem.motion(&computed.unknowns[point]).unwrap();
    let dynamics = problem.dynamics();
    let omega = dynamics.omega().to_vec();
    let mut state = motion.state.clone();
    state.z.iter_mut().zip(&omega).enumerate().for_each(|(k, (z, ω))| *z += 1e-9 / (ω * (k + 1) as f64));
    let mut distances = Vec::new();
    for _ in 0..to {
        state = dynamics.propagate(&state, TAU / motion.omega).unwrap().end;
        let part =
            |k: usize| (omega[k] * (state.z[k] - motion.state.z[k])).powi(2) + (state.v[k] - motion.state.v[k]).powi(2);
        distances.push((0..omega.len()).map(part).sum::<f64>().sqrt());
    }
    distances[to - 1] / distances[from - 1]
}

#[test]
fn what_is_called_unstable_grows_and_what_is_called_stable_does_not() {
    let settings = BranchSettings { max_energy_ratio: Some(4.0), ..settings() };
    let computed = branch(rod(5, &[tip()]), &settings);
    let points = &computed.branch.points;
    let judged = |point: &ModalPoint| point.stability.unwrap();
    let worst =
        (0..points.len()).max_by(|&i, &j| judged(&points[i]).magnitude().total_cmp(&judged(&points[j]).magnitude()));
    let worst = worst.unwrap();
    assert!(judged(&points[worst]).is_unstable() && judged(&points[worst]).magnitude() > 1.05);
    let rate = growth(&computed, worst, [60, 100]).powf(1.0 / 40.0);
    assert!((rate / judged(&points[worst]).magnitude() - 1.0).abs() < 5e-3, "{rate}, {:?}", judged(&points[worst]));
    // A change of energy drifts away linearly in time, and faster than that nothing.
    let stable =
        (1..points.len()).find(|&i| judged(&points[i]).stable == Some(true) && points[i].events.is_empty()).unwrap();
    assert!(growth(&computed, stable, [50, 200]) < 8.0);
    // The changes are located: beyond each the multiplier has hardly left the circle, and the next point is of the new
    // kind.
    let is_change = |i: &usize| points[*i].has_event(Event::StabilityChange);
    let changes: Vec<usize> = (0..points.len()).filter(is_change).collect();
    assert!(!changes.is_empty() && changes.len() % 2 == usize::from(judged(points.last().unwrap()).is_unstable()));
    for i in changes {
        assert_ne!(judged(&points[i - 1]).stable, judged(&points[i]).stable);
        let near = judged(&points[i]).magnitude().min(judged(&points[i - 1]).magnitude());
        assert!(near < 1.0 + 1e-3 && judged(&points[i]).magnitude() < 1.0 + 1e-3, "{:?}", points[i].stability);
    }
}

#[test]
fn points_in_harmonics_have_the_stability_of_the_exact_motion_beside_them() {
    let settings = BranchSettings { max_energy_ratio: Some(4.0), ..settings() };
    let exact = branch(rod(5, &[tip()]), &settings);
    let internal_resonance = ResonanceRule::Follow;
    let method = BranchMethod::HarmonicBalance;
    let harmonics = BranchSettings { method, harmonics: 40, internal_resonance, ..settings.clone() };
    let found = branch(rod(5, &[tip()]), &harmonics);
    let count = |of: &ComputedBranch, stable: Option<bool>| {
        of.branch.points.iter().filter(|point| point.stability.and_then(|s| s.stable) == stable).count()
    };
    assert!(count(&found, Some(false)) > 0 && count(&found, None) == 0);
    let changes = |computed: &ComputedBranch| {
        let changed = computed.branch.points.iter().filter(|p| p.has_event(Event::StabilityChange));
        changed.map(|p| p.omega).collect::<Vec<f64>>()
    };
    let (a, b) = (changes(&exact), changes(&found));
    assert_eq!(a.len(), b.len());
    assert!(a.iter().zip(&b).all(|(a, b)| (a / b - 1.0).abs() < 1e-4), "{a:?} {b:?}");
    let never = BranchSettings { stability: StabilityRule::Never, ..harmonics.clone() };
    let never = branch(rod(5, &[tip()]), &never);
    assert_eq!(count(&never, None), never.branch.points.len());
    // Without a changed stability the points are the same.
    assert_eq!(never.branch.points.len() + b.len(), found.branch.points.len());
    // Whoever ends the computation of the stability gets all points, of a branch that is not complete.
    for evaluations in [0, 20] {
        let ends = move |doing: &str, n: usize| match doing.contains("stability") && n >= evaluations {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        };
        let ended = branch(rod(5, &[tip()]), &BranchSettings { watch: Watch::new(ends), ..harmonics.clone() });
        assert!(ended.branch.end.reasons == [EndReason::Stopped] && !ended.branch.end.complete);
        assert_eq!(ended.branch.points.len(), never.branch.points.len());
    }
}

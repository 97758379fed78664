//! The rod of Section 3, from elements to branches.

use crate::support;

use nlmodes::modal::{EndReason, Event};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes::branches::{BranchSettings, BranchStart, ComputedBranch, ResonanceRule, compute_branch};
use nlmodes::fem::MassMatrix;
use nlmodes::model::MasslessContactModel;

const ELEMENTS: usize = 100;
const GAP: f64 = support::ROD_GAP;

fn model_of(elements: usize) -> MasslessContactModel {
    support::rod(elements, MassMatrix::Consistent)
}

fn branch(harmonics: usize, max_energy_ratio: Option<f64>, frequency_hz: Option<[f64; 2]>) -> ComputedBranch {
    let internal_resonance = ResonanceRule::Follow; // the loop of the paper
    let settings =
        BranchSettings { harmonics, max_energy_ratio, frequency_hz, internal_resonance, ..BranchSettings::default() };
    let computed = compute_branch(model_of(ELEMENTS), &settings, |_| ControlFlow::Continue(())).unwrap();
    assert!(computed.branch.end.complete, "{:?}", computed.branch.end);
    for (i, point) in computed.branch.points.iter().enumerate() {
        assert!(point.residual < 1e-10, "point {i}: residual {:e}", point.residual);
    }
    computed
}

/// Frequency (Hz) and averaged kinetic energy (J) of linear mode `mode` with the tip just touching, in closed form.
///
/// Between its ends the discrete rod moves as `q_j = sin κj`. The massless tip follows its neighbour; what its
/// missing mass leaves of the neighbour's equation is `(1 + μ) sin κN = sin κ(N − 1)`, `μ = ω² ρ l²/6E`.
fn grazing_of(mode: usize) -> (f64, f64) {
    let (n, l) = (ELEMENTS as f64, 20.0 / ELEMENTS as f64);
    let mu = |kappa: f64| (2.0 - 2.0 * kappa.cos()) / (4.0 + 2.0 * kappa.cos());
    let f = |kappa: f64| (1.0 + mu(kappa)) * (kappa * n).sin() - (kappa * (n - 1.0)).sin();
    let (mut low, mut high) = [mode - 1, mode].map(|k| std::f64::consts::PI * k as f64 / n).into();
    (low, high) = (low + 1e-9, high - 1e-9);
    let sign = f(low).signum();
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        *if f(middle).signum() == sign { &mut low } else { &mut high } = middle;
    }
    let omega = (6.0 * mu(low) * 210e9 / 9000.0).sqrt() / l;
    let q = |j: usize| if j < ELEMENTS { (low * j as f64).sin() } else { 0.0 };
    // Consistent mass without the row and column of the tip; its tip moves as q_{N−1}.
    let square: f64 = (1..ELEMENTS).map(|j| 9000.0 * l / 6.0 * q(j) * (4.0 * q(j) + 2.0 * q(j + 1))).sum();
    (omega / TAU, 0.25 * (omega * GAP / q(ELEMENTS - 1)).powi(2) * square)
}

fn hz(computed: &ComputedBranch, i: usize) -> f64 {
    computed.branch.points[i].omega / TAU
}

fn last(computed: &ComputedBranch) -> usize {
    computed.branch.points.len() - 1
}

#[test]
fn the_closed_form_gives_the_frequencies_of_the_rod_with_a_massless_tip() {
    assert!((grazing_of(1).0 - 60.786_607_27).abs() < 1e-8);
    assert!((grazing_of(2).0 - 182.374_965_93).abs() < 1e-8);
    assert!((grazing_of(1).1 / 8.150_553_44e8 - 1.0).abs() < 1e-8);
}

#[test]
fn one_harmonic_leads_from_grazing_to_three_times_its_energy() {
    let computed = branch(1, Some(3.0), None);
    let (f, energy) = grazing_of(1);
    assert!((hz(&computed, 0) / f - 1.0).abs() < 1e-11);
    assert!((computed.branch.points[0].kinetic_energy / energy - 1.0).abs() < 1e-9);
    assert_eq!(computed.branch.points[0].events, [Event::Grazing]);
    // Own computation in Python: dense matrices, quadrature by Gauss, Newton's method.
    assert!((hz(&computed, last(&computed)) - 70.336_945_574_391).abs() < 1e-8);
    assert_eq!(computed.branch.end.reasons, [EndReason::MaxEnergy]);
}

#[test]
fn two_harmonics_reach_75_hz_at_fifteen_times_the_grazing_energy() {
    let computed = branch(2, Some(15.2), None);
    let points = &computed.branch.points;
    let energy = grazing_of(1).1;
    assert!((points[last(&computed)].kinetic_energy / energy - 15.2).abs() < 1e-7);
    // The same computation in Python: 75.365979668671 Hz.
    assert!((hz(&computed, last(&computed)) - 75.365_979_668_671).abs() < 1e-8, "{}", hz(&computed, last(&computed)));
    assert!(points.windows(2).all(|w| w[1].omega > w[0].omega && w[1].kinetic_energy > w[0].kinetic_energy));
}

#[test]
fn two_harmonics_pass_through_energies_computed_elsewhere() {
    // Python, as above: energy over that at grazing, Hz.
    for (ratio, expected) in [(1.1, 61.663_291_193_764), (2.0, 66.556_745_713_823), (5.0, 71.653_020_720_739)] {
        let computed = branch(2, Some(ratio), None);
        let found = hz(&computed, last(&computed));
        assert!((found - expected).abs() < 1e-8, "{ratio}: {found} Hz against {expected} Hz");
    }
}

#[test]
fn three_harmonics_pass_the_second_mode_at_its_own_grazing_and_come_back_on_the_other_side() {
    let computed = branch(3, Some(20.0), Some([50.0, 66.5]));
    let points = &computed.branch.points;
    let (first, second) = (grazing_of(1), grazing_of(2));
    let crossing: Vec<usize> = (0..points.len()).filter(|&i| points[i].has_event(Event::BranchPoint)).collect();
    assert_eq!(crossing.len(), 1, "{crossing:?}");
    let at = &points[crossing[0]];
    // Four half-branches meet where the third harmonic alone is the second mode, just touching: f = f_2/3, E = E_g of
    // mode 2.
    assert!((second.1 / first.1 - 9.000_503_46).abs() < 1e-8);
    assert!((hz(&computed, crossing[0]) / (second.0 / 3.0) - 1.0).abs() < 1e-7, "{}", hz(&computed, crossing[0]));
    assert!((at.kinetic_energy / second.1 - 1.0).abs() < 1e-5, "{}", at.kinetic_energy / second.1);
    let tip = |i: usize, n: usize| points[i].coefficients.of(ELEMENTS - 1)[n].re;
    assert!(tip(crossing[0], 1).abs() < 1e-3 * GAP && (tip(crossing[0], 3).abs() / GAP - 1.0).abs() < 1e-3);
    // Up the internal-resonance branch the third harmonic is in antiphase; on the other side in phase.
    let share = |i: usize| tip(i, 3) / tip(i, 1);
    assert!(share(crossing[0] / 2) < 0.0, "{}", share(crossing[0] / 2));
    let lowest =
        (crossing[0]..points.len()).min_by(|&i, &j| points[i].kinetic_energy.total_cmp(&points[j].kinetic_energy));
    assert!(share(lowest.unwrap()) > 0.0, "{}", share(lowest.unwrap()));
    // The third harmonic helps to reach the stop: less energy than the linear mode needs.
    let after = &points[crossing[0]..];
    let least = after.iter().map(|p| p.kinetic_energy / first.1).fold(f64::INFINITY, f64::min);
    assert!(least < 0.95 && least > 0.8, "{least}");
    // It ends at the limit asked for, to rounding.
    assert_eq!(computed.branch.end.reasons, [EndReason::FrequencyWindow]);
    assert!((hz(&computed, last(&computed)) - 66.5).abs() < 1e-10, "{}", hz(&computed, last(&computed)));
}

#[test]
fn a_branch_ends_on_the_energy_asked_for() {
    for ratio in [1.5, 8.0, 12.0] {
        let computed = branch(3, Some(ratio), None);
        assert_eq!(computed.branch.end.reasons, [EndReason::MaxEnergy]);
        let found = computed.branch.points[last(&computed)].kinetic_energy / computed.grazing.energy;
        assert!((found / ratio - 1.0).abs() < 1e-9, "{found} against {ratio}");
    }
}

#[test]
fn a_fine_mesh_with_few_held_modes_gives_what_all_of_them_give() {
    // Beyond 400 degrees of freedom only some held modes are computed.
    let settings = BranchSettings { harmonics: 2, max_energy_ratio: Some(3.0), ..BranchSettings::default() };
    let run = |held_modes| {
        let settings = BranchSettings { held_modes, ..settings.clone() };
        compute_branch(model_of(420), &settings, |_| ControlFlow::Continue(())).unwrap()
    };
    let (few, all) = (run(None), run(Some(419)));
    assert!(few.structure.n_held_modes() < 200 && all.structure.n_held_modes() == 419);
    let [few, all] = [&few, &all].map(|c| hz(c, last(c)));
    // What is left out falls with the cube of the modes and is near (2/3)(x/mπ)⁴ m ~ 1e-7 at 50.
    assert!((few / all - 1.0).abs() < 1e-6, "{few} Hz against {all} Hz");
}

/// The continuous rod has an exact backbone: one contact of length `2D − T` a period T, `D = 2L/c`, with a constant
/// force.
#[test]
fn finer_rods_approach_the_backbone_of_the_continuous_one() {
    let speed = (210e9_f64 / 9000.0).sqrt();
    let (d, hz) = (40.0 / speed, 1.19 * speed / 80.0);
    let period = 1.0 / hz;
    let velocity = 2.0 * GAP / (2.0 * period - 3.0 * d);
    let r = period / d;
    let exact = 0.5 * 9000.0 * 20.0 * velocity * velocity * (r - 1.0) * (3.0 - r) / r;
    let start = BranchStart::Frequency { hz, upward: true };
    let settings = BranchSettings { harmonics: 20, start, max_points: 1, ..BranchSettings::default() };
    let errors = [20, 40, 80].map(|elements| {
        let computed = compute_branch(model_of(elements), &settings, |_| ControlFlow::Continue(())).unwrap();
        let point = &computed.branch.points[0];
        assert!((point.omega / TAU - hz).abs() < 1e-9 && point.contact_intervals == 1);
        point.kinetic_energy / exact - 1.0
    });
    // The impact spreads over some elements of a discrete rod: an error of about the 1.2th power of their length.
    assert!(errors[0] < 1.6 * errors[1] && errors[1] < 1.9 * errors[2], "{errors:?}");
    assert!((errors[2] + 0.076).abs() < 0.002, "{errors:?}");
}

//! The cantilever of Section 4, from elements to its branch.

use crate::support;

use nlmodes::modal::{EndReason, Event};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes::branches::{BranchSettings, ComputedBranch, ResonanceRule, compute_branch};
use nlmodes::model::linear_modes;
use support::{beam, massless_beam};

fn branch(harmonics: usize, max_energy_ratio: f64) -> ComputedBranch {
    let (max_energy_ratio, internal_resonance) = (Some(max_energy_ratio), ResonanceRule::Follow);
    let settings = BranchSettings { harmonics, max_energy_ratio, internal_resonance, ..BranchSettings::default() };
    let computed = compute_branch(massless_beam(), &settings, |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(computed.branch.end.reasons, [EndReason::MaxEnergy], "{:?}", computed.branch.end);
    assert!(computed.branch.points.iter().all(|p| p.residual < 1e-10));
    computed
}

fn end_hz(computed: &ComputedBranch) -> f64 {
    computed.branch.points.last().unwrap().omega / TAU
}

#[test]
fn both_rows_of_table_1_lie_at_40_10_hz() {
    let kept = beam(187.60e9);
    let massless = massless_beam();
    for modes in
        [linear_modes(kept.mass(), kept.stiffness(), 1), linear_modes(massless.mass(), massless.stiffness(), 1)]
    {
        let hz = modes.unwrap().omega[0] / TAU;
        // Length and grading were fitted to 40.10 Hz; a beam written independently in Python, its shape functions
        // integrated by Gauss, gives 40.1000001 for both.
        assert!((hz - 40.10).abs() < 1e-6, "{hz}");
    }
}

#[test]
fn five_harmonics_lead_smoothly_from_grazing_to_six_times_its_energy() {
    let computed = branch(5, 6.0);
    // Its corner is a regular one: all equations are small behind so stiff a contact node, which does not make
    // directions free. (Curves around it took 6700 evaluations.)
    assert!(computed.evaluations < 3000, "{}", computed.evaluations);
    let points = &computed.branch.points;
    for pair in points.windows(2) {
        assert!(pair[1].omega > pair[0].omega && pair[1].modal_amplitude > pair[0].modal_amplitude);
        assert!(pair[1].kinetic_energy > pair[0].kinetic_energy);
    }
    for point in &points[1..] {
        let rough = [Event::BranchPoint, Event::Kink, Event::Fold, Event::FrequencyFold];
        assert!(!point.events.iter().any(|event| rough.contains(event)), "{:?}", point.events);
    }
    // Own computation in Python (dense matrices, quadrature by Gauss between the roots, Newton's method).
    assert!((computed.grazing.energy / 0.004_768_980_733_03 - 1.0).abs() < 1e-7, "{}", computed.grazing.energy);
    assert!((end_hz(&computed) - 52.092_098_734).abs() < 1e-6, "{}", end_hz(&computed));
}

#[test]
fn the_backbone_passes_through_frequencies_computed_elsewhere() {
    // Python, as above: harmonics, energy over that at grazing, Hz.
    let elsewhere =
        [(1, 3.0, 49.473_500_209), (1, 6.0, 54.040_955_957), (5, 1.5, 44.241_216_140), (5, 3.0, 48.522_571_620)];
    for (harmonics, ratio, expected) in elsewhere {
        let found = end_hz(&branch(harmonics, ratio));
        // Both solve the same equations; the matrices differ by rounding, and 21 graded elements have a condition near
        // 1e9.
        assert!((found - expected).abs() < 1e-6, "{harmonics} harmonics, {ratio}: {found} against {expected}");
    }
}

#[test]
fn two_touches_close_together_are_not_missed() {
    // With six harmonics the tip touches twice in quick succession, and between two of the 64 samples of a period its
    // gap rises, falls and rises again. With sampled switching and 4096 samples the branch ends at 41.795528 Hz too.
    let found = end_hz(&branch(6, 6.0));
    assert!((found - 41.795_528).abs() < 1e-5, "{found}");
}

#[test]
fn the_first_mode_takes_part_as_one_and_the_second_two_orders_below() {
    let computed = branch(5, 6.0);
    let participation = computed.participation(2).unwrap();
    assert_eq!(participation.len(), computed.branch.points.len());
    assert_eq!(participation[0].harmonics, 1..=5);
    // At grazing the motion is the linear mode: normalised by mass, it takes part alone.
    assert!((participation[0].factors[0] - 1.0).abs() < 1e-10 && participation[0].factors[1].abs() < 1e-10);
    for (point, p) in computed.branch.points.iter().zip(&participation) {
        // In the range of the paper's test, to 41 Hz, two orders of magnitude lie between the modes; one at 50 Hz.
        let bounds = if point.omega < 41.0 * TAU { (0.025, 0.01) } else { (0.15, 0.15) };
        assert!((p.factors[0] - 1.0).abs() < bounds.0 && p.factors[1].abs() < bounds.1, "{p:?}");
        assert!(p.quadrature.iter().all(|q| q.abs() < 1e-12), "{p:?}");
    }
    let at_half = &participation[participation.len() / 2];
    assert!(at_half.factors[1].abs() > 1e-4, "{at_half:?}");
}

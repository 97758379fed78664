//! Changes of the contact pattern along a branch, whatever its steps are.

use crate::support;

use std::ops::ControlFlow;

use nlmodes_continuation::{Bound, Continuation, EventKind, ParametricSystem, StepSettings, StopReason};
use nlmodes_hbm::{Switching, Symmetry};
use nlmodes_model::Side;

use support::{condense, problem, rod};

/// Logarithms of the energy over that at grazing at which the pattern changes, of a rod of 60 elements, up to 20, with
/// steps up to `longest`.
fn changes(ea: f64, rho_a: f64, length: f64, gap: f64, longest: f64) -> Vec<f64> {
    let structure = condense(&rod(60, ea, rho_a, length, &[(60, Side::Positive, gap)]));
    let (mut problem, start) = problem(&structure, 1, 14, Symmetry::Even, Switching::Exact);
    let dim = problem.dim();
    let (x, direction) = problem.start(&start);
    let settings = Continuation {
        bounds: vec![Bound { coordinate: dim, min: -8.0, max: 20_f64.ln() }],
        step: StepSettings { max: longest, far: 10.0, ..StepSettings::default() },
        max_points: 5000,
        ..Continuation::default()
    };
    let branch = settings.run(&mut problem, &x, 0.0, &direction, |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(branch.stop, StopReason::Bound { coordinate: dim, value: 20_f64.ln() });
    let is_change = |kind: &EventKind| matches!(kind, EventKind::PatternChange { .. });
    branch.points.iter().filter(|q| q.p > 1e-3 && q.events.iter().any(is_change)).map(|q| q.p).collect()
}

/// On the way back from the tip of its internal-resonance branch a step of usual length enters and leaves a piece on
/// which the contact closes three times a period.
#[test]
fn a_pattern_that_lasts_for_less_than_a_step_is_seen_as_with_short_steps() {
    // Over that at grazing energies are the same in all units.
    let fine = changes(1.0, 1.0, 1.0, 1.0, 0.02);
    for [ea, rho_a, length, gap] in [[210e9, 9000.0, 20.0, 0.5], [1.0, 1.0, 1.0, 1.0]] {
        let usual = changes(ea, rho_a, length, gap, 0.1);
        assert_eq!(usual.len(), fine.len(), "{usual:?} {fine:?}");
        assert!(fine.len() >= 7, "{fine:?}");
        let apart = usual.iter().zip(&fine).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(apart < 1e-6, "{apart:e}: {usual:?} {fine:?}");
    }
}

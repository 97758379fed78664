//! How branches begin and end.

use std::ops::ControlFlow;

use nlmodes_continuation::{
    Bound, Continuation, ContinuationError, Linearization, ParametricSystem, StepSettings, StopReason,
};

use crate::samples::{smooth, trace, window};

fn line(x: f64, p: f64) -> [f64; 3] {
    [x - p, 1.0, -1.0]
}

fn run(
    settings: &Continuation,
    from: [f64; 2],
    along: &[f64],
) -> Result<StopReason, ContinuationError<std::convert::Infallible>> {
    settings.run(&mut smooth(line), &from[..1], from[1], along, |_| ControlFlow::Continue(())).map(|b| b.stop)
}

#[test]
fn the_last_point_lies_on_the_bound_that_is_met_first() {
    let bounds = vec![Bound { coordinate: 1, min: -1.0, max: 0.7 }, Bound { coordinate: 0, min: -1.0, max: 0.5 }];
    let settings = Continuation { bounds, ..Continuation::default() };
    let branch = trace(&settings, smooth(|x, p| [x - p * p, 1.0, -2.0 * p]), [0.0, 0.0], [0.0, 1.0]);
    assert_eq!(branch.stop, StopReason::Bound { coordinate: 1, value: 0.7 });
    let last = branch.points.last().unwrap();
    assert!((last.p - 0.7).abs() < 1e-10 && (last.x[0] - 0.49).abs() < 1e-10 && last.residual < 1e-10);
}

#[test]
fn the_number_of_points_is_limited() {
    let settings = Continuation { max_points: 7, ..Continuation::default() };
    let branch = trace(&settings, smooth(line), [0.0, 0.0], [1.0, 1.0]);
    assert_eq!((branch.stop, branch.points.len()), (StopReason::MaxPoints, 7));
}

#[test]
fn the_observer_sees_every_point_and_can_stop() {
    let mut seen = Vec::new();
    let branch = Continuation::default()
        .run(&mut smooth(line), &[0.0], 0.0, &[1.0, 1.0], |q| {
            seen.push(q.p);
            if seen.len() == 5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
        .unwrap();
    assert_eq!(branch.stop, StopReason::Stopped);
    assert_eq!(seen, branch.points.iter().map(|q| q.p).collect::<Vec<_>>());
}

#[test]
fn a_start_off_the_curve_is_corrected_across_the_direction() {
    let branch = trace(&window(1, -1.0, 1.0), smooth(line), [0.3, 0.1], [1.0, 1.0]);
    assert!((branch.points[0].p - 0.2).abs() < 1e-12 && (branch.points[0].x[0] - 0.2).abs() < 1e-12);
}

#[test]
fn a_singular_start_is_an_error() {
    let crossing = Continuation::default().run(
        &mut smooth(|x, p| [x * (x - p), 2.0 * x - p, -x]),
        &[0.0],
        0.0,
        &[0.0, 1.0],
        |_| ControlFlow::Continue(()),
    );
    assert!(matches!(crossing, Err(ContinuationError::Start(_))));
    let without_solution = Continuation::default().run(
        &mut smooth(|x, p| [x * x + p * p + 1.0, 2.0 * x, 2.0 * p]),
        &[1.0],
        1.0,
        &[0.0, 1.0],
        |_| ControlFlow::Continue(()),
    );
    assert!(matches!(without_solution, Err(ContinuationError::Start(_))));
}

#[test]
fn a_residual_that_is_not_finite_ends_the_branch_with_the_reason() {
    let f = |x: f64, p: f64| if p > 0.5 { [f64::NAN; 3] } else { line(x, p) };
    let branch = trace(&Continuation::default(), smooth(f), [0.0, 0.0], [1.0, 1.0]);
    let StopReason::StepTooSmall { refusal, .. } = &branch.stop else { panic!("{:?}", branch.stop) };
    assert!(refusal.to_string().contains("not finite"), "{refusal}");
    let last = branch.points.last().unwrap();
    assert!(last.p <= 0.5 && last.p > 0.5 - 1e-5);
    let start = Continuation::default().run(&mut smooth(f), &[1.0], 1.0, &[1.0, 1.0], |_| ControlFlow::Continue(()));
    assert!(matches!(start, Err(ContinuationError::Start(_))));
}

#[derive(Debug, thiserror::Error)]
#[error("beyond the edge")]
struct Edge;

struct Bounded;

impl ParametricSystem for Bounded {
    type Error = Edge;

    fn dim(&self) -> usize {
        1
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Edge> {
        if p > 0.5 {
            return Err(Edge);
        }
        [out.residual[0], out.jacobian[(0, 0)], out.jacobian[(0, 1)]] = line(x[0], p);
        Ok(())
    }
}

#[test]
fn a_system_that_fails_ends_the_branch_or_prevents_it() {
    let branch = trace(&Continuation::default(), Bounded, [0.0, 0.0], [1.0, 1.0]);
    assert!(matches!(branch.stop, StopReason::StepTooSmall { .. }));
    let start = Continuation::default().run(&mut Bounded, &[1.0], 1.0, &[1.0, 1.0], |_| ControlFlow::Continue(()));
    assert!(matches!(start, Err(ContinuationError::System(Edge))));
}

#[test]
fn what_does_not_fit_is_refused() {
    let default = Continuation::default();
    assert!(matches!(
        run(&default, [0.0, 0.0], &[1.0]),
        Err(ContinuationError::Dimension { expected: 2, found: 1, .. })
    ));
    assert!(matches!(run(&default, [0.0, 0.0], &[0.0, 0.0]), Err(ContinuationError::Setting { .. })));
    let foreign = window(2, 0.0, 1.0);
    assert!(matches!(run(&foreign, [0.0, 0.0], &[1.0, 1.0]), Err(ContinuationError::Setting { .. })));
    for step in [
        StepSettings { min: 0.0, ..StepSettings::default() },
        StepSettings { max: f64::NAN, ..StepSettings::default() },
        StepSettings { min: 1.0, ..StepSettings::default() },
    ] {
        let settings = Continuation { step, ..Continuation::default() };
        assert!(matches!(run(&settings, [0.0, 0.0], &[1.0, 1.0]), Err(ContinuationError::Setting { .. })));
    }
    let watched = Continuation { watched: vec![0, 1], ..Continuation::default() };
    assert!(matches!(run(&watched, [0.0, 0.0], &[1.0, 1.0]), Err(ContinuationError::Setting { value: 1.0, .. })));
    for (min, max) in [(1.0, -1.0), (f64::NAN, 1.0), (-1.0, f64::NAN)] {
        assert!(matches!(run(&window(1, min, max), [0.0, 0.0], &[1.0, 1.0]), Err(ContinuationError::Setting { .. })));
    }
    for (coordinate, from) in [(0, [1.5, 0.0]), (1, [0.0, -1.5])] {
        let outside = run(&window(coordinate, -1.0, 1.0), from, &[1.0, 1.0]);
        assert!(matches!(outside, Err(ContinuationError::OutsideBound { min: -1.0, max: 1.0, .. })), "{outside:?}");
    }
    let unable = StepSettings { max_iterations: 0, ..StepSettings::default() };
    let unable = Continuation { step: unable, ..Continuation::default() };
    assert!(matches!(run(&unable, [0.0, 0.0], &[1.0, 1.0]), Err(ContinuationError::Setting { value: 0.0, .. })));
    let long = default.run(&mut smooth(line), &[0.0, 0.0], 0.0, &[1.0, 1.0], |_| ControlFlow::Continue(()));
    assert!(matches!(long, Err(ContinuationError::Dimension { expected: 1, found: 2, .. })));
}

/// Steps of any length end on a bound of any sign, reached from above or from below.
#[test]
fn bounds_on_either_side_of_zero_are_met_from_both_sides() {
    let curve = |x: f64, p: f64| [x - p.sin(), 1.0, -p.cos()];
    for (from, bound) in [(0.8, 0.3), (0.8, -0.3), (-0.8, -0.3), (-0.8, 0.3), (0.2, 0.9), (-0.2, -0.9), (3.0, 1.0)] {
        let (min, max) = if bound < from { (bound, 9.0) } else { (-9.0, bound) };
        let branch = trace(&window(1, min, max), smooth(curve), [f64::sin(from), from], [0.0, bound - from]);
        assert_eq!(branch.stop, StopReason::Bound { coordinate: 1, value: bound }, "{from}");
        let last = branch.points.last().unwrap();
        assert!((last.p - bound).abs() < 1e-15 && (last.x[0] - bound.sin()).abs() < 1e-10, "{from} {bound}: {last:?}");
    }
}

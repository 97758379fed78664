//! Crossings of branches, and half-branches that only come close.

use std::ops::ControlFlow;

use nlmodes_continuation::{Continuation, EventKind, StopReason};

use crate::samples::{Embedded, assert_sound, events, smooth, trace, window};

const CROSSING: fn(&EventKind) -> bool = |e| *e == EventKind::BranchPoint;

#[test]
fn a_transcritical_point_is_named_and_passed_straight() {
    for x in [0.0, 0.97] {
        let settings = window(1, -1.0, 1.0);
        let from = if x == 0.0 { -0.613 } else { 0.97 };
        let along = if x == 0.0 { [0.0, 1.0] } else { [-1.0, -1.0] };
        let branch = trace(&settings, smooth(|x, p| [x * (x - p), 2.0 * x - p, -x]), [x, from], along);
        assert!(matches!(branch.stop, StopReason::Bound { coordinate: 1, .. }), "{:?}", branch.stop);
        assert_sound(&branch, &settings);
        let crossings = events(&branch, CROSSING);
        assert_eq!(crossings.len(), 1);
        assert!(crossings[0].p.abs() < 1e-8 && crossings[0].x[0].abs() < 1e-8);
        let on_own_line = |q: &f64, p: f64| if x == 0.0 { q.abs() } else { (q - p).abs() };
        assert!(branch.points.iter().all(|q| on_own_line(&q.x[0], q.p) < 1e-8));
    }
}

#[test]
fn a_pitchfork_is_passed_along_its_handle_and_around_its_prongs() {
    let f = |x: f64, p: f64| [x * (p - x * x), p - 3.0 * x * x, x];
    let settings = window(1, -1.0, 0.9);
    let branch = trace(&settings, smooth(f), [0.0, -0.613], [0.0, 1.0]);
    assert_eq!(branch.stop, StopReason::Bound { coordinate: 1, value: 0.9 });
    assert!(branch.points.iter().all(|q| q.x[0].abs() < 1e-8));
    let crossings = events(&branch, CROSSING);
    assert!(crossings.len() == 1 && crossings[0].p.abs() < 1e-8);

    let branch = trace(&settings, smooth(f), [0.9, 0.81], [-1.8, -1.0]);
    assert_eq!(branch.stop, StopReason::Bound { coordinate: 1, value: 0.9 });
    assert!((branch.points.last().unwrap().x[0] + 0.9_f64.sqrt()).abs() < 1e-8);
    assert_eq!(events(&branch, CROSSING).len(), 1);
}

#[test]
fn two_crossing_circles_are_told_apart() {
    let f = |x: f64, p: f64| {
        let (a, b) = (x * x + p * p - 1.0, (x - 1.0) * (x - 1.0) + p * p - 1.0);
        [a * b, 2.0 * x * b + 2.0 * (x - 1.0) * a, 2.0 * p * (a + b)]
    };
    let branch = trace(&Continuation::default(), smooth(f), [-1.0, 0.0], [0.0, 1.0]);
    assert_eq!(branch.stop, StopReason::Closed);
    assert!(branch.points.iter().all(|q| (q.x[0] * q.x[0] + q.p * q.p - 1.0).abs() < 1e-8));
    let crossings = events(&branch, CROSSING);
    assert_eq!(crossings.len(), 2);
    assert!(crossings.iter().all(|q| (q.x[0] - 0.5).abs() < 1e-8));
}

#[test]
fn a_figure_eight_is_followed_through_its_middle_twice() {
    let f = |x: f64, p: f64| [x.powi(4) - x * x + p * p, 4.0 * x.powi(3) - 2.0 * x, 2.0 * p];
    let branch = trace(&Continuation::default(), smooth(f), [1.0, 0.0], [0.0, 1.0]);
    assert_eq!(branch.stop, StopReason::Closed);
    let crossings = events(&branch, CROSSING);
    assert_eq!(crossings.len(), 2);
    assert!(crossings.iter().all(|q| q.x[0].abs() < 1e-7 && q.p.abs() < 1e-7));
    assert!(branch.points.iter().any(|q| q.x[0] < -0.9));
}

#[test]
fn of_two_arms_closer_than_a_step_the_own_one_is_kept() {
    for gap in [1e-4, 1e-3, 3e-3, 1e-2, 0.05] {
        let f = |x: f64, p: f64| [x * x - p * p - gap * gap, 2.0 * x, -2.0 * p];
        let settings = Continuation { watched: vec![0], ..window(1, -1.0, 1.0) };
        let start = (0.9_f64 * 0.9 + gap * gap).sqrt();
        let branch = trace(&settings, smooth(f), [start, -0.9], [-1.0, 1.0]);
        assert_eq!(branch.stop, StopReason::Bound { coordinate: 1, value: 1.0 }, "gap {gap}");
        assert_sound(&branch, &settings);
        assert!(branch.points.iter().all(|q| q.x[0] >= gap * (1.0 - 1e-9)), "jump at gap {gap}");
        assert!(events(&branch, CROSSING).is_empty());
        assert_eq!(events(&branch, |e| *e == EventKind::UnknownFold { index: 0 }).len(), 1);
        assert!(branch.points.len() < 200, "{} points at gap {gap}", branch.points.len());
    }
}

#[test]
fn of_two_parallel_arms_the_own_one_is_kept() {
    for gap in [0.003, 0.01, 0.03] {
        // x = s(p) and x = s(p) + gap, with a wave s.
        let f = |x: f64, p: f64| {
            let (d, slope) = (x - (3.0 * p).sin() / 3.0, -(3.0 * p).cos());
            [d * (d - gap), 2.0 * d - gap, (2.0 * d - gap) * slope]
        };
        let branch = trace(&window(1, -1.0, 10.0), smooth(f), [0.0, 0.0], [1.0, 1.0]);
        assert_eq!(branch.stop, StopReason::Bound { coordinate: 1, value: 10.0 });
        assert!(branch.points.iter().all(|q| (q.x[0] - (3.0 * q.p).sin() / 3.0).abs() < 1e-7), "jump at gap {gap}");
    }
}

#[test]
fn a_crossing_is_found_among_many_unknowns() {
    let mut system = Embedded(smooth(|x, p| [x * (p - x * x), p - 3.0 * x * x, x]));
    let direction: Vec<f64> = Embedded::<()>::lift(0.0, 1.0).into_iter().chain([1.0]).collect();
    let start = Embedded::<()>::lift(0.0, -0.613);
    let settings = window(4, -1.0, 0.5);
    let branch = settings.run(&mut system, &start, -0.613, &direction, |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(branch.stop, StopReason::Bound { coordinate: 4, value: 0.5 });
    assert!(branch.points.iter().all(|q| q.x[0].abs() < 1e-7));
    let crossings = events(&branch, CROSSING);
    assert!(crossings.len() == 1 && crossings[0].p.abs() < 1e-7);
}

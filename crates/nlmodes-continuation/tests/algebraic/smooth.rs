//! Smooth curves: folds, long runs, closed curves.

use nlmodes_continuation::{Continuation, EventKind, StopReason, conformance};

use crate::samples::{assert_sound, events, smooth, trace, window};

fn circle(x: f64, p: f64) -> [f64; 3] {
    [x * x + p * p - 1.0, 2.0 * x, 2.0 * p]
}

#[test]
fn a_circle_closes_and_its_folds_are_located() {
    let settings = Continuation { watched: vec![0], ..Continuation::default() };
    let branch = trace(&settings, smooth(circle), [0.6, 0.8], [0.8, -0.6]);
    assert_eq!(branch.stop, StopReason::Closed);
    assert_sound(&branch, &settings);
    let folds = events(&branch, |e| *e == EventKind::ParameterFold);
    assert_eq!(folds.len(), 2);
    assert!(folds.iter().all(|q| (q.p.abs() - 1.0).abs() < 1e-12 && q.x[0].abs() < 1e-8));
    let folds = events(&branch, |e| *e == EventKind::UnknownFold { index: 0 });
    assert_eq!(folds.len(), 2);
    assert!(folds.iter().all(|q| (q.x[0].abs() - 1.0).abs() < 1e-12 && q.p.abs() < 1e-8));
    let (first, last) = (&branch.points[0], branch.points.last().unwrap());
    assert!((first.p - last.p).abs() < 1e-9 && (first.x[0] - last.x[0]).abs() < 1e-9);
    assert!(branch.points.iter().all(|q| !q.events.contains(&EventKind::BranchPoint)));
}

#[test]
fn a_thin_ellipse_is_followed_around_its_ends() {
    let branch = trace(
        &Continuation::default(),
        smooth(|x, p| [x * x + 1e6 * p * p - 1.0, 2.0 * x, 2e6 * p]),
        [0.0, 1e-3],
        [1.0, 0.0],
    );
    assert_eq!(branch.stop, StopReason::Closed);
    assert_sound(&branch, &Continuation::default());
    assert!(branch.points.len() < 300, "{} points", branch.points.len());
    let lowest = branch.points.iter().map(|q| q.x[0]).fold(f64::INFINITY, f64::min);
    let highest = branch.points.iter().map(|q| q.x[0]).fold(f64::NEG_INFINITY, f64::max);
    assert!(lowest < -0.99 && highest > 0.99);
    let folds = events(&branch, |e| *e == EventKind::ParameterFold);
    assert!(folds.iter().any(|q| (q.p + 1e-3).abs() < 1e-10), "the fold at −1e-3");
}

#[test]
fn both_folds_of_a_cubic_are_passed() {
    let settings = window(1, -1.0, 1.0);
    let branch =
        trace(&settings, smooth(|x, p| [p - x * x * x + x, 1.0 - 3.0 * x * x, 1.0]), [-1.3, -0.897], [1.0, 1.0]);
    assert_eq!(branch.stop, StopReason::Bound { coordinate: 1, value: 1.0 });
    assert_sound(&branch, &settings);
    let folds = events(&branch, |e| *e == EventKind::ParameterFold);
    let at = 1.0 / 3.0_f64.sqrt();
    assert_eq!(folds.len(), 2);
    assert!((folds[0].x[0] + at).abs() < 1e-8 && (folds[1].x[0] - at).abs() < 1e-8);
    assert!((folds[0].p - 2.0 * at / 3.0).abs() < 1e-11);
}

#[test]
fn a_coordinate_that_stands_still_does_not_fold() {
    let settings = Continuation { watched: vec![0], ..window(1, -1.0, 20.0) };
    let branch = trace(
        &settings,
        smooth(|x, p| [(x - 1.0) * (2.0 + p.sin()), 2.0 + p.sin(), (x - 1.0) * p.cos()]),
        [1.0, 0.0],
        [0.0, 1.0],
    );
    assert_eq!(branch.stop, StopReason::Bound { coordinate: 1, value: 20.0 });
    assert!(branch.points.iter().all(|q| q.events.is_empty()));
}

#[test]
fn a_long_wave_is_not_taken_for_a_closed_curve() {
    let settings = Continuation { watched: vec![0], ..window(1, -1.0, 120.0) };
    let branch = trace(&settings, smooth(|x, p| [x - p.sin(), 1.0, -p.cos()]), [0.0, 0.0], [1.0, 1.0]);
    assert_eq!(branch.stop, StopReason::Bound { coordinate: 1, value: 120.0 });
    assert_sound(&branch, &settings);
    let folds = events(&branch, |e| *e == EventKind::UnknownFold { index: 0 });
    assert_eq!(folds.len(), (120.0 / std::f64::consts::PI + 0.5) as usize);
}

#[test]
fn conformance_tells_a_right_jacobian_from_a_wrong_one() {
    assert!(conformance::jacobian_defect(&mut smooth(circle), &[0.3], 0.4, 1e-5).unwrap() < 1e-9);
    let wrong = |x: f64, p: f64| [x * x + p * p - 1.0, 2.0 * x, 1.9 * p];
    assert!(conformance::jacobian_defect(&mut smooth(wrong), &[0.3], 0.4, 1e-5).unwrap() > 0.01);
}

/// At the top of the circle the parameter rests: which way it moves from there is no turn, whichever way that is.
#[test]
fn a_curve_that_begins_where_it_turns_has_no_fold_before_it_moves() {
    for (top, along) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        let branch = trace(&Continuation::default(), smooth(circle), [0.0, top], [along, 0.0]);
        let folds = events(&branch, |event| matches!(event, EventKind::ParameterFold));
        assert!(folds.iter().any(|q| (q.p + top).abs() < 1e-9), "the other side is one");
        let beyond = branch.points.iter().take_while(|q| q.p * top > -0.9);
        assert!(
            beyond.flat_map(|q| &q.events).all(|event| !matches!(event, EventKind::ParameterFold)),
            "{top} {along}"
        );
    }
}

/// `(x − 1)² = (1 − p)³`: both halves of the curve have the same tangent at its tip.
#[test]
fn a_cusp_is_passed_from_one_half_to_the_other() {
    let f = |x: f64, p: f64| [(x - 1.0).powi(2) - (1.0 - p).powi(3), 2.0 * (x - 1.0), 3.0 * (1.0 - p).powi(2)];
    for start in 0..20 {
        let p = 0.1 + 0.0137 * f64::from(start);
        let branch = trace(&window(1, 0.0, 2.0), smooth(f), [1.0 + (1.0 - p).powi(3).sqrt(), p], [-1.0, 1.0]);
        assert_eq!(
            branch.stop,
            StopReason::Bound { coordinate: 1, value: 0.0 },
            "from {p}: {:?}",
            branch.points.last()
        );
        assert!(branch.points.last().unwrap().x[0].abs() < 1e-9, "from {p}");
    }
}

//! Curves that are only piecewise smooth.

use std::ops::ControlFlow;

use nlmodes_continuation::{Branch, Continuation, EventKind, ParametricSystem, StopReason};

use crate::samples::{Embedded, assert_sound, events, piecewise, trace, window};

/// Comes along the x axis and leaves the origin at `angle` to it; the pieces meet on the bisector.
pub fn corner(angle: f64) -> impl ParametricSystem<Error = std::convert::Infallible> {
    let (s, c) = angle.sin_cos();
    let beyond = move |x: f64, p: f64| (1.0 + c) * x + s * p >= 0.0;
    piecewise(
        move |x, p| if beyond(x, p) { [-s * x + c * p, -s, c] } else { [p, 0.0, 1.0] },
        move |x, p| u64::from(beyond(x, p)),
    )
}

fn check_corner(branch: &Branch, settings: &Continuation, degrees: f64) {
    assert_sound(branch, settings);
    assert!(branch.points.len() < 100, "{} points at {degrees} degrees", branch.points.len());
    let changes = events(branch, |e| matches!(e, EventKind::PatternChange { from: 0, to: 1 }));
    assert_eq!(changes.len(), 1, "{degrees} degrees");
    assert!(changes[0].x[0].abs() < 1e-8 && changes[0].p.abs() < 1e-8, "{degrees}: {:?}", changes[0].z());
    assert_eq!(changes[0].events.contains(&EventKind::Kink), degrees > 21.0, "{degrees} degrees");
    assert!(events(branch, |e| *e == EventKind::BranchPoint).is_empty());
}

#[test]
fn corners_up_to_175_degrees_are_passed_located_and_named() {
    for degrees in [5.0, 15.0, 30.0, 90.0, 120.0, 150.0, 175.0_f64] {
        let (s, c) = degrees.to_radians().sin_cos();
        let settings = Continuation { max_points: 200, ..window(1, -1.0, 0.5 * s) };
        let branch = trace(&settings, corner(degrees.to_radians()), [-0.537, 0.0], [1.0, 0.0]);
        assert_eq!(branch.stop, StopReason::Bound { coordinate: 1, value: 0.5 * s }, "{degrees} degrees");
        assert!((branch.points.last().unwrap().x[0] - 0.5 * c).abs() < 1e-8);
        check_corner(&branch, &settings, degrees);
    }
}

#[test]
fn corners_are_passed_among_many_unknowns() {
    for degrees in [30.0, 90.0, 120.0, 150.0, 175.0_f64] {
        let (s, _) = degrees.to_radians().sin_cos();
        let mut system = Embedded(corner(degrees.to_radians()));
        let settings = Continuation { max_points: 200, ..window(4, -1.0, 0.5 * s) };
        let direction: Vec<f64> = Embedded::<()>::lift(1.0, 0.0).into_iter().chain([0.0]).collect();
        let start = Embedded::<()>::lift(-0.537, 0.0);
        let branch = settings.run(&mut system, &start, 0.0, &direction, |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(branch.stop, StopReason::Bound { coordinate: 4, value: 0.5 * s }, "{degrees} degrees");
        check_corner(&branch, &settings, degrees);
    }
}

#[test]
fn a_power_of_three_halves_is_no_obstacle() {
    let f = |x: f64, p: f64| [x - p.max(0.0).powf(1.5), 1.0, -1.5 * p.max(0.0).sqrt()];
    let settings = window(1, -1.0, 1.0);
    let branch = trace(&settings, piecewise(f, |_, p| u64::from(p > 0.0)), [0.0, -0.537], [0.0, 1.0]);
    assert_eq!(branch.stop, StopReason::Bound { coordinate: 1, value: 1.0 });
    assert_sound(&branch, &settings);
    let changes = events(&branch, |e| matches!(e, EventKind::PatternChange { .. }));
    assert!(changes.len() == 1 && changes[0].p.abs() < 1e-8);
}

/// `σ p = (x + p/2)₊^{3/2}`: comes along the x axis and, within some σ² of the origin, turns by 117 degrees.
#[test]
fn a_grazing_fold_is_passed() {
    for sigma in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
        let f = |x: f64, p: f64| {
            let depth = (x + 0.5 * p).max(0.0);
            [sigma * p - depth.powf(1.5), -1.5 * depth.sqrt(), sigma - 0.75 * depth.sqrt()]
        };
        let settings = Continuation { max_points: 400, ..window(1, -1.0, 0.5) };
        let branch = trace(&settings, piecewise(f, |x, p| u64::from(x + 0.5 * p > 0.0)), [-0.537, 0.0], [1.0, 0.0]);
        assert_eq!(branch.stop, StopReason::Bound { coordinate: 1, value: 0.5 }, "sigma {sigma}");
        assert!(branch.points.len() < 150, "{} points at sigma {sigma}", branch.points.len());
        let depth = (0.5 * sigma).powf(2.0 / 3.0);
        assert!((branch.points.last().unwrap().x[0] - depth + 0.25).abs() < 1e-6, "sigma {sigma}");
        let changes = events(&branch, |e| matches!(e, EventKind::PatternChange { .. }));
        assert_eq!(changes.len(), 1, "sigma {sigma}");
        assert!(changes[0].x[0].abs() < 1e-6 && changes[0].p.abs() < 1e-6);
    }
}

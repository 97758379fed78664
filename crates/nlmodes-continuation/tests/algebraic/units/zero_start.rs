//! Starts at which unknowns or parameter are zero, and with them the sizes that would tell their units.

use std::ops::ControlFlow;

use nlmodes_continuation::{Continuation, ContinuationError, EventKind, Scaling, StopReason};

use super::{InUnits, Sized, in_units};
use crate::samples::{events, smooth, trace, window};

/// Sizes of unknown, parameter and equation at a start whose direction is that of the parameter, but where the second
/// is given.
fn sizes(settings: &Continuation, f: impl Fn(f64, f64) -> [f64; 3], start: [f64; 2], along: [f64; 2]) -> [f64; 3] {
    let settings = Continuation { max_points: 1, ..settings.clone() };
    let Scaling { unknowns, equations } = trace(&settings, smooth(f), start, along).scales;
    [unknowns[0], unknowns[1], equations[0]]
}

#[test]
fn what_is_zero_at_the_start_has_the_size_by_which_it_moves() {
    let free = Continuation::default();
    let two = |k: i32| 2.0_f64.powi(k);
    // x = slope (p − p₀), whose equation has the larger of the size of x and the slope times that of p as its largest
    // derivative.
    for (slope, x, p, expected) in [
        (two(-20), 0.0, two(10), [two(-10), two(10)]),
        (-two(20), 0.0, two(10), [two(30), two(10)]),
        (two(30), two(12), 0.0, [two(12), two(-18)]),
        (two(-30), -two(-12), 0.0, [two(-12), two(18)]),
        (two(-12), 0.0, 0.0, [two(-12), 1.0]),
        (-two(12), 0.0, 0.0, [1.0, two(-12)]),
        // Both are given: nothing is asked of the tangent.
        (two(30), two(12), two(-9), [two(12), two(-9)]),
        // Numbers near one are left as they are.
        (0.25, 0.0, 16.0, [1.0, 1.0]),
        (64.0, 0.0, 1.0, [64.0, 1.0]),
        // What moves by less than 1e-10 may as well be rounding.
        (two(-50), 0.0, two(10), [1.0, two(10)]),
        (two(50), two(10), 0.0, [two(10), 1.0]),
        (two(-50), 0.0, 0.0, [1.0, 1.0]),
    ] {
        let line = move |at: f64, q: f64| [at - x - slope * (q - p), 1.0, -slope];
        let row = f64::max(expected[0], slope.abs() * expected[1]);
        assert_eq!(sizes(&free, line, [x, p], [0.0, 1.0]), [expected[0], expected[1], row / 4.0], "{slope:e} {x} {p}");
    }
    // A parameter that is bounded is no larger than its bounds.
    let line = |x: f64, p: f64| [x - two(12) - two(-30) * p, 1.0, -two(-30)];
    assert_eq!(sizes(&window(1, -two(6), two(8)), line, [two(12), 0.0], [0.0, 1.0]), [two(12), two(8), two(10)]);
}

#[test]
fn what_is_zero_at_the_start_has_the_size_one_where_the_tangent_does_not_tell_it() {
    let free = Continuation::default();
    let r = 4096.0;
    // At (r, 0) x does not move with p, at (0, r) p not with x.
    let circle = move |x: f64, p: f64| [x * x + p * p - r * r, 2.0 * x, 2.0 * p];
    assert_eq!(sizes(&free, circle, [r, 0.0], [0.0, 1.0]), [r, 1.0, 0.5 * r * r]);
    assert_eq!(sizes(&free, circle, [0.0, r], [1.0, 0.0]), [1.0, r, 0.5 * r * r]);
    // A fold at the origin, and a line along which the unknown rests.
    assert_eq!(sizes(&free, |x, p| [p - x * x, -2.0 * x, 1.0], [0.0, 0.0], [1.0, 0.0]), [1.0, 1.0, 0.25]);
    assert_eq!(
        sizes(&free, |x, p| [x * (1.0 + p * p), 1.0 + p * p, 2.0 * x * p], [0.0, 0.0], [0.0, 1.0]),
        [1.0, 1.0, 0.25]
    );
}

#[test]
fn a_curve_that_starts_where_one_of_both_is_zero_is_followed_alike_in_any_units() {
    // x = x₀ + s + s³ with s = p − p₀, on to s = 2.
    for [x0, p0] in [[0.0, 1.0], [1.0, 0.0]] {
        let cubic = move |x: f64, p: f64| {
            let s = p - p0;
            [x - x0 - s - s * s * s, 1.0, -1.0 - 3.0 * s * s]
        };
        let follow = |units| in_units(&window(1, -1.0, p0 + 2.0), cubic, units, [x0, p0], [1.0, 1.0]);
        let expected = follow([1.0; 3]);
        for [x, p, residual] in [[1e8, 1.0, 1e3], [1e-8, 1e3, 1.0], [1.0, 1e-7, 1e9]] {
            let branch = follow([x, p, residual]);
            let case = format!("from {x0} {p0} in {x} {p} {residual}");
            assert_eq!(branch.stop, StopReason::Bound { coordinate: 1, value: (p0 + 2.0) * p }, "{case}");
            assert!((branch.points.last().unwrap().x[0] / x - x0 - 10.0).abs() < 1e-9, "{case}");
            let (found, at_most) = (branch.evaluations, expected.evaluations + expected.evaluations / 4);
            assert!(found <= at_most, "{case}: {found} evaluations, {} in units of one", expected.evaluations);
        }
    }
}

/// `x = p + p³` from (0, 0) on to p = 2, where x = 10.
fn cubic_through_zero(x: f64, p: f64) -> [f64; 3] {
    [x - p - p * p * p, 1.0, -1.0 - 3.0 * p * p]
}

#[test]
fn a_curve_that_starts_where_all_is_zero_is_followed_to_its_bound_in_units_of_which_nothing_tells() {
    for units in [[1e-8, 1e3, 1.0], [1e-3, 1e9, 1e6], [1e3, 1e-8, 1e9]] {
        let settings = window(0, -1.0, 10.0);
        let branch = in_units(&settings, cubic_through_zero, units, [0.0, 0.0], [1.0, 1.0]);
        let [x, p, _] = units;
        assert_eq!(branch.stop, StopReason::Bound { coordinate: 0, value: 10.0 * x }, "{units:?}");
        assert!(branch.points.len() < 1000, "{units:?}: {} points", branch.points.len());
        for q in &branch.points {
            // Beside one unknowns and parameter are known to the tolerance, not beside themselves.
            let known = 1e-11 * (1.0 / x + (1.0 + 3.0 * (q.p / p).powi(2)) / p) + 1e-9;
            let off = q.x[0] / x - q.p / p - (q.p / p).powi(3);
            assert!(off.abs() < known, "{units:?}: {off:e} at {:e}", q.p);
        }
    }
}

/// `x (p/p_c − 1 − x²) = 0` without load: the unknown rests until the critical load, of which nothing tells.
#[test]
fn a_column_that_rests_without_load_is_followed_through_a_critical_load_of_thousands() {
    for critical in [1.0, 1e3] {
        let column = move |x: f64, p: f64| {
            let q = p / critical;
            [x * (q - 1.0 - x * x), q - 1.0 - 3.0 * x * x, x / critical]
        };
        let settings = window(1, -critical, 1.5 * critical);
        let branch = trace(&settings, smooth(column), [0.0, 0.0], [0.0, 1.0]);
        assert_eq!(branch.stop, StopReason::Bound { coordinate: 1, value: 1.5 * critical }, "{critical}");
        let crossings = events(&branch, |e| *e == EventKind::BranchPoint);
        assert_eq!(crossings.len(), 1, "{critical}");
        assert!((crossings[0].p / critical - 1.0).abs() < 1e-6, "{critical}: {}", crossings[0].p);
        assert!(branch.points.len() < 1000, "{critical}: {} points", branch.points.len());
    }
}

/// A shallow truss of two bars, `p = c (w³ − 3 w² + 2 w)`, from rest: folds at `w = 1 ± 1/√3`, `p = ± 2c/√27`. In MN,
/// kN, N, mN, and with heights in mm; sizes are powers of two, between which the units of the load fall somewhere.
#[test]
fn a_truss_from_rest_has_the_same_points_in_any_unit() {
    let truss = |w: f64, p: f64| [w * (w * w - 3.0 * w + 2.0) - p, 3.0 * w * w - 6.0 * w + 2.0, -1.0];
    let limit = 2.0 / 27.0_f64.sqrt();
    let follow = |units| in_units(&window(1, -1.0, 1.0), truss, units, [0.0, 0.0], [0.0, 1.0]);
    let expected = follow([1.0; 3]);
    for [w, p] in [[1.0, 1e3], [1.0, 1e6], [1.0, 1e9], [1e3, 1e6], [1e-6, 1.0]] {
        let branch = follow([w, p, p]);
        let case = format!("units {w} {p}: {} points, {} expected", branch.points.len(), expected.points.len());
        assert_eq!(branch.stop, StopReason::Bound { coordinate: 1, value: p }, "{case}");
        let folds: Vec<f64> =
            events(&branch, |e| *e == EventKind::ParameterFold).iter().map(|q| q.p / p / limit).collect();
        assert!(
            folds.len() == 2 && (folds[0] - 1.0).abs() < 1e-9 && (folds[1] + 1.0).abs() < 1e-9,
            "{case}: {folds:?}"
        );
        assert!((branch.points.last().unwrap().x[0] / w - 2.324_717_957_2).abs() < 1e-9, "{case}");
        // The load moves its size by less than a tenth against that of the height, a height its own by half at most.
        let most = expected.points.len() / if w == 1.0 { 10 } else { 2 };
        assert!(branch.points.len().abs_diff(expected.points.len()) <= most, "{case}");
    }
    for p in [1024.0, 1_048_576.0] {
        let branch = follow([1.0, p, p]);
        let points = |branch: &nlmodes_continuation::Branch, p: f64| {
            branch.points.iter().map(|q| (q.x[0], q.p / p)).collect::<Vec<_>>()
        };
        assert_eq!(points(&branch, p), points(&expected, 1.0), "where the unit is a power of two, bit for bit");
    }
}

#[test]
fn a_curve_that_starts_where_all_is_zero_is_the_same_in_any_units_where_these_are_given() {
    let expected = in_units(&window(0, -1.0, 10.0), cubic_through_zero, [1.0; 3], [0.0, 0.0], [1.0, 1.0]);
    for [x, p, residual] in [[1e-8, 1e3, 1.0], [1e6, 1e6, 1.0], [1e-6, 1e-6, 1e3]] {
        let inner = smooth(cubic_through_zero as fn(f64, f64) -> [f64; 3]);
        let sizes = Scaling { unknowns: vec![x, p], equations: vec![residual] };
        let system = Sized(InUnits { inner, x, p, residual }, sizes);
        let branch = trace(&window(0, -x, 10.0 * x), system, [0.0, 0.0], [x, p]);
        assert_eq!(branch.stop, StopReason::Bound { coordinate: 0, value: 10.0 * x }, "{x} {p}");
        for q in &branch.points {
            let off = q.x[0] / x - q.p / p - (q.p / p).powi(3);
            assert!(off.abs() < 1e-10, "{x} {p}: {off:e} at {:e}", q.p);
        }
        // The steps of given sizes do not grow.
        let (found, at_most) = (branch.evaluations, 5 * expected.evaluations / 2);
        assert!(found <= at_most, "{x} {p}: {found} evaluations, {} in units of one", expected.evaluations);
    }
}

#[test]
fn a_start_at_which_no_derivative_is_known_is_refused_as_a_start() {
    for f in [|x: f64, p: f64| [x * x - p * p, 2.0 * x, -2.0 * p], |_, _| [1.0, 0.0, 0.0]] {
        let found =
            Continuation::default().run(&mut smooth(f), &[0.0], 0.0, &[1.0, 1.0], |_| ControlFlow::Continue(()));
        assert!(matches!(found, Err(ContinuationError::Start(_))), "{found:?}");
    }
}

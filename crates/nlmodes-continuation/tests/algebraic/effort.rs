//! What branches cost: evaluations, points and refused steps, summed over many starts.
//!
//! Numbers that steer a continuation hardly show in its points, which Newton's method corrects, but they show here. The
//! table is what was measured, not what must be: where a change of the steps moves it, look whether it moved the way
//! that was meant, and write down what is measured then.

use std::ops::ControlFlow;

use nlmodes_continuation::{Branch, Continuation, ParametricSystem, StepSettings};

use crate::bends::Stop;
use crate::corners::corner;
use crate::onsets::Stops;
use crate::samples::{Embedded, piecewise, smooth, trace, window};
use crate::several::{Modes, Square};
use crate::three_free::{six_lines, spatial};
use crate::units::InUnits;

/// Another processor rounds otherwise, which may cost an evaluation here and there.
const ALLOWED: f64 = 0.003;

const STARTS: u32 = 20;

/// Evaluations, points and refused steps of each.
const KNOWN: [(&str, [usize; 3]); 24] = [
    ("circle", [7936, 1420, 0]),
    ("circle in units", [24054, 8920, 184]),
    ("circle, watched and bounded", [2441, 687, 0]),
    ("transcritical", [1071, 491, 0]),
    ("two folds", [1962, 467, 0]),
    ("two folds, long steps", [3547, 777, 75]),
    ("two circles", [9188, 1460, 0]),
    ("figure eight", [9893, 1765, 74]),
    ("bound between zero and the branch", [782, 284, 0]),
    ("cusp", [76463, 1200, 504]),
    ("kink", [44955, 1260, 404]),
    ("kink among many unknowns", [45233, 1493, 390]),
    ("corner", [49847, 766, 405]),
    ("grazing fold", [9739, 1000, 315]),
    ("tighter grazing fold", [26328, 686, 405]),
    ("bend", [25492, 675, 398]),
    ("tighter bend", [22869, 675, 398]),
    ("one free direction", [928, 308, 0]),
    ("two free directions", [14074, 552, 46]),
    ("three branch points", [2134, 390, 22]),
    ("square", [16271, 795, 46]),
    ("two stops at once", [28488, 877, 377]),
    ("three stops at once", [22632, 946, 410]),
    ("six lines in space", [20773, 635, 0]),
];

/// Evaluations, points and refused steps of several branches.
fn sums(branches: impl IntoIterator<Item = Branch>) -> [usize; 3] {
    branches.into_iter().fold([0; 3], |[e, p, r], b| [e + b.evaluations, p + b.points.len(), r + b.refused_steps])
}

fn starts(branch: impl Fn(f64) -> Branch) -> [usize; 3] {
    sums((0..STARTS).map(|k| branch(0.0137 * f64::from(k))))
}

fn run<S: ParametricSystem>(settings: &Continuation, mut system: S, z: &[f64], along: &[f64]) -> Branch
where
    S::Error: std::fmt::Debug,
{
    let (p, x) = z.split_last().unwrap();
    settings.run(&mut system, x, *p, along, |_| ControlFlow::Continue(())).unwrap()
}

fn circle(x: f64, p: f64) -> [f64; 3] {
    [x * x + p * p - 1.0, 2.0 * x, 2.0 * p]
}

fn sine(x: f64, p: f64) -> [f64; 3] {
    [x - p.sin(), 1.0, -p.cos()]
}

fn transcritical(x: f64, p: f64) -> [f64; 3] {
    [x * (x - p), 2.0 * x - p, -x]
}

/// `p = x (x² − 0.03)`: two folds close together, passed in either direction.
fn hysteresis(x: f64, p: f64) -> [f64; 3] {
    [x * (x * x - 0.03) - p, 3.0 * x * x - 0.03, -1.0]
}

/// Two circles that meet at right angles, and a figure eight.
fn circles(x: f64, p: f64) -> [f64; 3] {
    let (a, b) = (x * x + p * p - 1.0, (x - 1.0) * (x - 1.0) + p * p - 1.0);
    [a * b, 2.0 * x * b + 2.0 * (x - 1.0) * a, 2.0 * p * (a + b)]
}

fn kinked(x: f64, p: f64) -> [f64; 3] {
    [x - 2.0 * p.abs(), 1.0, -2.0 * p.signum()]
}

/// `x = p³` up to the tip, where both branches of `(x − 1)² = (1 − p)³` meet.
fn cusp(x: f64, p: f64) -> [f64; 3] {
    [(x - 1.0).powi(2) - (1.0 - p).powi(3), 2.0 * (x - 1.0), 3.0 * (1.0 - p).powi(2)]
}

fn grazing(sigma: f64) -> impl ParametricSystem<Error = std::convert::Infallible> {
    let f = move |x: f64, p: f64| {
        let depth = (x + 0.5 * p).max(0.0);
        [sigma * p - depth * depth.sqrt(), -1.5 * depth.sqrt(), sigma - 0.75 * depth.sqrt()]
    };
    piecewise(f, |x, p| u64::from(x + 0.5 * p > 0.0))
}

fn modes(at: &[f64], off: f64) -> Branch {
    let n = at.len();
    let mut z = vec![0.0; n + 1];
    let mut along = z.clone();
    (z[n], along[n]) = (-0.2 - off, 1.0);
    run(&window(n, -1.0, 0.5), Modes { at: at.to_vec(), g: 0.3 + off }, &z, &along)
}

fn stops(count: usize, stiffness: f64, off: f64) -> Branch {
    let from = 0.31 + off;
    let x: Vec<f64> = crate::onsets::open(count).iter().map(|x| x * from).collect();
    let z: Vec<f64> = x.iter().copied().chain([from]).collect();
    let along: Vec<f64> = z.iter().map(|v| -v).collect();
    let settings = Continuation { max_points: 400, ..window(count, -0.5, 0.6) };
    run(&settings, Stops::new(count, stiffness, [1.0; 2]), &z, &along)
}

fn square(off: f64) -> Branch {
    let m = 4;
    let mut z = vec![0.0; m * m + 1];
    let mut along = z.clone();
    (z[m * m], along[m * m]) = (0.3 + off, 1.0);
    run(&window(m * m, 0.0, 2.4), Square { m }, &z, &along)
}

#[test]
fn branches_cost_what_they_did() {
    let found: Vec<(&str, [usize; 3])> =
        planar().into_iter().chain(with_pieces()).chain(with_more_unknowns()).collect();
    let is_known = |(name, sums): &&(&str, [usize; 3])| {
        let near = |f: usize, k: usize| f.abs_diff(k) as f64 <= ALLOWED * k as f64;
        KNOWN.iter().any(|(known, numbers)| known == name && (0..3).all(|i| near(sums[i], numbers[i])))
    };
    let others: Vec<String> = found.iter().filter(|row| !is_known(row)).map(|row| format!("    {row:?},")).collect();
    assert!(others.is_empty(), "evaluations, points, refused steps:\n{}", others.join("\n"));
}

fn planar() -> Vec<(&'static str, [usize; 3])> {
    let eight = |x: f64, p: f64| [x.powi(4) - x * x + p * p, 4.0 * x.powi(3) - 2.0 * x, 2.0 * p];
    let everywhere = Continuation::default();
    let watched = Continuation { watched: vec![0], ..window(1, -0.9, 0.95) };
    let coarse = Continuation { step: StepSettings { max: 1.0, ..StepSettings::default() }, ..window(1, -7.0, 5.0) };
    let cut = Continuation { max_points: 60, ..window(1, -2.0, 2.0) };
    let on_hysteresis = |settings: &Continuation, x: f64| {
        trace(settings, smooth(hysteresis), [x, hysteresis(x, 0.0)[0]], [1.0, 3.0 * x * x - 0.03])
    };
    vec![
        (
            "circle",
            starts(|a| {
                let (p, x) = (4.0 * a).sin_cos();
                trace(&everywhere, smooth(circle), [x, p], [-p, x])
            }),
        ),
        (
            "circle in units",
            starts(|a| {
                let ((p, x), inner) = ((4.0 * a).sin_cos(), smooth(circle));
                let system = InUnits { inner, x: 1e-3, p: 50.0, residual: 1e4 };
                trace(&everywhere, system, [1e-3 * x, 50.0 * p], [-1e-3 * p, 50.0 * x])
            }),
        ),
        (
            "circle, watched and bounded",
            starts(|a| {
                let (p, x) = (-a).sin_cos();
                trace(&watched, smooth(circle), [x, p], [-p, x])
            }),
        ),
        (
            "transcritical",
            starts(|a| trace(&window(1, -1.0, 1.0), smooth(transcritical), [0.0, -0.613 - a], [0.0, 1.0])),
        ),
        ("two folds", starts(|a| on_hysteresis(&window(1, -1.0, 0.3), -0.5 - a))),
        ("two folds, long steps", starts(|a| on_hysteresis(&coarse, -1.5 - a))),
        (
            "two circles",
            starts(|a| {
                let (p, x) = (a - 3.0).sin_cos();
                trace(&everywhere, smooth(circles), [x, p], [-p, x])
            }),
        ),
        (
            "figure eight",
            starts(|a| {
                let x = 1.0 - a;
                trace(&everywhere, smooth(eight), [x, x * (1.0 - x * x).sqrt()], [-x, 1.0])
            }),
        ),
        (
            "bound between zero and the branch",
            starts(|a| trace(&window(1, 0.3, 9.0), smooth(sine), [f64::sin(0.8 + a), 0.8 + a], [0.0, -1.0])),
        ),
        ("cusp", starts(|a| trace(&cut, smooth(cusp), [1.0 + (0.9 - a).powi(3).sqrt(), 0.1 + a], [-1.0, 1.0]))),
    ]
}

fn with_pieces() -> Vec<(&'static str, [usize; 3])> {
    let patience = Continuation { max_points: 400, ..window(1, -1.0, 0.5) };
    let stop = |stiffness: f64, off: f64| {
        let p = -0.463 + off;
        let system = Stop { stiffness, units: [1.0; 2], beyond: false };
        run(&window(1, -0.6, 0.6), system, &[1.0 + p, p], &[1.0, 1.0])
    };
    let two_pieces = || piecewise(kinked, |_, p| u64::from(p > 0.0));
    let lifted = |x: f64, p: f64| Embedded::<()>::lift(x, p).into_iter().chain([p]).collect::<Vec<f64>>();
    vec![
        ("kink", starts(|a| trace(&window(1, -1.0, 1.0), two_pieces(), [1.4 + 2.0 * a, -0.7 - a], [-2.0, 1.0]))),
        (
            "kink among many unknowns",
            starts(|a| {
                run(&window(4, -1.0, 1.0), Embedded(two_pieces()), &lifted(1.4 + 2.0 * a, -0.7 - a), &lifted(-2.0, 1.0))
            }),
        ),
        ("corner", starts(|a| trace(&patience, corner(2.6), [-0.5 - a, 0.0], [1.0, 0.0]))),
        ("grazing fold", starts(|a| trace(&patience, grazing(1e-2), [-0.5 - a, 0.0], [1.0, 0.0]))),
        ("tighter grazing fold", starts(|a| trace(&patience, grazing(1e-4), [-0.5 - a, 0.0], [1.0, 0.0]))),
        ("bend", starts(|a| stop(1e4, a))),
        ("tighter bend", starts(|a| stop(1e6, a))),
    ]
}

fn with_more_unknowns() -> Vec<(&'static str, [usize; 3])> {
    vec![
        ("one free direction", starts(|a| modes(&[0.0], a))),
        ("two free directions", starts(|a| modes(&[0.0, 0.0], a))),
        ("three branch points", starts(|a| modes(&[0.0, 0.01, 0.3], a))),
        ("square", starts(square)),
        ("two stops at once", starts(|a| stops(2, 1e5, a))),
        ("three stops at once", starts(|a| stops(3, 3e6, a))),
        (
            "six lines in space",
            starts(|a| {
                run(&window(2, -1.0, 1.0), spatial(six_lines), &[-0.613 - a, 0.0, -0.613 - a], &[1.0, 0.0, 1.0])
            }),
        ),
    ]
}

//! Branches from every half-branch of a crossing, each once.

use std::ops::ControlFlow;

use nlmodes_continuation::{AtBranchPoint, BranchTree, Continuation, Origin, ParametricSystem, StopReason};

use crate::samples::{Embedded, assert_sound, piecewise, smooth, trace, window};

/// Two circles of radius 1 around 0 and 1.
fn circles(x: f64, p: f64) -> [f64; 3] {
    let (a, b) = (x * x + p * p - 1.0, (x - 1.0) * (x - 1.0) + p * p - 1.0);
    [a * b, 2.0 * x * b + 2.0 * (x - 1.0) * a, 2.0 * p * (a + b)]
}

fn tree<S: ParametricSystem>(settings: &Continuation, mut system: S, from: [f64; 2], along: [f64; 2]) -> BranchTree {
    let mut seen = Vec::new();
    let tree = settings
        .run_tree(&mut system, &from[..1], from[1], &along, 20, |branch, point| {
            seen.resize(seen.len().max(branch + 1), 0);
            seen[branch] += 1;
            assert!(point.residual < 1e-10);
            ControlFlow::Continue(())
        })
        .unwrap();
    assert_eq!(seen, tree.branches.iter().map(|b| b.branch.points.len()).collect::<Vec<_>>());
    tree.branches.iter().for_each(|b| assert_sound(&b.branch, settings));
    tree
}

/// Ends of the branches of a tree, as `(x, p)`, and that each one follows its origin.
fn ends(tree: &BranchTree) -> Vec<[f64; 2]> {
    for (number, b) in tree.branches.iter().enumerate() {
        assert_eq!(b.origin.is_none(), number == 0);
        assert!(b.origin.is_none_or(|o| o.branch < number));
    }
    tree.branches.iter().filter_map(|b| b.branch.points.last()).map(|q| [q.x[0], q.p]).collect()
}

fn assert_among(found: &[[f64; 2]], expected: &[[f64; 2]]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for e in expected {
        assert!(found.iter().any(|f| (f[0] - e[0]).hypot(f[1] - e[1]) < 1e-8), "{e:?} is not among {found:?}");
    }
}

#[test]
fn both_lines_of_a_transcritical_point_are_followed_both_ways() {
    let settings = window(1, -1.0, 1.0);
    let found = tree(&settings, smooth(|x, p| [x * (x - p), 2.0 * x - p, -x]), [0.0, -0.613], [0.0, 1.0]);
    assert_among(&ends(&found), &[[0.0, 1.0], [1.0, 1.0], [-1.0, -1.0]]);
    assert_eq!(found.not_followed, 0);
    let crossing = &found.branches[0].branch.crossings[0];
    assert_eq!(crossing.arms.iter().filter(|a| a.followed).count(), 1);
    assert_eq!(crossing.arms.len(), 3);
    assert!(found.branches[1..].iter().all(|b| b.origin == Some(Origin { branch: 0, crossing: 0 })));
    assert!(found.branches[1..].iter().all(|b| b.branch.points[0].z().iter().all(|z| z.abs() < 2e-5)));
}

#[test]
fn both_prongs_of_a_pitchfork_are_followed() {
    let f = |x: f64, p: f64| [x * (p - x * x), p - 3.0 * x * x, x];
    let found = tree(&window(1, -1.0, 0.9), smooth(f), [0.0, -0.613], [0.0, 1.0]);
    let prong = 0.9_f64.sqrt();
    assert_among(&ends(&found), &[[0.0, 0.9], [prong, 0.9], [-prong, 0.9]]);

    let mut system = Embedded(smooth(f));
    let direction: Vec<f64> = Embedded::<()>::lift(0.0, 1.0).into_iter().chain([1.0]).collect();
    let start = Embedded::<()>::lift(0.0, -0.613);
    let among_many = window(4, -1.0, 0.9)
        .run_tree(&mut system, &start, -0.613, &direction, 20, |_, _| ControlFlow::Continue(()))
        .unwrap();
    assert_among(&ends(&among_many), &[[0.0, 0.9], [prong, 0.9], [-prong, 0.9]]);
}

#[test]
fn a_corner_that_crosses_a_line_has_two_arms_to_follow() {
    // x = 0 and x = |p|.
    let f = |x: f64, p: f64| [x * (x - p.abs()), 2.0 * x - p.abs(), -x * p.signum()];
    let found = tree(&window(1, -1.0, 1.0), piecewise(f, |_, p| u64::from(p > 0.0)), [0.0, -0.613], [0.0, 1.0]);
    assert_among(&ends(&found), &[[0.0, 1.0], [1.0, 1.0], [1.0, -1.0]]);
}

#[test]
fn of_two_circles_each_is_followed_once() {
    let found = tree(&Continuation::default(), smooth(circles), [-1.0, 0.0], [0.0, 1.0]);
    assert_eq!(found.branches.len(), 2);
    assert_eq!(found.branches[0].branch.stop, StopReason::Closed);
    assert_eq!(found.branches[1].branch.stop, StopReason::Joined);
    let second = &found.branches[1].branch.points;
    assert!(second.iter().all(|q| ((q.x[0] - 1.0).powi(2) + q.p * q.p - 1.0).abs() < 1e-8));
    assert!([-1.0, 1.0].iter().all(|p| second.iter().any(|q| (q.p - p).abs() < 0.01)));
    assert_eq!(found.not_followed, 0);
}

#[test]
fn a_figure_eight_is_one_branch() {
    let f = |x: f64, p: f64| [x.powi(4) - x * x + p * p, 4.0 * x.powi(3) - 2.0 * x, 2.0 * p];
    let found = tree(&Continuation::default(), smooth(f), [1.0, 0.0], [0.0, 1.0]);
    assert_eq!(found.branches.len(), 1);
    assert_eq!((found.branches[0].branch.crossings.len(), found.not_followed), (2, 0));
}

#[test]
fn what_is_not_followed_is_counted() {
    let settings = window(1, -1.0, 1.0);
    let mut system = smooth(|x, p| [x * (x - p), 2.0 * x - p, -x]);
    let found = settings.run_tree(&mut system, &[0.0], -0.613, &[0.0, 1.0], 2, |_, _| ControlFlow::Continue(()));
    let found = found.unwrap();
    assert_eq!((found.branches.len(), found.not_followed), (2, 1));
    let found = settings.run_tree(&mut system, &[0.0], -0.613, &[0.0, 1.0], 9, |_, _| ControlFlow::Break(())).unwrap();
    assert_eq!((found.branches.len(), found.branches[0].branch.points.len()), (1, 1));
}

#[test]
fn a_branch_that_switches_takes_the_arm_along_which_the_parameter_grows_most() {
    let settings = Continuation { at_branch_point: AtBranchPoint::Switch, ..window(1, -1.0, 1.0) };
    let lines = smooth(|x, p| [x * (x - p), 2.0 * x - p, -x]);
    let branch = trace(&settings, lines, [0.0, -0.613], [0.0, 1.0]);
    assert_sound(&branch, &settings);
    let last = branch.points.last().unwrap();
    assert!((last.x[0] - 1.0).abs() < 1e-8 && (last.p - 1.0).abs() < 1e-8);
    assert!(branch.points.iter().all(|q| q.x[0].abs() < 1e-8 || (q.x[0] - q.p).abs() < 1e-8));
    let crossing = &branch.crossings[0];
    assert!(branch.points[crossing.point].p.abs() < 1e-8);
    assert!(crossing.arms.iter().any(|a| a.followed && a.start.tangent[0] > 0.5));

    // From the first circle onto the second, and back at their other crossing.
    let settings = Continuation { at_branch_point: AtBranchPoint::Switch, ..Continuation::default() };
    let branch = trace(&settings, smooth(circles), [-1.0, 0.0], [0.0, 1.0]);
    assert!(branch.crossings.len() >= 2);
    let second = |q: &&nlmodes_continuation::BranchPoint| ((q.x[0] - 1.0).powi(2) + q.p * q.p - 1.0).abs() < 1e-8;
    assert!(branch.points.iter().filter(second).count() > 10);
}

//! What was seen is reported, also where it cannot be located, and no bound is passed.

use std::convert::Infallible;
use std::ops::ControlFlow;

use nlmodes_continuation::{
    AtBranchPoint, Bound, Continuation, EventKind, Linearization, ParametricSystem, StopReason,
};

use crate::samples::{events, piecewise, smooth, trace, window};
use crate::several::Modes;

fn circle(x: f64, p: f64) -> [f64; 3] {
    [x * x + p * p - 1.0, 2.0 * x, 2.0 * p]
}

#[test]
fn a_fold_beside_which_no_point_is_found_is_told_at_the_nearest_one() {
    for start in 0..100 {
        let (x, p) = (0.0612 * f64::from(start) - 0.01).sin_cos();
        // There is no residual around both folds.
        let f = |x: f64, p: f64| if (p.abs() - 1.0).abs() < 1e-10 { [f64::NAN; 3] } else { circle(x, p) };
        let branch = trace(&Continuation::default(), smooth(f), [x, p], [-p, x]);
        assert_eq!(branch.stop, StopReason::Closed, "from {x}, {p}");
        let folds = events(&branch, |e| *e == EventKind::ParameterFold);
        assert_eq!(folds.len(), 2, "from {x}, {p}");
        assert!(folds.iter().all(|q| q.p.abs() > 1.0 - 1e-6), "from {x}, {p}");
    }
}

#[test]
fn a_bound_on_which_no_point_is_found_is_not_passed() {
    for width in [1e-9, 1e-6, 1e-4, 1e-2] {
        let f = |x: f64, p: f64| if (p - 0.5).abs() < width { [f64::NAN; 3] } else { [x - p, 1.0, -1.0] };
        let branch = trace(&window(1, -1.0, 0.5), smooth(f), [0.0, 0.0], [1.0, 1.0]);
        assert!(branch.points.iter().all(|q| q.p <= 0.5), "{width}: {:?}", branch.points.last());
        assert!(matches!(branch.stop, StopReason::StepTooSmall { .. }), "{width}: {:?}", branch.stop);
        assert!(branch.points.last().unwrap().p > 0.5 - 2.0 * width - 1e-5, "{width}: {:?}", branch.points.last());
    }
}

#[test]
fn a_bound_that_a_curve_passes_between_two_points_ends_it() {
    for bound in [0.999, 0.9999, 0.999_99] {
        for start in 0..100 {
            let (p, x) = (-0.011 * f64::from(start)).sin_cos();
            let branch = trace(&window(1, -2.0, bound), smooth(circle), [x, p], [-p, x]);
            assert_eq!(branch.stop, StopReason::Bound { coordinate: 1, value: bound }, "from {x}, {p}");
            let last = branch.points.last().unwrap();
            assert!((last.p - bound).abs() < 1e-12 && last.x[0] > 0.0, "{:?}", last.z());
            assert!((last.x[0] - (1.0 - bound * bound).sqrt()).abs() < 1e-9, "{:?}", last.z());
        }
    }
}

#[test]
fn a_bound_is_not_passed_behind_a_corner() {
    // The parameter turns back at once where the curve has just turned at x = 0: the bound is half a shortest step
    // beyond.
    let f = |x: f64, p: f64| [p + 3.0 * x.abs(), 3.0 * x.signum(), 1.0];
    for beyond in [5e-7, 5e-6, 1e-4] {
        let bounds = vec![Bound { coordinate: 0, min: -1.0, max: beyond }];
        let settings = Continuation { bounds, ..Continuation::default() };
        let branch = trace(&settings, piecewise(f, |x, _| u64::from(x >= 0.0)), [-0.3, -0.9], [1.0, 3.0]);
        assert!(branch.points.iter().all(|q| q.x[0] <= beyond), "{beyond}: {:?}", branch.points.last());
        assert_eq!(branch.stop, StopReason::Bound { coordinate: 0, value: beyond });
    }
}

#[test]
fn a_parameter_that_turns_at_a_corner_has_a_fold_there() {
    for slope in [1.0, 0.3, 3.0] {
        let f = |x: f64, p: f64| [p + slope * x.abs(), slope * x.signum(), 1.0];
        let settings = window(0, -1.0, 1.0);
        let system = piecewise(f, |x, _| u64::from(x >= 0.0));
        let branch = trace(&settings, system, [-0.5, -0.5 * slope], [1.0, slope]);
        assert_eq!(branch.stop, StopReason::Bound { coordinate: 0, value: 1.0 });
        let folds = events(&branch, |e| *e == EventKind::ParameterFold);
        assert_eq!(folds.len(), 1, "slope {slope}");
        assert!(folds[0].x[0].abs() < 1e-6 && folds[0].p.abs() < 1e-5, "{:?}", folds[0].z());
    }
}

#[test]
fn changes_of_the_piece_form_a_chain_however_many_a_step_passes() {
    let steps = piecewise(|x, p| [x - p, 1.0, -1.0], |_, p| ((p + 1.0) * 700.0) as u64);
    let branch = trace(&window(1, -1.0, 0.5), steps, [0.0, 0.0], [1.0, 1.0]);
    let mut piece = branch.points[0].pattern;
    for event in branch.points.iter().flat_map(|q| &q.events) {
        if let EventKind::PatternChange { from, to } = event {
            assert_eq!(*from, piece);
            piece = *to;
        }
    }
    assert_eq!(piece, branch.points.last().unwrap().pattern);
}

/// `x = −(y − y₀)²` and `p = −y²`: the watched x turns at y₀, the parameter at zero.
struct TwoTurns {
    y0: f64,
}

impl ParametricSystem for TwoTurns {
    type Error = Infallible;

    fn dim(&self) -> usize {
        2
    }

    fn linearize(&mut self, z: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        let [x, y] = [z[0], z[1]];
        out.residual.copy_from_slice(&[x + (y - self.y0).powi(2), p + y * y]);
        for (i, row) in [[1.0, 2.0 * (y - self.y0), 0.0], [0.0, 2.0 * y, 1.0]].iter().enumerate() {
            (0..3).for_each(|j| out.jacobian[(i, j)] = row[j]);
        }
        Ok(())
    }
}

#[test]
fn what_turns_at_one_place_is_told_at_one_point_and_what_does_not_at_its_own() {
    let settings = Continuation { watched: vec![0], ..window(1, -1.0, 1.0) };
    let both = [EventKind::UnknownFold { index: 0 }, EventKind::ParameterFold];
    for start in 0..20 {
        for y0 in [0.0, 1e-3, -0.02] {
            let y = -0.71 - 0.0123 * f64::from(start);
            let (x, p) = (-(y - y0) * (y - y0), -y * y);
            let run = settings.run(&mut TwoTurns { y0 }, &[x, y], p, &[0.0, 1.0, 0.0], |_| ControlFlow::Continue(()));
            let branch = run.unwrap();
            let turns = events(&branch, |e| both.contains(e));
            assert_eq!(turns.len(), if y0 == 0.0 { 1 } else { 2 }, "{y0} from {y}");
            for (event, at) in both.iter().zip([y0, 0.0]) {
                let own: Vec<f64> = turns.iter().filter(|q| q.events.contains(event)).map(|q| q.x[1]).collect();
                assert!(own.len() == 1 && (own[0] - at).abs() < 1e-7, "{event:?} from {y}: {own:?}");
            }
        }
    }
}

/// Where the pieces change all derivatives are small, and so they are around.
#[test]
fn derivatives_that_are_small_all_around_a_change_of_pieces_start_no_search_for_arms() {
    let follow = |least: f64, x: f64| {
        let line = |x: f64, p: f64| {
            let (off, factor) = (p - 0.5 * x, least * least + x * x);
            [off * factor, 2.0 * x * off - 0.5 * factor, factor]
        };
        trace(&window(0, -1.0, 1.0), piecewise(line, |x, _| u64::from(x >= 0.0)), [x, 0.5 * x], [1.0, 0.5])
    };
    for start in 0..20 {
        let x = -0.5 - 0.0123 * f64::from(start);
        let plain = follow(1.0, x).evaluations;
        for least in [1e-4, 1e-3, 1e-2] {
            let branch = follow(least, x);
            assert!(branch.crossings.is_empty());
            let found = branch.evaluations;
            assert!(found < 2 * plain, "{least} from {x}: {found} evaluations, {plain} with larger derivatives");
        }
    }
}

/// Of a curve that does not notice that its pieces change: no more is asked than where.
#[test]
fn a_change_of_pieces_on_a_smooth_curve_starts_no_search_for_arms() {
    let curve = |x: f64, p: f64| [p - 0.5 * x - 0.1 * x * x, -0.5 - 0.2 * x, 1.0];
    let settings = window(0, -1.0, 1.0);
    for start in 0..20 {
        let x = -0.5 - 0.0123 * f64::from(start);
        let (from, along) = ([x, 0.5 * x + 0.1 * x * x], [1.0, 0.5]);
        let plain = trace(&settings, smooth(curve), from, along);
        let branch = trace(&settings, piecewise(curve, |x, _| u64::from(x >= 0.0)), from, along);
        assert_eq!(events(&branch, |e| *e == EventKind::PatternChange { from: 0, to: 1 }).len(), 1);
        // A step of 0.1 is halved thirty times until it is as short as the place is known.
        let (found, at_most) = (branch.evaluations, plain.evaluations + 100);
        assert!(found <= at_most, "from {x}: {found} evaluations, {} without pieces", plain.evaluations);
    }
}

#[test]
fn a_bound_behind_a_corner_is_met_where_the_corner_is_not_at_zero() {
    for [at, scale] in [[5.0, 1.0], [-3.0, 1.0], [5e3, 1e3]] {
        let f = |x: f64, p: f64| [p + 3.0 * (x - at).abs(), 3.0 * (x - at).signum(), 1.0];
        for beyond in [5e-7 * scale, 1e-4 * scale] {
            let bounds = vec![Bound { coordinate: 0, min: at - scale, max: at + beyond }];
            let settings = Continuation { bounds, ..Continuation::default() };
            let system = piecewise(f, |x, _| u64::from(x >= at));
            let branch = trace(&settings, system, [at - 0.3 * scale, -0.9 * scale], [1.0, 3.0]);
            assert_eq!(branch.stop, StopReason::Bound { coordinate: 0, value: at + beyond }, "{at} {beyond}");
            let last = branch.points.last().unwrap();
            assert!((last.p + 3.0 * beyond).abs() < 1e-9 * scale, "{:?}", last.z());
        }
    }
}

/// `x (p + x²) = 0`: on the half-branch to which the branch changes the parameter goes back.
#[test]
fn a_branch_that_leaves_by_an_arm_on_which_the_parameter_turns_has_a_fold_at_the_crossing() {
    let f = |x: f64, p: f64| [x * (p + x * x), p + 3.0 * x * x, x];
    for from in [-0.5, -0.31, -0.177] {
        let settings = Continuation { at_branch_point: AtBranchPoint::Switch, ..window(1, -1.0, 1.0) };
        let branch = trace(&settings, smooth(f), [0.0, from], [0.0, 1.0]);
        let crossings = events(&branch, |e| *e == EventKind::BranchPoint);
        assert_eq!(crossings.len(), 1, "from {from}");
        assert!(crossings[0].events.contains(&EventKind::ParameterFold), "{:?}", crossings[0].events);
        assert!(branch.points.last().unwrap().x[0].abs() > 0.9, "{:?}", branch.points.last().unwrap().z());
    }
}

/// A system that counts how often it is asked.
struct Counted<S> {
    inner: S,
    asked: usize,
}

impl<S: ParametricSystem> ParametricSystem for Counted<S> {
    type Error = S::Error;

    fn dim(&self) -> usize {
        self.inner.dim()
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), S::Error> {
        self.asked += 1;
        self.inner.linearize(x, p, out)
    }
}

#[test]
fn the_evaluations_that_are_told_are_those_that_were_made() {
    for n in 1..=3 {
        let mut system = Counted { inner: Modes { at: vec![0.0; n], g: 0.4 }, asked: 0 };
        let mut direction = vec![0.0; n + 1];
        direction[n] = 1.0;
        let settings = window(n, -1.0, 0.5);
        let branch = settings.run(&mut system, &vec![0.0; n], -0.2, &direction, |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(branch.evaluations, system.asked, "{n} unknowns");
    }
}

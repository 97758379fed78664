//! Branches that begin with a tight bend, where something stiff sets in.

use std::convert::Infallible;
use std::ops::ControlFlow;

use nlmodes_continuation::{Boundary, Continuation, EventKind, Linearization, ParametricSystem, Scaling};

use crate::samples::{events, window};

/// `ξ − π − k ξ₊^{3/2} = 0` with `ξ = x/a − 1` and `π = p/b`: from (a, 0) the parameter rises with the unknown as far
/// as `ξ = (2/3k)²`, and falls from there on, while the unknown hardly moves.
pub struct Stop {
    pub stiffness: f64,
    pub units: [f64; 2],
    pub beyond: bool,
}

impl Stop {
    /// Unknown and parameter where the parameter turns.
    fn fold(&self) -> [f64; 2] {
        let depth = (2.0 / (3.0 * self.stiffness)).powi(2);
        [self.units[0] * (1.0 + depth), self.units[1] * depth / 3.0]
    }
}

impl ParametricSystem for Stop {
    type Error = Infallible;

    fn dim(&self) -> usize {
        1
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        let [a, b] = self.units;
        let (depth, k) = (x[0] / a - 1.0, self.stiffness);
        self.beyond = depth > 0.0;
        out.residual[0] = depth - p / b - k * depth.max(0.0).powf(1.5);
        out.jacobian[(0, 0)] = (1.0 - 1.5 * k * depth.max(0.0).sqrt()) / a;
        out.jacobian[(0, 1)] = -1.0 / b;
        Ok(())
    }

    fn scaling(&self) -> Option<Scaling> {
        Some(Scaling { unknowns: self.units.to_vec(), equations: vec![1.0] })
    }

    fn pattern(&self) -> u64 {
        u64::from(self.beyond)
    }

    fn boundary(&mut self, from: &[f64], to: &[f64]) -> Option<Boundary> {
        let a = self.units[0];
        (from[0] <= a && to[0] > a).then(|| Boundary::new(move |z| 1.0 - z[0] / a))
    }
}

#[test]
fn the_fold_within_a_tight_bend_at_the_beginning_is_named_where_it_is() {
    for stiffness in [3e3, 1e4, 1e5, 1e6] {
        for units in [[1.0, 1.0], [1024.0, 0.125], [2.0_f64.powi(-20), 4096.0]] {
            let mut system = Stop { stiffness, units, beyond: false };
            let [a, b] = units;
            let settings = window(1, -0.3 * b, 0.3 * b);
            let branch = settings.run(&mut system, &[a], 0.0, &[a, b], |_| ControlFlow::Continue(())).unwrap();
            let folds = events(&branch, |e| *e == EventKind::ParameterFold);
            assert_eq!(folds.len(), 1, "stiffness {stiffness:e}, units {units:?}");
            let [x, p] = system.fold();
            let off = [(folds[0].x[0] - x) / a, (folds[0].p - p) / b];
            // But for rounding, and the tolerance of points.
            let depth = 1e-6 * (x / a - 1.0) + f64::EPSILON;
            assert!(off[0].abs() <= depth && off[1].abs() < 1e-11, "stiffness {stiffness:e}: {off:?}");
            assert!(branch.points.len() < 60 && branch.evaluations < 400, "{} evaluations", branch.evaluations);
            assert_eq!(branch.points.last().map(|q| q.p), Some(-0.3 * b));
        }
    }
}

/// The same bend on the way, from starts that let it fall anywhere within a step: the change of the piece and the fold
/// behind it are two places, not one corner.
#[test]
fn the_fold_within_a_tight_bend_on_the_way_is_named_where_it_is() {
    for (stiffness, units) in [(1e4, [1.0, 1.0]), (1e5, [1.0, 1.0]), (1e4, [1024.0, 0.125]), (1e5, [1e-3, 7.0])] {
        for start in 0..20 {
            let mut system = Stop { stiffness, units, beyond: false };
            let [a, b] = units;
            let (settings, p) = (window(1, -0.6 * b, 0.6 * b), -0.463 + 0.0137 * f64::from(start));
            let direction = [a, b];
            let branch =
                settings.run(&mut system, &[(1.0 + p) * a], p * b, &direction, |_| ControlFlow::Continue(())).unwrap();
            let changes = events(&branch, |e| matches!(e, EventKind::PatternChange { .. }));
            let folds = events(&branch, |e| *e == EventKind::ParameterFold);
            let case = format!("stiffness {stiffness:e}, units {units:?}, start {start}");
            assert_eq!((changes.len(), folds.len()), (1, 1), "{case}");
            let at = [changes[0].x[0] / a - 1.0, changes[0].p / b];
            assert!(at[0].abs() < 1e-8 && at[1].abs() < 1e-8, "{case}: {at:?}");
            let [x, p] = system.fold();
            let off = [(folds[0].x[0] - x) / a, (folds[0].p - p) / b];
            assert!(off[0].abs() < 1e-6 * (x / a - 1.0) + f64::EPSILON && off[1].abs() < 1e-11, "{case}: {off:?}");
            assert_eq!(branch.points.last().map(|q| q.p), Some(-0.6 * b), "{case}");
        }
    }
}

/// Without a bend that is tight the same fold is one of the branch's steps.
#[test]
fn a_soft_stop_has_its_fold_at_the_same_formula() {
    let mut system = Stop { stiffness: 2.0, units: [1.0, 1.0], beyond: false };
    let settings = Continuation { max_points: 200, ..window(1, -0.3, 0.3) };
    let branch = settings.run(&mut system, &[1.0], 0.0, &[1.0, 1.0], |_| ControlFlow::Continue(())).unwrap();
    let folds = events(&branch, |e| *e == EventKind::ParameterFold);
    let [x, p] = system.fold();
    assert!(folds.len() == 1 && (folds[0].x[0] - x).abs() < 1e-7 && (folds[0].p - p).abs() < 1e-10);
}

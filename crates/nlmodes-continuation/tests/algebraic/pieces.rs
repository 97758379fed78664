//! Pieces that a branch enters and leaves again within a step.

use std::convert::Infallible;
use std::ops::ControlFlow;

use nlmodes_continuation::{Bound, Boundary, Continuation, EventKind, Linearization, ParametricSystem, Scaling};

use crate::samples::events;

/// `ξ = c (π − π₁)₊ (π₂ − π)₊` with `ξ = x/a`, `π = p/b`: another piece from π₁ to π₂, on which the curve bends so
/// little that no step is refused.
struct Bump {
    units: [f64; 2],
    /// The piece at the point evaluated last.
    piece: u64,
}

const BETWEEN: [f64; 2] = [0.3, 0.36];

fn piece(p: f64) -> u64 {
    u64::from(p > BETWEEN[0] && p < BETWEEN[1])
}

impl ParametricSystem for Bump {
    type Error = Infallible;

    fn dim(&self) -> usize {
        1
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        let ([a, b], [from, to]) = (self.units, BETWEEN);
        let (x, p) = (x[0] / a, p / b);
        self.piece = piece(p);
        let inside = 0.05 * self.piece as f64;
        out.residual[0] = x - inside * (p - from) * (to - p);
        out.jacobian[(0, 0)] = 1.0 / a;
        out.jacobian[(0, 1)] = -inside * (from + to - 2.0 * p) / b;
        Ok(())
    }

    fn scaling(&self) -> Option<Scaling> {
        Some(Scaling { unknowns: self.units.to_vec(), equations: vec![1.0] })
    }

    fn pattern(&self) -> u64 {
        self.piece
    }

    fn pattern_at(&mut self, z: &[f64]) -> Option<u64> {
        Some(piece(z[1] / self.units[1]))
    }
}

/// The longest step, 0.1, is longer than the piece; from a hundred starts it falls elsewhere on the steps.
#[test]
fn a_piece_that_a_step_enters_and_leaves_again_has_both_its_changes_where_they_are() {
    for units in [[1.0, 1.0], [1e-4, 3e3]] {
        let b = units[1];
        for start in 0..100 {
            let bounds = vec![Bound { coordinate: 1, min: -b, max: b }];
            let settings = Continuation { bounds, ..Continuation::default() };
            let from = (-1.0 + 0.007 * f64::from(start)) * b;
            let mut system = Bump { units, piece: 0 };
            let branch = settings.run(&mut system, &[0.0], from, &[0.0, b], |_| ControlFlow::Continue(())).unwrap();
            let changes = events(&branch, |e| matches!(e, EventKind::PatternChange { .. }));
            let at: Vec<f64> = changes.iter().map(|q| q.p / b).collect();
            assert_eq!(at.len(), 2, "{units:?}, start {start}: {at:?}");
            assert!(at.iter().zip(BETWEEN).all(|(at, known)| (at - known).abs() < 1e-8), "{units:?}, {start}: {at:?}");
            let kinds = [(0, 1), (1, 0)].map(|(from, to)| EventKind::PatternChange { from, to });
            assert!(changes.iter().zip(&kinds).all(|(q, kind)| q.events == [*kind]), "{units:?}, start {start}");
            assert_eq!(branch.points.last().map(|q| q.p), Some(b));
        }
    }
}

/// `x = 0.1 (p − ½)₊²`, whose boundary is known; and whether pieces are known without an evaluation.
struct Bend {
    is_told: bool,
    piece: u64,
}

const BEGIN: f64 = 0.5;

impl ParametricSystem for Bend {
    type Error = Infallible;

    fn dim(&self) -> usize {
        1
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        self.piece = u64::from(p > BEGIN);
        let beyond = (p - BEGIN).max(0.0);
        out.residual[0] = x[0] - 0.1 * beyond * beyond;
        (out.jacobian[(0, 0)], out.jacobian[(0, 1)]) = (1.0, -0.2 * beyond);
        Ok(())
    }

    fn pattern(&self) -> u64 {
        self.piece
    }

    fn pattern_at(&mut self, z: &[f64]) -> Option<u64> {
        self.is_told.then(|| u64::from(z[1] > BEGIN))
    }

    fn boundary(&mut self, from: &[f64], to: &[f64]) -> Option<Boundary> {
        let side = if from[1] > BEGIN { 1.0 } else { -1.0 };
        ((from[1] > BEGIN) != (to[1] > BEGIN)).then(|| Boundary::new(move |z| side * (z[1] - BEGIN)))
    }
}

/// Where pieces are known at no expense no point is evaluated to see whether the pattern changes before the boundary.
#[test]
fn a_system_that_tells_its_pieces_is_evaluated_less_often_for_the_same_change() {
    for start in 0..20 {
        let from = -0.5 - 0.0123 * f64::from(start);
        let [told, asked] = [true, false].map(|is_told| {
            let settings =
                Continuation { bounds: vec![Bound { coordinate: 1, min: -1.0, max: 1.0 }], ..Continuation::default() };
            let mut system = Bend { is_told, piece: 0 };
            settings.run(&mut system, &[0.0], from, &[0.0, 1.0], |_| ControlFlow::Continue(())).unwrap()
        });
        for branch in [&told, &asked] {
            let changes = events(branch, |e| *e == EventKind::PatternChange { from: 0, to: 1 });
            assert_eq!(changes.len(), 1, "from {from}");
            assert!((changes[0].p - BEGIN).abs() < 1e-9, "from {from}: {:e}", changes[0].p - BEGIN);
        }
        assert!(told.evaluations < asked.evaluations, "{} and {} evaluations", told.evaluations, asked.evaluations);
    }
}

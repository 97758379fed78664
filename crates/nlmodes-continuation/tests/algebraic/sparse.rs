//! The same branches with the sparse solver: points, events and half-branches must be those of the dense one.

use std::ops::ControlFlow;

use nlmodes_continuation::{
    Boundary, Branch, Continuation, LinearSolver, Linearization, ParametricSystem, Scaling, SparseSolver,
};

use crate::bends::Stop;
use crate::samples::{Embedded, piecewise, smooth, window};
use crate::several::{Modes, Square};

/// A system that writes the entries of its Jacobian which are not zero.
struct Sparse<S>(S);

impl<S: ParametricSystem> ParametricSystem for Sparse<S> {
    type Error = S::Error;

    fn dim(&self) -> usize {
        self.0.dim()
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), S::Error> {
        let mut full = Linearization::new(self.dim());
        self.0.linearize(x, p, &mut full)?;
        out.residual.copy_from_slice(&full.residual);
        out.sizes.copy_from_slice(&full.sizes);
        assert!(out.entries.is_empty() && out.jacobian.nrows() == 0);
        for j in (0..=x.len()).rev() {
            let column = full.jacobian.col(j).iter().enumerate().filter(|(_, value)| **value != 0.0);
            // In halves: what is at one place is added.
            out.entries.extend(column.flat_map(|(i, value)| [(i, j, 0.25 * value), (i, j, 0.75 * value)]));
        }
        Ok(())
    }

    fn solver(&self) -> Box<dyn LinearSolver> {
        Box::<SparseSolver>::default()
    }

    fn scaling(&self) -> Option<Scaling> {
        self.0.scaling()
    }

    fn pattern(&self) -> u64 {
        self.0.pattern()
    }

    fn boundary(&mut self, from: &[f64], to: &[f64]) -> Option<Boundary> {
        self.0.boundary(from, to)
    }

    fn accepted(&mut self, x: &[f64], p: f64) {
        self.0.accepted(x, p);
    }
}

fn followed<S: ParametricSystem>(settings: &Continuation, mut system: S, from: (&[f64], f64), along: &[f64]) -> Branch {
    settings.run(&mut system, from.0, from.1, along, |_| ControlFlow::Continue(())).unwrap()
}

/// Follows a branch with both solvers: the same points to `most`, with the same events and crossings.
fn same_branch<S: ParametricSystem>(
    settings: &Continuation,
    system: impl Fn() -> S,
    from: (&[f64], f64),
    along: &[f64],
    most: f64,
) -> Branch {
    let dense = followed(settings, system(), from, along);
    let sparse = followed(settings, Sparse(system()), from, along);
    assert_eq!(
        dense.points.len(),
        sparse.points.len(),
        "{:?}, {:?}: {:?}",
        dense.stop,
        sparse.stop,
        sparse.points.last()
    );
    for (a, b) in dense.points.iter().zip(&sparse.points) {
        let off = a.z().iter().zip(b.z()).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(off <= most, "{off:e} at {:?} and {:?}", a.z(), b.z());
        assert_eq!(a.events, b.events);
    }
    let arms = |branch: &Branch| branch.crossings.iter().map(|c| c.arms.len()).collect::<Vec<_>>();
    assert_eq!(arms(&dense), arms(&sparse));
    assert_eq!(dense.stop, sparse.stop);
    sparse
}

/// `Δu + p eᵘ = 0` on m × m inner nodes.
struct Bratu {
    m: usize,
}

impl ParametricSystem for Bratu {
    type Error = std::convert::Infallible;

    fn dim(&self) -> usize {
        self.m * self.m
    }

    fn linearize(&mut self, u: &[f64], p: f64, out: &mut Linearization) -> Result<(), Self::Error> {
        let (m, n) = (self.m, u.len());
        let h2 = (1.0 / (m + 1) as f64).powi(2);
        for i in 0..n {
            (0..n).for_each(|j| out.jacobian[(i, j)] = 0.0);
            (out.residual[i], out.jacobian[(i, n)]) = (h2 * p * u[i].exp() - 4.0 * u[i], h2 * u[i].exp());
            out.jacobian[(i, i)] = h2 * p * u[i].exp() - 4.0;
            for j in (0..n).filter(|j| (i % m).abs_diff(j % m) + (i / m).abs_diff(j / m) == 1) {
                out.residual[i] += u[j];
                out.jacobian[(i, j)] = 1.0;
            }
        }
        Ok(())
    }
}

#[test]
fn the_branch_of_bratu_through_its_fold_is_the_same_to_ten_digits() {
    let n = 49;
    let direction: Vec<f64> = (0..=n).map(|j| if j == n { 1.0 } else { 0.0 }).collect();
    let branch = same_branch(&window(n / 2, -1.0, 2.5), || Bratu { m: 7 }, (&vec![0.0; n], 0.0), &direction, 1e-10);
    assert_eq!(branch.points.iter().filter(|q| !q.events.is_empty()).count(), 1);
}

#[test]
fn folds_crossings_and_corners_of_curves_are_the_same() {
    let settings = window(4, -2.0, 2.0);
    let lifted = |x: f64, p: f64| (Embedded::<()>::lift(x, p), p);
    let along = |x: f64, p: f64| Embedded::<()>::lift(x, p).into_iter().chain([p]).collect::<Vec<f64>>();
    // A pitchfork, two lines that cross, a circle, a corner.
    let pitchfork = || Embedded(smooth(|x, p| [x * (p - x * x), p - 3.0 * x * x, x]));
    let (x, p) = lifted(0.0, -1.03);
    let branch = same_branch(&settings, pitchfork, (&x, p), &along(0.0, 1.0), 1e-9);
    assert_eq!(branch.crossings[0].arms.len(), 3);
    let lines = || Embedded(smooth(|x, p| [x * x - p * p, 2.0 * x, -2.0 * p]));
    let (x, p) = lifted(-1.03, -1.03);
    assert_eq!(same_branch(&settings, lines, (&x, p), &along(1.0, 1.0), 1e-9).crossings[0].arms.len(), 3);
    let circle = || Embedded(smooth(|x, p| [x * x + p * p - 1.0, 2.0 * x, 2.0 * p]));
    let (x, p) = lifted(1.0, 0.0);
    same_branch(&settings, circle, (&x, p), &along(0.0, 1.0), 1e-9);
    let corner = || {
        let f = |x: f64, p: f64| [x + p.abs(), 1.0, if p > 0.0 { 1.0 } else { -1.0 }];
        Embedded(piecewise(f, |_, p| u64::from(p > 0.0)))
    };
    let (x, p) = lifted(-1.03, -1.03);
    same_branch(&settings, corner, (&x, p), &along(1.0, 1.0), 1e-9);
}

#[test]
fn points_where_several_directions_become_free_have_the_same_arms() {
    for n in [2, 3] {
        let system = || Modes { at: vec![0.0; n], g: 0.4 };
        let along: Vec<f64> = (0..=n).map(|j| if j == n { 1.0 } else { 0.0 }).collect();
        let branch = same_branch(&window(n, -2.0, 0.5), system, (&vec![0.0; n], -0.37), &along, 1e-7);
        assert_eq!(branch.crossings[0].arms.len(), 3_usize.pow(n as u32));
    }
}

#[test]
fn all_arms_of_the_double_branch_point_of_a_square_are_found() {
    for m in [2, 4, 5] {
        let angle = |k: usize| (k as f64 * std::f64::consts::PI / (m + 1) as f64).cos();
        let (first, double) = (4.0 - 4.0 * angle(1), 4.0 - 2.0 * angle(1) - 2.0 * angle(2));
        let n = m * m;
        let along: Vec<f64> = (0..=n).map(|j| if j == n { 1.0 } else { 0.0 }).collect();
        let settings = window(n, 0.0, double + 0.3 * (double - first));
        let branch = followed(&settings, Sparse(Square { m }), (&vec![0.0; n], 0.3317 * first), &along);
        let found: Vec<(usize, usize)> = branch.crossings.iter().map(|c| (c.arms.len(), c.kernel)).collect();
        assert_eq!(found, [(3, 2), (9, 3)], "m = {m}");
        let off = |k: usize, p: f64| (branch.crossings[k].z[n] - p).abs();
        assert!(off(0, first) < 1e-6 && off(1, double) < 1e-6, "m = {m}");
    }
}

#[test]
fn a_tight_bend_is_passed_in_the_same_way() {
    for units in [[1.0, 1.0], [1024.0, 0.125]] {
        let system = || Stop { stiffness: 1e5, units, beyond: false };
        let [a, b] = units;
        same_branch(&window(1, -0.6 * b, 0.6 * b), system, (&[a], 0.0), &[a, b], 1e-9 * a.max(b));
    }
}

//! Bratu's problem in the plane, `Δu + p eᵘ = 0` on the unit square with `u = 0` around it: thousands of unknowns that
//! each know four others.
//!
//! Five-point differences on m × m inner nodes; the branch starts at `u = 0`, turns at the fold `p = 6.808124423…` (T.
//! F. Chan, H. B. Keller, SIAM J. Sci. Stat. Comput. 3 (1982), doi:10.1137/0903012), and ends where the largest `u`
//! is 3. The system chooses its linear solver: the sparse one, for which it writes entries that are not zero, or the
//! dense one, for which it writes the whole Jacobian.
//!
//! `cargo run --release -p nlmodes-continuation --example bratu_plane` follows it on finer and finer grids with the
//! sparse solver, and `-- beside 60` its first points with both solvers on 60 × 60 nodes.

use std::convert::Infallible;
use std::ops::ControlFlow;
use std::time::Instant;

use nlmodes_continuation::{
    Bound, Branch, Continuation, ContinuationError, DenseSolver, EventKind, LinearSolver, Linearization,
    ParametricSystem, Scaling, SparseSolver,
};

/// The fold of the differential equation.
const FOLD: f64 = 6.808_124_423;

/// Points over which both solvers are timed.
const TIMED: usize = 4;

struct Bratu {
    m: usize,
    sparse: bool,
}

impl ParametricSystem for Bratu {
    type Error = Infallible;

    fn dim(&self) -> usize {
        self.m * self.m
    }

    fn solver(&self) -> Box<dyn LinearSolver> {
        if self.sparse { Box::<SparseSolver>::default() } else { Box::<DenseSolver>::default() }
    }

    fn linearize(&mut self, u: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        let (m, n) = (self.m, u.len());
        let h2 = (1.0 / (m + 1) as f64).powi(2);
        for i in 0..n {
            let (x, y) = (i % m, i / m);
            let inside = [(x > 0, -1), (x + 1 < m, 1), (y > 0, -(m as isize)), (y + 1 < m, m as isize)];
            let beside = inside.iter().filter(|(inside, _)| *inside).map(|(_, step)| i.wrapping_add_signed(*step));
            out.residual[i] = h2 * p * u[i].exp() - 4.0 * u[i] + beside.clone().map(|j| u[j]).sum::<f64>();
            let own = [(i, h2 * p * u[i].exp() - 4.0), (n, h2 * u[i].exp())];
            for (j, value) in own.into_iter().chain(beside.map(|j| (j, 1.0))) {
                if self.sparse {
                    out.entries.push((i, j, value));
                } else {
                    out.jacobian[(i, j)] = value;
                }
            }
        }
        Ok(())
    }

    /// Steps are of the root of the mean square of `u`, whatever the number of nodes.
    fn scaling(&self) -> Option<Scaling> {
        let (m, n) = (self.m as f64, self.dim());
        let unknowns = vec![m; n].into_iter().chain([1.0]).collect();
        Some(Scaling { unknowns, equations: vec![m; n] })
    }
}

fn follow(m: usize, sparse: bool, max_points: usize) -> Result<Branch, ContinuationError<Infallible>> {
    let n = m * m;
    let middle = Bound { coordinate: n / 2 + (1 - m % 2) * (m / 2), min: -1.0, max: 3.0 };
    let mut settings = Continuation { bounds: vec![middle], max_points, ..Continuation::default() };
    settings.step.max = 0.5;
    let mut direction = vec![0.0; n + 1];
    direction[n] = 1.0;
    settings.run(&mut Bratu { m, sparse }, &vec![0.0; n], 0.0, &direction, |_| ControlFlow::Continue(()))
}

/// Parameters of the folds.
fn folds(branch: &Branch) -> Vec<f64> {
    branch.points.iter().filter(|q| q.events.contains(&EventKind::ParameterFold)).map(|q| q.p).collect()
}

/// A branch, and the time of one of its evaluations, ms.
fn timed(m: usize, sparse: bool, max_points: usize) -> Result<(Branch, f64), ContinuationError<Infallible>> {
    let clock = Instant::now();
    let branch = follow(m, sparse, max_points)?;
    let ms = 1e3 * clock.elapsed().as_secs_f64() / branch.evaluations as f64;
    Ok((branch, ms))
}

fn grids() -> Result<(), ContinuationError<Infallible>> {
    for m in [15, 31, 60] {
        let (branch, ms) = timed(m, true, usize::MAX)?;
        let fold = folds(&branch).first().copied().unwrap_or(f64::NAN);
        let error = fold - FOLD;
        println!("{m:>3} × {m} nodes: fold at p = {fold:.9} ({error:+.1e}), {} points,", branch.points.len());
        println!("    {} evaluations of {ms:.1} ms; {:?}", branch.evaluations, branch.stop);
    }
    Ok(())
}

fn beside(m: usize) -> Result<(), ContinuationError<Infallible>> {
    for (name, sparse) in [("dense", false), ("sparse", true)] {
        let (branch, ms) = timed(m, sparse, TIMED)?;
        let p = branch.points.last().map_or(f64::NAN, |point| point.p);
        println!("{name:>6}, {m} × {m} nodes: {} evaluations of {ms:.1} ms up to p = {p:.9}", branch.evaluations);
    }
    Ok(())
}

fn main() -> Result<(), ContinuationError<Infallible>> {
    let mut words = std::env::args().skip(1);
    match (words.next().as_deref(), words.next().and_then(|m| m.parse().ok())) {
        (Some("beside"), Some(m)) if m > 0 => beside(m),
        (Some(_), _) => {
            eprintln!("usage: bratu_plane [beside NODES]");
            Ok(())
        }
        (None, _) => grids(),
    }
}

#[test]
fn the_fold_is_that_of_the_differences_and_converges_with_the_square_of_the_spacing()
-> Result<(), ContinuationError<Infallible>> {
    // By Newton's method for dp/da = 0, a the mean of u over the first sine mode, with SciPy's sparse LU factorisation.
    let of_differences = [(7, 6.783316577857), (15, 6.802174095627), (31, 6.806652729202)];
    let mut errors = Vec::new();
    for (m, expected) in of_differences {
        let branch = follow(m, true, usize::MAX)?;
        let found = folds(&branch);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((found[0] - expected).abs() < 1e-9, "{m}: {found:?}");
        // No branch point: the other curves of this problem do not meet the one through zero.
        assert!(branch.crossings.is_empty() && matches!(branch.stop, nlmodes_continuation::StopReason::Bound { .. }));
        errors.push(FOLD - found[0]);
    }
    let rates: Vec<f64> = errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
    assert!(rates.iter().all(|rate| (rate - 2.0).abs() < 0.07) && (rates[1] - 2.0).abs() < 0.02, "{rates:?}");
    Ok(())
}

#[test]
fn the_fold_is_the_same_with_the_dense_solver() -> Result<(), ContinuationError<Infallible>> {
    let [dense, sparse] = [false, true].map(|sparse| follow(7, sparse, usize::MAX));
    let (dense, sparse) = (dense?, sparse?);
    assert_eq!((dense.points.len(), folds(&dense).len()), (sparse.points.len(), 1));
    assert!((folds(&dense)[0] - folds(&sparse)[0]).abs() < 1e-10, "{:?}, {:?}", folds(&dense), folds(&sparse));
    assert!((folds(&dense)[0] - 6.783_316_577_857).abs() < 1e-9, "{:?}", folds(&dense));
    Ok(())
}

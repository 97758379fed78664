//! Bratu's problem in the plane, `Δu + p eᵘ = 0` on the unit square with `u = 0` around it: thousands of unknowns that each know four others.
//!
//! Five-point differences on m × m inner nodes; the branch starts at `u = 0`, turns at the fold `p = 6.808124423…` (T. F. Chan, H. B. Keller, SIAM J.
//! Sci. Stat. Comput. 3 (1982), doi:10.1137/0903012), and ends where the largest `u` is 3. The system chooses the sparse solver, and writes entries
//! that are not zero.
//!
//! `cargo run --release -p nlmodes-continuation --example bratu_plane`

use std::convert::Infallible;
use std::ops::ControlFlow;
use std::time::Instant;

use nlmodes_continuation::{
    Bound, Branch, Continuation, ContinuationError, EventKind, LinearSolver, Linearization, ParametricSystem, Scaling,
    SparseSolver,
};

/// The fold of the differential equation.
const FOLD: f64 = 6.808_124_423;

struct Bratu {
    m: usize,
}

impl ParametricSystem for Bratu {
    type Error = Infallible;

    fn dim(&self) -> usize {
        self.m * self.m
    }

    fn solver(&self) -> Box<dyn LinearSolver> {
        Box::<SparseSolver>::default()
    }

    fn linearize(&mut self, u: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        let (m, n) = (self.m, u.len());
        let h2 = (1.0 / (m + 1) as f64).powi(2);
        for i in 0..n {
            let (x, y) = (i % m, i / m);
            let inside = [(x > 0, -1), (x + 1 < m, 1), (y > 0, -(m as isize)), (y + 1 < m, m as isize)];
            out.residual[i] = h2 * p * u[i].exp() - 4.0 * u[i];
            out.entries.push((i, i, h2 * p * u[i].exp() - 4.0));
            out.entries.push((i, n, h2 * u[i].exp()));
            for (_, step) in inside.iter().filter(|(inside, _)| *inside) {
                let j = i.wrapping_add_signed(*step);
                out.residual[i] += u[j];
                out.entries.push((i, j, 1.0));
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

fn follow(m: usize) -> Result<Branch, ContinuationError<Infallible>> {
    let n = m * m;
    let middle = Bound { coordinate: n / 2 + (1 - m % 2) * (m / 2), min: -1.0, max: 3.0 };
    let mut settings = Continuation { bounds: vec![middle], ..Continuation::default() };
    settings.step.max = 0.5;
    let mut direction = vec![0.0; n + 1];
    direction[n] = 1.0;
    settings.run(&mut Bratu { m }, &vec![0.0; n], 0.0, &direction, |_| ControlFlow::Continue(()))
}

/// Parameters of the folds.
fn folds(branch: &Branch) -> Vec<f64> {
    branch.points.iter().filter(|q| q.events.contains(&EventKind::ParameterFold)).map(|q| q.p).collect()
}

fn main() -> Result<(), ContinuationError<Infallible>> {
    for m in [15, 31, 60] {
        let clock = Instant::now();
        let branch = follow(m)?;
        let ms = 1e3 * clock.elapsed().as_secs_f64() / branch.evaluations as f64;
        let fold = folds(&branch).first().copied().unwrap_or(f64::NAN);
        let error = fold - FOLD;
        println!("{m:>3} × {m} nodes: fold at p = {fold:.9} ({error:+.1e}), {} points,", branch.points.len());
        println!("    {} evaluations of {ms:.1} ms; {:?}", branch.evaluations, branch.stop);
    }
    Ok(())
}

#[test]
fn the_fold_is_that_of_the_differences_and_converges_with_the_square_of_the_spacing()
-> Result<(), ContinuationError<Infallible>> {
    // By Newton's method for dp/da = 0, a the mean of u over the first sine mode, with SciPy's sparse LU factorisation.
    let of_differences = [(7, 6.783316577857), (15, 6.802174095627), (31, 6.806652729202)];
    let mut errors = Vec::new();
    for (m, expected) in of_differences {
        let branch = follow(m)?;
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

//! Branches of systems, and what they met beside what they should have met.

use std::ops::ControlFlow;

use nlmodes::continuation::{Bound, Branch, BranchPoint, BranchTree, Continuation, EventKind, ParametricSystem};

use super::super::Check;
use crate::Failure;

/// Why a parameter at a crossing has that limit.
pub const CROSSED: &str = "a branch point is a double zero: the root of the tolerance";

/// From `x`, `p` with growing parameter until it, or an unknown, leaves its window.
pub fn trace<S: ParametricSystem>(
    system: &mut S,
    x: &[f64],
    p: f64,
    bounds: &[(usize, f64, f64)],
) -> Result<Branch, Failure> {
    let mut direction = vec![0.0; x.len() + 1];
    direction[x.len()] = 1.0;
    Ok(settings(bounds).run(system, x, p, &direction, |_| ControlFlow::Continue(())).map_err(|e| e.to_string())?)
}

/// A continuation within these windows.
fn settings(bounds: &[(usize, f64, f64)]) -> Continuation {
    let bounds = bounds.iter().map(|&(coordinate, min, max)| Bound { coordinate, min, max }).collect();
    Continuation { bounds, ..Continuation::default() }
}

/// The points with an event.
fn at(branch: &Branch, event: EventKind) -> Vec<&BranchPoint> {
    branch.points.iter().filter(|q| q.events.contains(&event)).collect()
}

/// Number of folds and the parameters of the first ones, beside what they should be.
pub fn folds(branch: &Branch, expected: &[f64], limit: f64, why: &'static str) -> Vec<Check> {
    let found = at(branch, EventKind::ParameterFold);
    let mut checks = vec![Check::count("folds", found.len(), expected.len())];
    let size = expected.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
    checks.extend(
        found
            .iter()
            .zip(expected)
            .enumerate()
            .map(|(k, (q, p))| Check::of_size(format!("p at fold {}", k + 1), [q.p, *p, size], limit, why)),
    );
    checks
}

/// Number of branch points, their parameters and arms, beside what they should be.
pub fn crossings(branch: &Branch, expected: &[(f64, usize)], size: f64) -> Vec<Check> {
    let mut checks = vec![Check::count("branch points", branch.crossings.len(), expected.len())];
    for (k, (crossing, (p, arms))) in branch.crossings.iter().zip(expected).enumerate() {
        let found = crossing.z.last().copied().unwrap_or(f64::NAN);
        checks.push(Check::of_size(format!("p at branch point {}", k + 1), [found, *p, size], 1e-6, CROSSED));
        checks.push(Check::count(format!("half-branches of branch point {}", k + 1), crossing.arms.len(), *arms));
    }
    checks
}

/// All branches that are connected, from `x`, `p` with growing parameter.
pub fn tree<S: ParametricSystem>(
    system: &mut S,
    x: &[f64],
    p: f64,
    bounds: &[(usize, f64, f64)],
) -> Result<BranchTree, Failure> {
    let mut direction = vec![0.0; x.len() + 1];
    direction[x.len()] = 1.0;
    let found = settings(bounds).run_tree(system, x, p, &direction, 20, |_, _| ControlFlow::Continue(()));
    Ok(found.map_err(|e| e.to_string())?)
}

/// The parameter of the first fold of the branch from `u = end`, `p = 0`.
pub fn first_fold<S: ParametricSystem>(mut system: S, end: f64, beyond: f64) -> Result<f64, Failure> {
    let n = system.dim();
    let mut direction = vec![0.0; n + 1];
    direction[n] = 1.0;
    let mut fold = None;
    let settings = settings(&[(n, -0.1, beyond)]);
    settings
        .run(&mut system, &vec![end; n], 0.0, &direction, |q| {
            if q.events.contains(&EventKind::ParameterFold) {
                fold = fold.or(Some(q.p));
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        })
        .map_err(|e| e.to_string())?;
    fold.ok_or_else(|| "no fold was found".into())
}

//! Conformance suite for any [`LcpSolver`]: data set × solver, in one line.
//!
//! ```
//! use nlmodes_contact::{ActiveSet, conformance};
//! let summary = conformance::check(&ActiveSet::default(), 10, &[]).map_err(|failures| format!("{failures:#?}"))?;
//! assert!(summary.solved > 20 && summary.declined == 0);
//! # Ok::<(), String>(())
//! ```
//!
//! Every case is solved without a guess, from its own solution, and from the guess that all contacts are closed. Each
//! time one of three outcomes is required: the judge accepts the forces, the gaps are the known ones and the statistics
//! agree with the judge; or the problem is contradictory and the proof is valid; or the backend fails on a case that
//! its caller listed, with an error that describes its best iterate correctly. Anything else is a [`Failure`].

mod case;
mod mechanical;
mod random;
mod small;

pub use case::{Case, Expected};

use crate::{LcpError, LcpMatrix, LcpSolver, LcpStatistics, LcpWorkspace};

/// Largest violation of a solution.
const ACCEPTED: f64 = 1e-10;

/// What went wrong with a case.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Failure {
    /// Name of the case.
    pub case: String,
    /// The guess from which it was solved.
    pub guess: &'static str,
    /// What happened.
    pub what: String,
}

/// Number of cases by outcome.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Summary {
    /// Cases solved.
    pub solved: usize,
    /// Contradictory cases proven to be so.
    pub infeasible: usize,
    /// Cases listed by the caller that failed with a correct error.
    pub declined: usize,
}

/// All cases with at most `at_most` contacts.
pub fn cases(at_most: usize) -> Vec<Case> {
    let mut all = small::cases();
    all.extend(mechanical::cases(at_most));
    all.extend(random::cases(at_most));
    all.retain(|case| case.b.len() <= at_most);
    all
}

/// Solves all cases with at most `at_most` contacts. Those named in `declines` may end with an error.
///
/// # Errors
/// All failures.
pub fn check(solver: &dyn LcpSolver, at_most: usize, declines: &[&str]) -> Result<Summary, Vec<Failure>> {
    let (mut summary, mut failures) = (Summary::default(), Vec::new());
    for case in cases(at_most) {
        match check_case(solver, &case, declines.contains(&case.name.as_str())) {
            Ok(Ending::Solved) => summary.solved += 1,
            Ok(Ending::Infeasible) => summary.infeasible += 1,
            Ok(Ending::Declined) => summary.declined += 1,
            Err((guess, what)) => failures.push(Failure { case: case.name, guess, what }),
        }
    }
    if failures.is_empty() { Ok(summary) } else { Err(failures) }
}

#[derive(Clone, Copy)]
enum Ending {
    Solved,
    Infeasible,
    Declined,
}

type Verdict = Result<Ending, (&'static str, String)>;

fn check_case(solver: &dyn LcpSolver, case: &Case, may_decline: bool) -> Verdict {
    let set_up = |e: LcpError| ("set-up", e.to_string());
    let matrix = LcpMatrix::new(&case.a).map_err(set_up)?;
    let mut workspace = match solver.workspace(&matrix) {
        Err(_) if may_decline => return Ok(Ending::Declined),
        other => other.map_err(set_up)?,
    };
    let mut closed = vec![false; case.b.len()];
    let mut ending = Ok(Ending::Solved);
    for guess in ["cold", "own solution", "all closed"] {
        if guess == "all closed" {
            closed.fill(true);
        }
        ending =
            check_outcome(case, &matrix, workspace.as_mut(), &mut closed, may_decline).map_err(|what| (guess, what));
        if !matches!(ending, Ok(Ending::Solved)) {
            return ending;
        }
    }
    ending
}

fn check_outcome(
    case: &Case,
    matrix: &LcpMatrix,
    workspace: &mut dyn LcpWorkspace,
    closed: &mut [bool],
    may_decline: bool,
) -> Result<Ending, String> {
    let mut lambda = vec![f64::NAN; case.b.len()];
    match (workspace.solve(&case.b, closed, &mut lambda), &case.expected) {
        (Ok(_), Expected::Infeasible) => Err("solved, though contradictory".to_owned()),
        (Ok(statistics), Expected::Gaps { gaps, tolerance }) => {
            check_solution(matrix, &case.b, closed, &lambda, statistics)?;
            check_gaps(workspace, gaps, *tolerance).map(|()| Ending::Solved)
        }
        (Ok(statistics), Expected::Solution) => {
            check_solution(matrix, &case.b, closed, &lambda, statistics).map(|()| Ending::Solved)
        }
        (Err(LcpError::Infeasible { ray }), Expected::Infeasible) => {
            check_ray(matrix, &case.b, &ray).map(|()| Ending::Infeasible)
        }
        (Err(LcpError::NotConverged { violation, lambda, .. } | LcpError::Rounding { violation, lambda, .. }), _)
            if may_decline =>
        {
            check_best_iterate(matrix, &case.b, &lambda, violation).map(|()| Ending::Declined)
        }
        (Err(error), _) => Err(error.to_string()),
    }
}

fn check_solution(
    matrix: &LcpMatrix,
    b: &[f64],
    closed: &[bool],
    lambda: &[f64],
    statistics: LcpStatistics,
) -> Result<(), String> {
    let violation = matrix.violation(b, lambda);
    if violation > ACCEPTED {
        return Err(format!("wrong in silence: violation {violation:e}"));
    }
    if (violation - statistics.violation).abs() > 0.01 * ACCEPTED {
        return Err(format!("violation {violation:e}, reported as {:e}", statistics.violation));
    }
    match lambda.iter().zip(closed).position(|(l, closed)| *l < 0.0 || (*l > 0.0 && !closed)) {
        Some(at) => Err(format!("contact {at} pulls, or carries a force and is called open")),
        None => Ok(()),
    }
}

fn check_gaps(workspace: &dyn LcpWorkspace, expected: &[f64], tolerance: f64) -> Result<(), String> {
    let mut gaps = vec![0.0; expected.len()];
    workspace.gaps(&mut gaps).map_err(|e| e.to_string())?;
    match gaps.iter().zip(expected).position(|(g, e)| (g - e).abs() > tolerance || g.is_nan()) {
        Some(at) => Err(format!("gap {at} is {:e}, not {:e}", gaps[at], expected[at])),
        None => Ok(()),
    }
}

fn check_ray(matrix: &LcpMatrix, b: &[f64], ray: &[f64]) -> Result<(), String> {
    let mut image = vec![0.0; b.len()];
    matrix.gaps(&vec![0.0; b.len()], ray, &mut image).map_err(|e| e.to_string())?;
    let work: f64 = b.iter().zip(ray).map(|(b, z)| b * z).sum();
    let reached = image.iter().zip(ray).map(|(i, z)| (i * z).abs()).fold(0.0, f64::max);
    let push = ray.iter().all(|z| *z >= 0.0);
    if push && work < 0.0 && reached < 1e-6 * ray.iter().zip(b).map(|(z, b)| (z * b).abs()).fold(0.0, f64::max) {
        Ok(())
    } else {
        Err(format!("no proof of infeasibility: bᵀz = {work:e}, |z·Az| = {reached:e}"))
    }
}

fn check_best_iterate(matrix: &LcpMatrix, b: &[f64], lambda: &[f64], violation: f64) -> Result<(), String> {
    let found = matrix.violation(b, lambda);
    if violation > 0.5 * ACCEPTED && (found - violation).abs() <= 1e-6 * found {
        Ok(())
    } else {
        Err(format!("declined with violation {violation:e}, but its best iterate has {found:e}"))
    }
}

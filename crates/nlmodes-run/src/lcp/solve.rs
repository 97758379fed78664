//! Contact problems, one sample after the other.

use std::time::{Duration, Instant};

use nlmodes::contact::{LcpError, LcpSolver, Series, SeriesSolution, Start};

use super::error::ProblemError;
use super::problem::Problem;

/// What became of contact problems.
pub struct Solved {
    /// Name of the solver.
    pub solver: &'static str,
    /// Forces and gaps of the samples.
    pub solution: SeriesSolution,
    /// Samples that have a solution: all, or those before the first that has none.
    pub samples: usize,
    /// Why that one has none.
    pub failure: Option<LcpError>,
    /// By the clock.
    pub time: Duration,
}

/// Solves the samples of a problem, each from the solution of the one before.
///
/// # Errors
/// [`ProblemError`] where the solver does not take the problem; a sample without solution is in the outcome.
pub fn solve(problem: &Problem, solver: &dyn LcpSolver) -> Result<Solved, ProblemError> {
    let mut solution = SeriesSolution::default();
    let began = Instant::now();
    let outcome = Series::new(&problem.matrix, solver)
        .and_then(|mut series| series.solve(&problem.b, Start::PreviousSample, &mut solution));
    let time = began.elapsed();
    let (samples, failure) = match outcome {
        Ok(()) => (problem.n_samples(), None),
        Err(LcpError::Sample { sample, source }) => (sample, Some(*source)),
        Err(error) => return Err(error.into()),
    };
    Ok(Solved { solver: solver.name(), solution, samples, failure, time })
}

//! `nlmodes-cli lcp`: contact problems of one's own, `0 ≤ A λ + b ⊥ λ ≥ 0`, from a NumPy archive.

mod summary;

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use clap::builder::PossibleValuesParser;
use nlmodes::contact::{LcpError, LcpSolver, SOLVER_NAMES, Series, SeriesSolution, Start, solver_by_name};
use nlmodes_run::chain;
use nlmodes_run::lcp::{Problem, ProblemError, check_place, read, write};

use crate::Status;
use crate::terminal::print;

/// What stands on the command line.
#[derive(Debug, Args)]
pub struct Arguments {
    /// NumPy archive with `A` (c × c, m/N) and `b` (samples × c, or c values, m)
    #[arg(value_name = "PROBLEM.npz")]
    problem: PathBuf,
    /// Contact solver
    #[arg(long, value_name = "NAME", default_value = SOLVER_NAMES[0], value_parser = PossibleValuesParser::new(SOLVER_NAMES))]
    contact_solver: String,
    /// NumPy archive for `lambda` (N) and `g` (m), both samples × c, and `violation` and `iterations` of each sample
    #[arg(long, value_name = "SOLUTION.npz")]
    out: Option<PathBuf>,
}

/// Solves the problems of the archive. Where a sample has no solution, those before it are written.
pub fn run(arguments: &Arguments) -> Status {
    match solve(arguments) {
        Ok(status) => status,
        Err(error) => {
            say!("error: {}: {}", arguments.problem.display(), chain(&error));
            Status::Wrong
        }
    }
}

fn solve(arguments: &Arguments) -> Result<Status, ProblemError> {
    let solver = solver_by_name(&arguments.contact_solver)?;
    let problem = read(&arguments.problem)?;
    if let Some(path) = &arguments.out {
        check_place(path, &arguments.problem)?;
    }
    let mut solution = SeriesSolution::default();
    let began = Instant::now();
    let outcome = solve_series(&problem, solver.as_ref(), &mut solution);
    let time = began.elapsed();
    let (solved, failure) = match outcome {
        Ok(()) => (problem.n_samples(), None),
        Err(LcpError::Sample { sample, source }) => (sample, Some((sample, *source))),
        Err(error) => return Err(error.into()),
    };
    if let Some(path) = arguments.out.as_ref().filter(|_| solved > 0) {
        write(path, &solution, solved, problem.matrix.n_contacts())?;
    }
    let Some((sample, reason)) = failure else {
        return Ok(print(&summary::text(solver.name(), &problem, &solution, time)));
    };
    say!("error: sample {sample} has no solution: {reason}");
    if let LcpError::Infeasible { ray } = &reason {
        say!("{}", summary::of_proof(ray));
    }
    say!("{}", summary::of_what_was_kept(solved, arguments.out.as_deref()));
    Ok(Status::EndedEarly)
}

fn solve_series(problem: &Problem, solver: &dyn LcpSolver, solution: &mut SeriesSolution) -> Result<(), LcpError> {
    Series::new(&problem.matrix, solver)?.solve(&problem.b, Start::PreviousSample, solution)
}

//! `nlmodes-cli lcp`: the user's own contact problems, `0 ≤ A λ + b ⊥ λ ≥ 0`, from a NumPy archive.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::PossibleValuesParser;
use nlmodes::contact::{SOLVER_NAMES, solver_by_name};
use nlmodes_run::chain;
use nlmodes_run::lcp::{self, ProblemError, check_place, read, write};

use crate::Status;
use crate::terminal::print;

/// Command-line arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    /// NumPy archive with `A` (c × c, m/N) and `b` (samples × c, or c values, m)
    #[arg(value_name = "PROBLEM.npz")]
    problem: PathBuf,
    /// Contact solver
    #[arg(long, value_name = "NAME", default_value = SOLVER_NAMES[0])]
    #[arg(value_parser = PossibleValuesParser::new(SOLVER_NAMES))]
    contact_solver: String,
    /// NumPy archive for `lambda` (N) and `g` (m), both samples × c, and `violation` and `iterations` of each sample
    #[arg(long, value_name = "SOLUTION.npz")]
    out: Option<PathBuf>,
}

/// Solves the problems of the archive. If a sample has no solution, those before it are written.
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
    let (problem, out) = (read(&arguments.problem)?, arguments.out.as_deref());
    let solver = solver_by_name(&arguments.contact_solver)?;
    if let Some(path) = out {
        check_place(path, &arguments.problem)?;
    }
    let solved = lcp::solve(&problem, solver.as_ref())?;
    if let Some(path) = out.filter(|_| solved.samples > 0) {
        write(path, &solved.solution, solved.samples, problem.matrix.n_contacts())?;
    }
    let Some(failure) = solved.failure_text() else { return Ok(print(&solved.text(&problem))) };
    say!("error: {failure}\n{}", kept(solved.samples, out));
    Ok(Status::EndedEarly)
}

/// Results of the samples before the one that failed.
fn kept(solved: usize, out: Option<&Path>) -> String {
    match (solved, out) {
        (1.., Some(path)) => format!("The {solved} sample(s) before it are in {}", path.display()),
        (1.., None) => format!("The {solved} sample(s) before it have one; --out writes it"),
        _ => "Nothing was written".to_owned(),
    }
}

//! Writes `benchmarks/verification.md`: cases with known answers, computed anew. With a word, prints the cases whose
//! name contains it; with `--quiet`, only says which pass, of all or of those that are named.

use std::process::ExitCode;
use std::time::Duration;

use nlmodes_benchmarks::verification::{Outcome, manual, run};

const PAGE: &str = "benchmarks/verification.md";

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let quiet = words.first().is_some_and(|word| word == "--quiet");
    let word = words.first().cloned().unwrap_or_default();
    let seen = |outcome: &Outcome| {
        let verdict = if outcome.passes() { "pass" } else { "FAIL" };
        eprintln!("{verdict} {:>8.3} s  {}", outcome.took.as_secs_f64(), outcome.case.name);
    };
    let results = match words.get(1..) {
        Some(names) if quiet && !names.is_empty() => run(|name| names.iter().any(|one| one == name), seen),
        _ => run(|name| quiet || name.contains(&word), seen),
    };
    let all = || results.iter().flat_map(|(_, outcomes)| outcomes);
    let time: Duration = all().map(|outcome| outcome.took).sum();
    eprintln!("{} cases, {:.1} s of processor time", all().count(), time.as_secs_f64());
    if word.is_empty() {
        let before = std::fs::read_to_string(PAGE).unwrap_or_default();
        if let Err(error) = std::fs::write(PAGE, manual(&results, &before)) {
            eprintln!("{PAGE}: {error}");
            return ExitCode::FAILURE;
        }
    } else if !quiet {
        println!("{}", manual(&results, ""));
    }
    if all().all(|outcome| outcome.passes()) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

//! Writes `docs/verification.md`: cases with known answers, computed anew. With a word, prints the cases whose name contains it; with
//! `--quiet`, only says which pass.

use std::process::ExitCode;
use std::time::Duration;

use nlmodes_benchmarks::verification::{manual, run};

const PAGE: &str = "docs/verification.md";

fn main() -> ExitCode {
    let word = std::env::args().nth(1).unwrap_or_default();
    let quiet = word == "--quiet";
    let results = run(if quiet { "" } else { &word });
    let all = || results.iter().flat_map(|(_, outcomes)| outcomes);
    for outcome in all() {
        let verdict = if outcome.passes() { "pass" } else { "FAIL" };
        eprintln!("{verdict} {:>8.3} s  {}", outcome.took.as_secs_f64(), outcome.case.name);
    }
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

//! Cases at the limits of numbers: what is asked, what comes out, and by what it is judged; the tables of
//! benchmarks/results/hard_cases.md.
//!
//! `cargo run --release -p nlmodes-benchmarks --example hard_cases [part of a name …]`; without an argument all of
//! them.

#[path = "hard_cases/cases.rs"]
mod cases;
#[path = "hard_cases/judge.rs"]
mod judge;
#[path = "hard_cases/models.rs"]
mod models;

use std::panic::catch_unwind;

use cases::{Case, all};
use judge::Verdict;

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let mut group = "";
    let mut bad = 0;
    for case in all() {
        if !wanted.is_empty() && !wanted.iter().any(|w| case.group.contains(w) || case.name.contains(w)) {
            continue;
        }
        if case.group != group {
            group = case.group;
            println!("\n### {group}\n\n{}", judge::HEADER);
        }
        bad += usize::from(!run(&case));
    }
    if bad > 0 {
        println!("\n{bad} cases did not do what was asked.");
        std::process::exit(1);
    }
}

fn run(case: &Case) -> bool {
    let verdict = catch_unwind(|| (case.compute)()).unwrap_or_else(|_| Err("it panicked".into()));
    let (line, good) = match verdict {
        Ok(verdict) => (Verdict::to_string(&verdict), verdict.good()),
        Err(error) if error.is::<judge::Refused>() => (error.to_string(), true),
        Err(error) => (format!("**{}**", judge::chain(error.as_ref())), false),
    };
    println!("| {} | {line} |", case.name);
    good
}

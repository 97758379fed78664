//! Cases with known answers, by topic: what `benchmarks/verification.md` is written from, and what the test of
//! this crate runs.
//!
//! A case states a problem, computes it with the public interface of the libraries, and holds the results against
//! references that owe nothing to them: closed forms evaluated in the case itself, independent computations, numbers
//! that others have published, measurements. Each comparison has a limit with its reason.

use std::time::Duration;

use crate::{Failure, thread_time};

mod branches;
mod case;
mod chains;
mod contact;
mod files;
mod forced;
mod forced_oscillator;
mod linear;
mod manual;
mod periodic;
mod records;
mod time;
mod tools;

pub use case::{Case, Check, Kind};
pub use manual::{manual, recorded_values};

/// Cases of one kind of problem.
#[derive(Debug, Clone, Copy)]
pub struct Topic {
    /// Heading.
    pub title: &'static str,
    /// Its cases.
    pub cases: &'static [Case],
}

/// All topics, in the order of the manual.
pub const TOPICS: [Topic; 8] = [
    Topic { title: "Linear structures", cases: linear::CASES },
    Topic { title: "Contact problems", cases: contact::CASES },
    Topic { title: "Periodic motions", cases: periodic::CASES },
    Topic { title: "Branches and their singular points", cases: branches::CASES },
    Topic { title: "Forced and damped motions", cases: forced::CASES },
    Topic { title: "Time integration", cases: time::CASES },
    Topic { title: "Records", cases: records::CASES },
    Topic { title: "Structures from files", cases: files::CASES },
];

/// What a case gave.
#[derive(Debug)]
pub struct Outcome {
    /// The case.
    pub case: &'static Case,
    /// Its comparisons, or why there are none.
    pub checks: Result<Vec<Check>, Failure>,
    /// Processor time.
    pub took: Duration,
}

impl Outcome {
    /// Runs a case.
    pub fn of(case: &'static Case) -> Self {
        let start = thread_time();
        let checks = (case.compute)();
        Self { case, checks, took: thread_time().saturating_sub(start) }
    }

    /// Whether there are comparisons, and all of them are within their limits.
    pub fn passes(&self) -> bool {
        self.checks.as_ref().is_ok_and(|checks| !checks.is_empty() && checks.iter().all(Check::passes))
    }
}

/// Runs the cases whose name is `wanted`, topic by topic; `seen` is shown each as soon as it is there.
pub fn run(wanted: impl Fn(&str) -> bool, mut seen: impl FnMut(&Outcome)) -> Vec<(Topic, Vec<Outcome>)> {
    let chosen = |topic: Topic| {
        let cases = topic.cases.iter().filter(|case| wanted(case.name));
        (topic, cases.map(Outcome::of).inspect(&mut seen).collect::<Vec<_>>())
    };
    TOPICS.into_iter().map(chosen).filter(|(_, outcomes)| !outcomes.is_empty()).collect()
}

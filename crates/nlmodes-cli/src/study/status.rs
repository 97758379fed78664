//! `nlmodes-cli study status`.

use nlmodes_study::{Counts, Settings, Study, status};

use crate::Status;
use crate::terminal::print;

/// Says how many cases are in which state. Exit status 1 where some are missing.
pub fn run(study: &Study) -> Status {
    let counts = status(study, Settings::default().jobs());
    let printed = print(&format!("{}\n{}", study.title, text(&counts)));
    if counts.missing > 0 { Status::EndedEarly } else { printed }
}

/// A line for each state.
pub fn text(counts: &Counts) -> String {
    let rows = [
        ("cases", counts.cases, true),
        ("complete", counts.complete, true),
        ("ended early", counts.incomplete, counts.incomplete > 0),
        ("failed", counts.failed, counts.failed > 0),
        ("damaged", counts.damaged, counts.damaged > 0),
        ("missing", counts.missing, true),
    ];
    let lines = rows.iter().filter(|(.., shown)| *shown).map(|(name, n, _)| format!("  {name:<12}{n:>10}"));
    lines.collect::<Vec<_>>().join("\n")
}

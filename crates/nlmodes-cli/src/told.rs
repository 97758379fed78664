//! Messages about completed branches.

use std::path::Path;

use nlmodes_run::{PartOutcome, chain};

use crate::terminal::print;
use crate::{Status, interrupt};

/// Prints how the branches of a part ended, and where its results are.
pub fn part(part: &PartOutcome, quiet: bool) -> Status {
    if let Some(error) = &part.failure {
        say!("error: {}", chain(error.as_ref()));
        return Status::EndedEarly;
    }
    let directory = part.scene.output_directory.display();
    let mut status = Status::Done;
    for ending in part.endings() {
        if !ending.beyond_accuracy.is_empty() {
            say!("warning: {}", ending.beyond_accuracy.join("\n"));
        }
        if !ending.is_complete {
            say!("warning: the computation ended early. {}", ending.line);
            status = Status::EndedEarly;
        } else if !quiet && print(&ending.line) != Status::Done {
            status = Status::EndedEarly;
        }
        if !quiet && !ending.curve.is_empty() {
            _ = print(&ending.curve);
        }
    }
    if status == Status::EndedEarly {
        say!("What was found is in {directory}");
        if interrupt::requested() {
            say!("The same call with `--resume` goes on from there");
        }
        return status;
    }
    if part.tree.not_followed > 0 {
        say!(
            "warning: {} half-branches of branch points were not followed, since there are {} branches",
            part.tree.not_followed,
            part.scene.continuation.max_branches
        );
    }
    written(&part.scene.output_directory, part.scene.files.page, quiet)
}

/// Prints where results are; `has_page` whether there is `report.html`.
pub fn written(directory: &Path, has_page: bool, quiet: bool) -> Status {
    let directory = directory.display();
    match (quiet, has_page) {
        (true, _) => Status::Done,
        (false, true) => print(&format!("Results in {directory}: open {directory}/report.html")),
        (false, false) => print(&format!("Results in {directory}")),
    }
}

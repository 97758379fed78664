//! What is said about branches that are done.

use std::f64::consts::TAU;
use std::time::Duration;

use nlmodes::branches::ComputedBranch;
use nlmodes::modal::{EndReason, Event};
use nlmodes_run::certificate::Certificate;
use nlmodes_run::{PartOutcome, chain};

use crate::terminal::print;
use crate::{Status, interrupt};

/// Says how the branches of a part ended, and where its results are.
pub fn part(part: &PartOutcome, quiet: bool) -> Status {
    if let Some(error) = &part.failure {
        say!("error: {}", chain(error.as_ref()));
        return Status::EndedEarly;
    }
    let (directory, tree) = (&part.scene.output_directory, &part.tree);
    let statuses = tree.branches.iter().enumerate().map(|(number, computed)| {
        let name = if tree.branches.len() > 1 { format!("branch {number}: ") } else { String::new() };
        tell(computed, &name, part.points_time, quiet)
    });
    if statuses.collect::<Vec<_>>().contains(&Status::EndedEarly) {
        say!("What was found is in {}", directory.display());
        if interrupt::requested() {
            say!("The same call with `--resume` goes on from there");
        }
        return Status::EndedEarly;
    }
    if tree.not_followed > 0 {
        let limit = part.scene.continuation.max_branches;
        say!(
            "warning: {} arms of branch points were not followed, since there are {limit} branches",
            tree.not_followed
        );
    }
    if quiet { Status::Done } else { print(&format!("Results in {}", directory.display())) }
}

/// What the certificates of a part say: a sentence a branch, and why each number is to be used or not.
pub fn certificates(part: &PartOutcome) -> String {
    let mut text = String::new();
    for (number, certificate) in part.certificates.iter().enumerate() {
        let name = if part.certificates.len() > 1 { format!(" of branch {number}") } else { String::new() };
        text += &self::certificate(&name, certificate);
    }
    text + &format!("  looked at in {:.1} s\n", part.certificate_time.as_secs_f64())
}

/// What a certificate says, with the name of what it speaks of behind it.
pub fn certificate(name: &str, certificate: &Certificate) -> String {
    let mut text = format!("Certificate{name}: {}\n", certificate.verdict);
    for number in &certificate.numbers {
        text += &format!("  {}: {}: {}\n", number.number.name(), number.usable.name(), number.words);
    }
    text
}

/// Says how a branch ended.
fn tell(computed: &ComputedBranch, name: &str, points_time: Duration, quiet: bool) -> Status {
    let points = &computed.branch.points;
    let at = points.last().map_or_else(String::new, |p| format!(" at {:.6} Hz", p.omega / TAU));
    let end = &computed.branch.end;
    warn_of_accuracy(computed, name);
    let time = points_time.as_secs_f64();
    let advice = advice(computed).unwrap_or_default();
    let line = format!("{name}{} points in {time:.2} s; ended{at}: {}{advice}", points.len(), end.message);
    if end.complete {
        if quiet { Status::Done } else { print(&line) }
    } else {
        say!("warning: the computation ended early. {line}");
        Status::EndedEarly
    }
}

/// What to do where a branch did not end where it was meant to.
fn advice(computed: &ComputedBranch) -> Option<String> {
    let end = &computed.branch.end;
    let wandered = wandered(computed).unwrap_or_default();
    if end.has(EndReason::MaxPoints) {
        return Some(format!("; with a higher continuation.max_points, --resume goes on{wandered}"));
    }
    if !wandered.is_empty() {
        return Some(wandered);
    }
    if computed.left_mode().is_some() || computed.branch.points.iter().any(|p| p.has_event(Event::Resumed)) {
        return None;
    }
    let resonance = computed.branch.points.last()?.resonance.as_ref()?;
    Some(format!(", on the tongue {resonance} (continuation.internal_resonance = \"skip\" leaves it out)"))
}

/// Folds by which an exact branch shows that it follows tongues of internal resonances; a loop has four.
const FOLDS: usize = 6;

/// What an exact branch met that has every internal resonance of its modes.
fn wandered(computed: &ComputedBranch) -> Option<String> {
    let points = &computed.branch.points;
    let folds = points.iter().filter(|p| p.has_event(Event::Fold) || p.has_event(Event::FrequencyFold)).count();
    let modes = computed.structure.modes().len();
    (computed.is_exact() && folds >= FOLDS).then(|| {
        format!(
            "; it turned {folds} times, on tongues of internal resonances with its {modes} modes (fewer method.held_modes have fewer)"
        )
    })
}

/// Most stretches that are named.
const NAMED: usize = 4;

/// Says where the accuracy was not reached: the points are there, and each has its estimate.
fn warn_of_accuracy(computed: &ComputedBranch, name: &str) {
    let Some(reached) = computed.accuracy.filter(|reached| reached.points_beyond > 0) else { return };
    let (beyond, all, [_, most]) = (reached.points_beyond, computed.branch.points.len(), reached.harmonics);
    say!(
        "warning: {name}{beyond} of {all} points do not reach the accuracy with up to {most} harmonics; the largest estimated error is {:.1e} (column error_estimate)",
        reached.largest_estimate
    );
    let stretches = computed.beyond_accuracy();
    for stretch in stretches.iter().take(NAMED) {
        let ([from, to], [first, last]) = (stretch.frequency.map(|omega| omega / TAU), stretch.points);
        let place = if first == last {
            format!("at {from:.6} Hz (point {first})")
        } else {
            format!("between {from:.6} and {to:.6} Hz (points {first} to {last})")
        };
        say!("  not reached {place}: estimate up to {:.1e}", stretch.largest_estimate);
    }
    if stretches.len() > NAMED {
        say!("  and on {} more stretches (accuracy.not_reached in summary.json)", stretches.len() - NAMED);
    }
}

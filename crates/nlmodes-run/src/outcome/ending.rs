//! How branches ended, in words.

use std::f64::consts::TAU;
use std::time::Duration;

use nlmodes::branches::ComputedBranch;
use nlmodes::modal::{EndReason, Event};
use nlmodes_scene::counted;

use super::curve::blocks;

/// How a branch ended, in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ending {
    /// Its points, their time, where and why it ended, and what to do where it did not end as it was meant to.
    pub line: String,
    /// Its frequency over the energy as a line of block characters; empty for a few points.
    pub curve: String,
    /// Whether it ended where it was meant to.
    pub is_complete: bool,
    /// Where the accuracy was not reached, though the points are there and each has its estimate; empty where it was,
    /// or none was asked for.
    pub beyond_accuracy: Vec<String>,
}

impl Ending {
    /// `name` precedes the sentences, as `branch 1: `.
    pub(super) fn new(computed: &ComputedBranch, name: &str, time: Duration) -> Self {
        let (points, end) = (&computed.branch.points, &computed.branch.end);
        let at = points.last().map_or_else(String::new, |p| format!(" at {:.6} Hz", p.omega / TAU));
        let (seconds, advice) = (time.as_secs_f64(), advice(computed).unwrap_or_default());
        let stability = match computed.stability_time.as_secs_f64() {
            little if little < 0.005 => String::new(),
            seconds => format!(", their stability in {seconds:.2} s"),
        };
        Self {
            line: format!(
                "{name}{} in {seconds:.2} s{stability}; ended{at}: {}{advice}",
                counted(points.len(), "point"),
                end.message
            ),
            curve: blocks(computed).unwrap_or_default(),
            is_complete: end.complete,
            beyond_accuracy: beyond_accuracy(computed, name),
        }
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
    let resonance = computed.branch.points.last()?.resonance.filter(|resonance| !end.is_on(*resonance))?;
    // Advice that was taken already is not given.
    let advice = match computed.skips_internal_resonances() {
        true => "",
        false => " (continuation.internal_resonance = \"skip\" leaves it out)",
    };
    Some(format!(", on the internal-resonance branch {resonance}{advice}"))
}

/// Folds by which an exact branch shows that it follows internal-resonance branches; a loop has four.
const FOLDS: usize = 6;

/// What an exact branch met that has every internal resonance of its modes.
fn wandered(computed: &ComputedBranch) -> Option<String> {
    let points = &computed.branch.points;
    let folds = points.iter().filter(|p| p.has_event(Event::Fold) || p.has_event(Event::FrequencyFold)).count();
    let modes = computed.structure.n_coupled_modes();
    (computed.is_exact() && folds >= FOLDS).then(|| {
        format!(
            "; it turned {folds} times, on tongues of internal resonances with its {modes} modes (fewer \
                method.held_modes have fewer)"
        )
    })
}

/// Most segments that are named.
const NAMED: usize = 4;

fn beyond_accuracy(computed: &ComputedBranch, name: &str) -> Vec<String> {
    let Some(reached) = computed.accuracy.filter(|reached| reached.points_beyond > 0) else { return Vec::new() };
    let (beyond, all, [_, most]) = (reached.points_beyond, computed.branch.points.len(), reached.harmonics);
    let mut lines = vec![format!(
        "{name}{beyond} of {all} points do not reach the accuracy with up to {most} harmonics; the largest estimated \
            error is {:.1e} (column error_estimate)",
        reached.largest_estimate
    )];
    let stretches = computed.beyond_accuracy();
    lines.extend(stretches.iter().take(NAMED).map(|stretch| {
        let ([from, to], [first, last]) = (stretch.frequency.map(|omega| omega / TAU), stretch.points);
        let place = if first == last {
            format!("at {from:.6} Hz (point {first})")
        } else {
            format!("between {from:.6} and {to:.6} Hz (points {first} to {last})")
        };
        format!("  not reached {place}: estimate up to {:.1e}", stretch.largest_estimate)
    }));
    if stretches.len() > NAMED {
        let more = stretches.len() - NAMED;
        lines.push(format!("  and on {more} more segments (accuracy.not_reached in summary.json)"));
    }
    lines
}

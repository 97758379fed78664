use crate::raw::{DEFAULT_MAX_BRANCHES, DEFAULT_MAX_POINTS, RawContinuation};
use crate::rule::number;
use crate::scene::{AtBranchPoint, Continuation, FrequencyDirection, InternalResonance, Start};
use crate::{Findings, Problem};

/// With `has_responses` it need not say where a branch ends: responses have levels and windows of their own.
pub fn check(raw: &RawContinuation, has_responses: bool, findings: &mut Findings<'_>) -> Option<Continuation> {
    if let Some(window) = raw.frequency_hz {
        check_window(window, findings);
        check_start(raw.start_frequency_hz, window, findings);
    }
    let has_end = findings.has("continuation.max_energy_ratio") || findings.has("continuation.frequency_hz");
    if !has_end && !has_responses {
        let problem = Problem::error("`continuation` does not say where the branch ends")
            .help("max_energy_ratio = 20.0 ends it at 20 times the energy at grazing, frequency_hz = [50.0, 66.5] at a frequency");
        findings.put("continuation", problem, "expected `max_energy_ratio`, `frequency_hz` or both in this table");
    }
    check_energy(raw, findings);
    check_choices(raw, findings);
    Some(Continuation {
        max_energy_ratio: raw.max_energy_ratio,
        frequency_hz: raw.frequency_hz,
        max_points: raw.max_points.unwrap_or(DEFAULT_MAX_POINTS) as usize,
        at_branch_point: raw.at_branch_point.unwrap_or(AtBranchPoint::Stay),
        max_branches: raw.max_branches.unwrap_or(DEFAULT_MAX_BRANCHES) as usize,
        internal_resonance: raw.internal_resonance.unwrap_or(InternalResonance::Follow),
        start: start(raw),
    })
}

fn start(raw: &RawContinuation) -> Start {
    let direction = raw.direction.unwrap_or(FrequencyDirection::Up);
    match (raw.start_frequency_hz, raw.start_energy_ratio) {
        (Some(hz), _) => Start::Frequency { hz, direction },
        (None, Some(ratio)) => Start::Energy { ratio, direction },
        (None, None) => Start::Grazing,
    }
}

fn check_energy(raw: &RawContinuation, findings: &mut Findings<'_>) {
    let path = "continuation.start_energy_ratio";
    let (Some(ratio), Some(max)) = (raw.start_energy_ratio, raw.max_energy_ratio) else { return };
    if ratio > max {
        let problem = Problem::error(format!("`{path}` lies beyond the end of the branch"));
        let problem = match findings.document().place("continuation.max_energy_ratio") {
            Some(place) => problem.with(place.value.clone(), "the end"),
            None => problem,
        };
        findings.put(path, problem, format!("found {}, expected at most {}", findings.written(path), number(max)));
    }
}

/// Choices that exclude each other, or mean nothing without another.
fn check_choices(raw: &RawContinuation, findings: &mut Findings<'_>) {
    let elsewhere = raw.start_frequency_hz.is_some() || raw.start_energy_ratio.is_some();
    if raw.direction.is_some() && !elsewhere {
        let problem = Problem::warning("`continuation.direction` has no effect");
        let label = "only a branch with `start_frequency_hz` or `start_energy_ratio` uses it";
        findings.put("continuation.direction", problem, label);
    }
    if raw.start_frequency_hz.is_some() && raw.start_energy_ratio.is_some() {
        let problem = Problem::error("a branch has one start, and this scene has two");
        let label = "expected this or `start_frequency_hz`, not both";
        findings.put("continuation.start_energy_ratio", problem, label);
    }
    let all = raw.at_branch_point == Some(AtBranchPoint::All);
    if raw.max_branches.is_some() && !all {
        let problem = Problem::warning("`continuation.max_branches` has no effect");
        findings.put("continuation.max_branches", problem, "only `at_branch_point = \"all\"` uses it");
    }
    if all && raw.internal_resonance == Some(InternalResonance::Skip) {
        let problem = Problem::error("all arms are to be followed, and tongues to be skipped");
        let label = "with `at_branch_point = \"all\"`, \"follow\" was expected here";
        findings.put("continuation.internal_resonance", problem, label);
    }
    if all && elsewhere && raw.direction == Some(FrequencyDirection::Both) {
        let problem = Problem::error("a tree of branches has one start in one direction");
        let label = "with `at_branch_point = \"all\"`, \"up\" or \"down\" was expected here";
        findings.put("continuation.direction", problem, label);
    }
}

fn check_window([low, high]: [f64; 2], findings: &mut Findings<'_>) {
    if low < high {
        return;
    }
    let path = "continuation.frequency_hz";
    let found = findings.written(path);
    if low > high {
        let problem = Problem::error(format!("`{path}` is the wrong way round"));
        let problem = problem.help(format!("write frequency_hz = [{}, {}]", number(high), number(low)));
        findings.put(path, problem, format!("found {found}, expected the lower frequency first, in Hz"));
    } else {
        let problem = Problem::error(format!("`{path}` is an empty window"));
        findings.put(path, problem, format!("found {found}, expected two different frequencies, in Hz"));
    }
}

fn check_start(start: Option<f64>, [low, high]: [f64; 2], findings: &mut Findings<'_>) {
    let path = "continuation.start_frequency_hz";
    if start.is_some_and(|start| low < high && !(low..=high).contains(&start)) {
        let problem = Problem::error(format!("`{path}` lies outside the frequency window"));
        let problem = match findings.document().place("continuation.frequency_hz") {
            Some(place) => problem.with(place.value.clone(), "the window"),
            None => problem,
        };
        let label = format!("found {}, expected {} to {}, in Hz", findings.written(path), number(low), number(high));
        findings.put(path, problem, label);
    }
}

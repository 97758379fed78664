use crate::config::raw::{DEFAULT_MAX_POINTS, RawContinuation};
use crate::config::rule::number;
use crate::config::scene::{Continuation, FrequencyDirection, Start};
use crate::config::{Findings, Problem};

pub fn check(raw: &RawContinuation, findings: &mut Findings<'_>) -> Option<Continuation> {
    if let Some(window) = raw.frequency_hz {
        check_window(window, findings);
        check_start(raw.start_frequency_hz, window, findings);
    }
    if !findings.has("continuation.max_energy_ratio") && !findings.has("continuation.frequency_hz") {
        let problem = Problem::error("`continuation` does not say where the branch ends")
            .help("max_energy_ratio = 20.0 ends it at 20 times the energy at grazing, frequency_hz = [50.0, 66.5] at a frequency");
        findings.put("continuation", problem, "expected `max_energy_ratio`, `frequency_hz` or both in this table");
    }
    if raw.direction.is_some() && !findings.has("continuation.start_frequency_hz") {
        let problem = Problem::warning("`continuation.direction` has no effect");
        findings.put("continuation.direction", problem, "only a branch with `start_frequency_hz` uses it");
    }
    Some(Continuation {
        max_energy_ratio: raw.max_energy_ratio,
        frequency_hz: raw.frequency_hz,
        max_points: raw.max_points.unwrap_or(DEFAULT_MAX_POINTS) as usize,
        start: start(raw),
    })
}

fn start(raw: &RawContinuation) -> Start {
    let direction = raw.direction.unwrap_or(FrequencyDirection::Up);
    raw.start_frequency_hz.map_or(Start::Grazing, |hz| Start::Frequency { hz, direction })
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

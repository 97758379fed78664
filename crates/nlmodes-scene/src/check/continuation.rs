use crate::rule::number;
use crate::scene::{AtBranchPoint, Continuation, FrequencyDirection, InternalResonance};
use crate::{Diagnostic, Diagnostics};

/// Where a branch starts and ends, of a structure with `[[spring]]`, or with any laws of force.
pub fn check(branch: &Continuation, [has_springs, has_laws]: [bool; 2], diagnostics: &mut Diagnostics<'_>) {
    if let Some(window) = branch.frequency_hz {
        check_window(window, diagnostics);
        check_start(branch.start_frequency_hz, window, diagnostics);
    }
    check_energy(branch, has_springs, diagnostics);
    check_beginning(branch, has_laws, diagnostics);
    check_choices(branch, diagnostics);
}

fn check_energy(branch: &Continuation, has_springs: bool, diagnostics: &mut Diagnostics<'_>) {
    let path = "continuation.start_energy_ratio";
    let Some(ratio) = branch.start_energy_ratio else { return };
    let max = branch.energy_limit(has_springs || branch.frequency_hz.is_some());
    if ratio > max {
        let diagnostic = Diagnostic::error(format!("`{path}` is beyond the end of the branch"));
        let diagnostic = match diagnostics.document().place("continuation.max_energy_ratio") {
            Some(place) => diagnostic.with(place.value.clone(), "the end"),
            None => diagnostic,
        };
        diagnostics.put(
            path,
            diagnostic,
            format!("found {}, expected at most {}", diagnostics.written(path), number(max)),
        );
    }
}

/// Where a mode of a structure with springs begins.
fn check_beginning(branch: &Continuation, has_laws: bool, diagnostics: &mut Diagnostics<'_>) {
    let [energy, amplitude] = ["continuation.start_energy_j", "continuation.start_amplitude_m"];
    if branch.start_energy_j.is_some() && branch.start_amplitude_m.is_some() {
        let diagnostic = Diagnostic::error("a mode has one beginning, and this scene has two");
        diagnostics.put(amplitude, diagnostic, "expected this or `start_energy_j`, not both");
    }
    for path in [energy, amplitude].into_iter().filter(|path| !has_laws && diagnostics.has(path)).collect::<Vec<_>>() {
        let diagnostic = Diagnostic::warning(format!("`{path}` has no effect"));
        diagnostics.put(path, diagnostic, "only modes of structures with [[spring]] begin there; others at grazing");
    }
}

/// Choices that exclude each other, or mean nothing without another.
fn check_choices(branch: &Continuation, diagnostics: &mut Diagnostics<'_>) {
    let elsewhere = branch.start_frequency_hz.is_some() || branch.start_energy_ratio.is_some();
    if diagnostics.has("continuation.direction") && !elsewhere {
        let diagnostic = Diagnostic::warning("`continuation.direction` has no effect");
        let label = "only a branch with `start_frequency_hz` or `start_energy_ratio` uses it";
        diagnostics.put("continuation.direction", diagnostic, label);
    }
    if branch.start_frequency_hz.is_some() && branch.start_energy_ratio.is_some() {
        let diagnostic = Diagnostic::error("a branch has one start, and this scene has two");
        let label = "expected this or `start_frequency_hz`, not both";
        diagnostics.put("continuation.start_energy_ratio", diagnostic, label);
    }
    let all = branch.at_branch_point == AtBranchPoint::All;
    if diagnostics.has("continuation.max_branches") && !all {
        let diagnostic = Diagnostic::warning("`continuation.max_branches` has no effect");
        diagnostics.put("continuation.max_branches", diagnostic, "only `at_branch_point = \"all\"` uses it");
    }
    if all && branch.internal_resonance == InternalResonance::Skip {
        let diagnostic =
            Diagnostic::error("half-branches cannot all be followed while internal-resonance branches are skipped");
        let label = "with `at_branch_point = \"all\"`, \"follow\" was expected here";
        diagnostics.put("continuation.internal_resonance", diagnostic, label);
    }
    if all && elsewhere && branch.direction == FrequencyDirection::Both {
        let diagnostic = Diagnostic::error("a tree of branches has one start in one direction");
        let label = "with `at_branch_point = \"all\"`, \"up\" or \"down\" was expected here";
        diagnostics.put("continuation.direction", diagnostic, label);
    }
}

fn check_window([low, high]: [f64; 2], diagnostics: &mut Diagnostics<'_>) {
    if low < high {
        return;
    }
    let path = "continuation.frequency_hz";
    let found = diagnostics.written(path);
    if low > high {
        let diagnostic = Diagnostic::error(format!("`{path}` is the wrong way round"));
        let diagnostic = diagnostic.help(format!("write frequency_hz = [{}, {}]", number(high), number(low)));
        diagnostics.put(path, diagnostic, format!("found {found}, expected the lower frequency first, in Hz"));
    } else {
        let diagnostic = Diagnostic::error(format!("`{path}` is an empty window"));
        diagnostics.put(path, diagnostic, format!("found {found}, expected two different frequencies, in Hz"));
    }
}

fn check_start(start: Option<f64>, [low, high]: [f64; 2], diagnostics: &mut Diagnostics<'_>) {
    let path = "continuation.start_frequency_hz";
    if start.is_some_and(|start| low < high && !(low..=high).contains(&start)) {
        let diagnostic = Diagnostic::error(format!("`{path}` is outside the frequency window"));
        let diagnostic = match diagnostics.document().place("continuation.frequency_hz") {
            Some(place) => diagnostic.with(place.value.clone(), "the window"),
            None => diagnostic,
        };
        let label = format!("found {}, expected {} to {}, in Hz", diagnostics.written(path), number(low), number(high));
        diagnostics.put(path, diagnostic, label);
    }
}

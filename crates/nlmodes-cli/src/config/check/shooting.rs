//! What exact shooting has no use for.

use nlmodes::timestep::MAX_SHOOTING_MODES;

use crate::config::raw::RawMethod;
use crate::config::scene::{ContactSolver, Switching, Symmetry};
use crate::config::{Findings, Problem};

pub fn check(method: &RawMethod, findings: &mut Findings<'_>) {
    if method.symmetry == Some(Symmetry::None) {
        let path = "method.symmetry";
        let problem = Problem::error("shooting finds motions that are even in time")
            .help("method.kind = \"ms-hbm\" finds others too");
        findings.put(path, problem, "with method \"shooting\", \"even\" was expected here");
    }
    if method.harmonics.as_ref().is_some_and(|list| list.len() > 1) {
        let path = "method.harmonics";
        let problem = Problem::error("a list of numbers of harmonics makes no sense with shooting")
            .help("its motions are exact whatever the number; it says how many harmonics of them are written");
        findings.put(path, problem, "expected one whole number");
    }
    if method.accuracy.is_some() {
        let problem = Problem::error("`method.accuracy` is of no use to shooting")
            .help("its motions are exact; method.harmonics says how many harmonics of them are written");
        findings.put("method.accuracy", problem, "expected `harmonics` instead");
    }
    if method.switching == Some(Switching::Sampled) {
        let problem = Problem::warning("`method.switching` has no effect");
        findings.put("method.switching", problem, "shooting finds the instants of touching and leaving as roots");
    }
    if method.contact_solver.is_some_and(|solver| solver != ContactSolver::ActiveSet) {
        let problem = Problem::warning("`method.contact_solver` has no effect");
        findings.put(
            "method.contact_solver",
            problem,
            "shooting solves contact problems at the start of a motion only",
        );
    }
}

/// Refuses more held modes than shooting is sensible for; those of a beam that leave its stops at rest are known only when they are computed.
pub fn check_size(modes: Option<usize>, findings: &mut Findings<'_>) {
    let Some(found) = modes.filter(|modes| *modes > MAX_SHOOTING_MODES) else { return };
    let path = "method.held_modes";
    let problem = Problem::error(format!("shooting with {found} modes costs too much"))
        .help("the modes left out answer statically; or take fewer `structure.elements`, or method.kind = \"ms-hbm\"");
    let label = format!("expected `held_modes` in this table: a whole number from 1 to {MAX_SHOOTING_MODES}");
    findings.put(path, problem, label);
}

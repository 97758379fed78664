//! What exact shooting has no use for.

use nlmodes::timestep::MAX_SHOOTING_MODES;

use crate::raw::RawMethod;
use crate::scene::{ContactSolver, Switching, Symmetry};
use crate::{Diagnostic, Diagnostics};

pub fn check(method: &RawMethod, diagnostics: &mut Diagnostics<'_>) {
    if method.symmetry == Some(Symmetry::None) {
        let path = "method.symmetry";
        let diagnostic = Diagnostic::error("shooting finds motions that are even in time")
            .help("method.kind = \"ms-hbm\" finds others too");
        diagnostics.put(path, diagnostic, "with method \"shooting\", \"even\" was expected here");
    }
    if method.harmonics.as_ref().is_some_and(|list| list.len() > 1) {
        let path = "method.harmonics";
        let diagnostic = Diagnostic::error("a list of numbers of harmonics makes no sense with shooting")
            .help("its motions are exact whatever the number; it says how many harmonics of them are written");
        diagnostics.put(path, diagnostic, "expected one whole number");
    }
    if method.accuracy.is_some() {
        let diagnostic = Diagnostic::error("`method.accuracy` is of no use to shooting")
            .help("its motions are exact; method.harmonics says how many harmonics of them are written");
        diagnostics.put("method.accuracy", diagnostic, "expected `harmonics` instead");
    }
    if method.switching == Some(Switching::Sampled) {
        let diagnostic = Diagnostic::warning("`method.switching` has no effect");
        diagnostics.put("method.switching", diagnostic, "shooting finds the instants of touching and leaving as roots");
    }
    if method.contact_solver.is_some_and(|solver| solver != ContactSolver::ActiveSet) {
        let diagnostic = Diagnostic::warning("`method.contact_solver` has no effect");
        diagnostics.put(
            "method.contact_solver",
            diagnostic,
            "shooting solves contact problems at the start of a motion only",
        );
    }
}

/// Modes up to which a branch by shooting takes seconds.
const MODES_OF_SECONDS: usize = 40;

/// Evaluations per point of a branch of a structure with this many modes: most are for the search for other branches
/// where contacts change.
const EVALUATIONS: f64 = 250.0;

/// Seconds for an evaluation with a hundred modes, which goes with the third power of their number (release build).
const SECONDS: f64 = 8e-4;

/// Warns of more modes than are sensible.
fn warn_of_size(found: usize, at: &str, diagnostics: &mut Diagnostics<'_>) {
    let seconds = EVALUATIONS * SECONDS * (found as f64 / 100.0).powi(3);
    let text =
        format!("shooting with {found} modes: some {seconds:.1} s a point, and internal resonances with all of them");
    let diagnostic = Diagnostic::warning(text).help(
        "an exact branch follows the tongues of all of them, in small steps; `held_modes = 20` in this table \
         leaves the others to answer statically",
    );
    diagnostics.put(at, diagnostic, "expected `held_modes` in this table, 5 to 40");
}

/// Rejects too many fixed-interface modes for shooting; those of a beam that are not coupled to its stops are known
/// only after computation.
pub fn check_size(modes: Option<usize>, diagnostics: &mut Diagnostics<'_>) {
    let path = "method.held_modes";
    let Some(found) = modes.filter(|modes| *modes > MODES_OF_SECONDS) else { return };
    if found <= MAX_SHOOTING_MODES {
        return warn_of_size(found, path, diagnostics);
    }
    let diagnostic = Diagnostic::error(format!("shooting with {found} modes costs too much"))
        .help("the modes left out answer statically; or take fewer `structure.elements`, or method.kind = \"ms-hbm\"");
    let label = format!("expected `held_modes` in this table: a whole number from 1 to {MAX_SHOOTING_MODES}");
    diagnostics.put(path, diagnostic, label);
}

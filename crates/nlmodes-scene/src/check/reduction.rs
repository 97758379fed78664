use super::response::Places;
use crate::raw::RawAnalysis;
use crate::scene::{MethodKind, Reduction, ReductionKind};
use crate::{Diagnostic, Diagnostics};

/// How the structure is reduced; `None` is the paper's way with defaults.
pub fn check(
    scene: &RawAnalysis,
    (default, places): (ReductionKind, &Places<'_>),
    diagnostics: &mut Diagnostics<'_>,
) -> Option<Reduction> {
    let written = scene.reduction.unwrap_or_default();
    let kind = written.kind.unwrap_or(default);
    if kind == ReductionKind::HeldModes && matches!(places, Places::Bodies(_)) {
        let diagnostic = Diagnostic::error("several structures are reduced by their open modes");
        let diagnostic =
            diagnostic.help("contacts between bodies have no node of their own whose mass could be left out");
        diagnostics.put("reduction.kind", diagnostic, "expected \"open-modes\"");
    }
    if matches!(places, Places::Rows) {
        of_reduced(kind, diagnostics);
    }
    if written.modes.is_some() && written.up_to_hz.is_some() {
        let diagnostic = Diagnostic::error("`reduction.modes` and `reduction.up_to_hz` are two ways to say the same");
        diagnostics.put("reduction.up_to_hz", diagnostic, "expected one of them");
    }
    for key in ["modes", "up_to_hz"] {
        let path = format!("reduction.{key}");
        if kind == ReductionKind::HeldModes && diagnostics.has(&path) {
            let diagnostic = Diagnostic::warning(format!("`{path}` has no effect"));
            let diagnostic = match scene.has_responses() {
                true => diagnostic.help("a response has as many modes as its harmonics reach"),
                false => diagnostic.help("`method.held_modes` is the number of held modes"),
            };
            diagnostics.put(&path, diagnostic, "only reduction.kind = \"open-modes\" uses it");
        }
    }
    let path = "method.mass_redistribution";
    if kind == ReductionKind::OpenModes && diagnostics.has(path) && !matches!(places, Places::Rows) {
        let diagnostic = Diagnostic::warning(format!("`{path}` has no effect"));
        diagnostics.put(path, diagnostic, "with open modes the contacts have no mass, and none is moved");
    }
    if let (ReductionKind::OpenModes, Some(MethodKind::Shooting), Some(held)) =
        (kind, scene.method.kind, scene.method.held_modes)
    {
        let diagnostic = Diagnostic::warning("`method.held_modes` leaves out modes of the reduced structure");
        let diagnostic = diagnostic.help("`reduction.modes` says how many modes there are");
        diagnostics.put("method.held_modes", diagnostic, format!("found {held}"));
    }
    let plain = kind == ReductionKind::HeldModes && default == kind;
    (!plain).then_some(Reduction { kind: Some(kind), ..written })
}

/// A structure that was reduced elsewhere has no mass that could be taken away from its contacts.
fn of_reduced(kind: ReductionKind, diagnostics: &mut Diagnostics<'_>) {
    let help = "what the mass of the contact nodes was is not in its modes; their share of it is kept";
    let refuse = |path: &str, label: &str, diagnostics: &mut Diagnostics<'_>| {
        let title = format!("`{path}` is not possible for a structure that was reduced elsewhere");
        diagnostics.put(path, Diagnostic::error(title).help(help), label);
    };
    if kind == ReductionKind::HeldModes {
        refuse("reduction.kind", "expected \"open-modes\", or leave it out", diagnostics);
    }
    let path = "method.mass_redistribution";
    if diagnostics.has(path) {
        refuse(path, "leave it out", diagnostics);
    }
}

use super::response::Places;
use crate::raw::{RawReduction, RawStudy};
use crate::scene::{MethodKind, Reduction, ReductionKind};
use crate::{Findings, Problem};

/// How the structure is reduced; `None` is the paper's way with defaults.
pub fn check(
    raw: Option<&RawReduction>,
    scene: &RawStudy,
    (default, places): (ReductionKind, &Places<'_>),
    findings: &mut Findings<'_>,
) -> Option<Reduction> {
    let empty = RawReduction::default();
    let raw = raw.unwrap_or(&empty);
    let kind = raw.kind.unwrap_or(default);
    if kind == ReductionKind::HeldModes && matches!(places, Places::Bodies(_)) {
        let problem = Problem::error("several structures are reduced by their open modes");
        let problem = problem.help("contacts between bodies have no node of their own whose mass could be left out");
        findings.put("reduction.kind", problem, "expected \"open-modes\"");
    }
    if raw.modes.is_some() && raw.up_to_hz.is_some() {
        let problem = Problem::error("`reduction.modes` and `reduction.up_to_hz` are two ways to say the same");
        findings.put("reduction.up_to_hz", problem, "expected one of them");
    }
    for key in ["modes", "up_to_hz"] {
        let path = format!("reduction.{key}");
        if kind == ReductionKind::HeldModes && findings.has(&path) {
            let problem = Problem::warning(format!("`{path}` has no effect"));
            let problem = match scene.response.as_ref().is_some_and(|responses| !responses.is_empty()) {
                true => problem.help("a response has as many modes as its harmonics reach"),
                false => problem.help("`method.held_modes` is the number of held modes"),
            };
            findings.put(&path, problem, "only reduction.kind = \"open-modes\" uses it");
        }
    }
    let path = "method.mass_redistribution";
    let method = scene.method.as_ref().and_then(|method| method.kind).unwrap_or(MethodKind::MsHbm);
    if kind == ReductionKind::OpenModes && findings.has(path) {
        let problem = Problem::warning(format!("`{path}` has no effect"));
        findings.put(path, problem, "with open modes the contacts have no mass, and none is moved");
    }
    if let (ReductionKind::OpenModes, MethodKind::Shooting, Some(held)) =
        (kind, method, scene.method.as_ref().and_then(|method| method.held_modes))
    {
        let problem = Problem::warning("`method.held_modes` leaves out modes of the reduced structure");
        let problem = problem.help("`reduction.modes` says how many modes there are");
        findings.put("method.held_modes", problem, format!("found {held}"));
    }
    let (modes, up_to_hz) = (raw.modes.map(|n| n as usize), raw.up_to_hz);
    let plain = kind == ReductionKind::HeldModes && default == kind;
    (!plain).then_some(Reduction { kind, modes, up_to_hz })
}

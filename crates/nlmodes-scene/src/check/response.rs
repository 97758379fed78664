//! Damping, loads and responses: what must hold between their values.

mod loads;
mod place;

use crate::raw::{RawAnalysis, RawPlace, RawResponse};
use crate::rule::number;
use crate::scene::{BaseMotion, Damping, Force, Method, MethodKind, Response, ResponseKind, StopOfBase};
use crate::{Diagnostic, Diagnostics};
pub use loads::own_damping;
pub use place::Places;

/// What a scene says about damped and forced motions.
#[derive(Debug, Default)]
pub struct Responses {
    pub damping: Option<Damping>,
    pub forces: Vec<Force>,
    pub base_motion: Option<BaseMotion>,
    pub responses: Vec<Response>,
}

/// The parts that are sound; those that are not are in the diagnostics.
pub fn check(
    raw: &RawAnalysis,
    places: &Places<'_>,
    method: Option<&Method>,
    diagnostics: &mut Diagnostics<'_>,
) -> Responses {
    let written = raw.response.as_deref().unwrap_or_default();
    let damping = raw.damping.as_ref().and_then(|raw| loads::damping(raw, places, diagnostics));
    let forces = loads::forces(raw, places, diagnostics);
    let base_motion = loads::base_motion(raw, places, diagnostics);
    if let (Some(method), true) = (method, raw.has_responses()) {
        of_method(method, diagnostics);
    }
    if written.is_empty() && raw.transient.is_none() {
        without_effect(raw, diagnostics);
    }
    let mut responses: Vec<Response> =
        written.iter().enumerate().filter_map(|(i, r)| response(i, r, raw, places, diagnostics)).collect();
    if written.is_empty() && raw.has_laws() && raw.transient.is_none() {
        responses.push(Response::nonlinear_mode());
    }
    if !responses.is_empty() && responses.iter().all(|response| response.kind.is_forced()) {
        for path in ["continuation.max_energy_ratio", "continuation.frequency_hz"] {
            has_no_effect(
                path,
                "it ends modes; responses to loads end at their own `frequency_hz` and levels",
                diagnostics,
            );
        }
    }
    if let Some(method) = method {
        harmonics_of_forces(raw, &responses, method, diagnostics);
    }
    Responses { damping, forces, base_motion, responses }
}

/// A motion of so many harmonics follows no force in a higher one; over several periods of the force its harmonics are
/// as many times higher.
fn harmonics_of_forces(raw: &RawAnalysis, responses: &[Response], method: &Method, diagnostics: &mut Diagnostics<'_>) {
    let forced = responses.iter().filter(|response| response.kind.is_forced());
    let Some(times) = forced.map(|response| response.subharmonic).max() else { return };
    for (i, force) in raw.force.iter().flatten().enumerate() {
        let needed = times * force.harmonic.unwrap_or(1) as usize;
        if needed > method.harmonics {
            let diagnostic = Diagnostic::error(format!(
                "a force in harmonic {needed} of the motion, which has {}",
                method.harmonics
            ));
            let diagnostic = match times {
                1 => diagnostic.help("more `method.harmonics`"),
                _ => diagnostic.help(format!(
                    "more `method.harmonics`: with `subharmonic = {times}` harmonic 1 of the \
                    force is {times} of the motion"
                )),
            };
            diagnostics.put(
                &format!("force.{i}.harmonic"),
                diagnostic,
                format!("expected at most {}", method.harmonics / times),
            );
        }
    }
}

/// Loads and damping of a scene that has no use for them.
fn without_effect(raw: &RawAnalysis, diagnostics: &mut Diagnostics<'_>) {
    let keys = [
        ("damping", raw.damping.is_some()),
        ("force", raw.force.is_some()),
        ("base_motion", raw.base_motion.is_some()),
    ];
    for (key, _) in keys.into_iter().filter(|(_, there)| *there) {
        let diagnostic = Diagnostic::warning(format!("`{key}` has no effect without a response"));
        let help = "[response] with kind = \"frequency\", \"force\", \"phase-resonance\" or \"damped-mode\" uses it";
        diagnostics.put(key, diagnostic.help(help), "the scene computes the conservative nonlinear mode");
    }
}

/// Says of a key that is there that no response uses it.
fn has_no_effect(path: &str, why: &str, diagnostics: &mut Diagnostics<'_>) {
    if diagnostics.has(path) {
        diagnostics.put(path, Diagnostic::warning(format!("`{path}` has no effect on responses")), why);
    }
}

fn of_method(method: &Method, diagnostics: &mut Diagnostics<'_>) {
    let beginning = "a response begins at the ends of its window, at rest, or at the linear resonance";
    let unused = [
        (
            "method.held_modes",
            "responses are computed in open modes: reduction.kind = \"open-modes\" and `reduction.modes` say how many",
        ),
        ("method.symmetry", "responses have cosines and sines"),
        ("continuation.internal_resonance", "internal-resonance branches are part of a response"),
        ("continuation.start_frequency_hz", beginning),
        ("continuation.start_energy_ratio", beginning),
    ];
    unused.iter().for_each(|(path, why)| has_no_effect(path, why, diagnostics));
    if method.kind == MethodKind::Shooting {
        let diagnostic = Diagnostic::error("responses are computed with method \"ms-hbm\" or \"hbm\"");
        diagnostics.put("method.kind", diagnostic, "expected \"ms-hbm\" or \"hbm\"");
    }
    if method.harmonics_list.len() > 1 {
        let diagnostic = Diagnostic::error("responses are computed with one number of harmonics");
        diagnostics.put("method.harmonics", diagnostic, "expected one whole number");
    }
}

fn response(
    i: usize,
    raw: &RawResponse,
    scene: &RawAnalysis,
    places: &Places<'_>,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<Response> {
    let kind = raw.response.kind;
    let is_mode = !kind.is_forced();
    let is_sound = [
        has_damping(i, kind, scene, places, diagnostics),
        has_frequency(i, raw, kind, diagnostics),
        has_load(i, kind, scene, is_mode, diagnostics),
    ];
    uses_its_keys(i, kind, diagnostics);
    let is_sound = [is_sound, [sweeps(i, raw, scene, diagnostics), true, true]].concat();
    let levels = if is_mode { Some(Vec::new()) } else { levels(i, raw, scene, diagnostics) };
    let base = format!("response.{i}.drive");
    let drive = if raw.drive_m.is_some() || raw.drive_node.is_some() || raw.drive_row.is_some() {
        let keys = ["m", "node", "direction", "structure", "row"].map(|key| format!("{base}_{key}"));
        let (direction, structure) = (raw.drive_direction.clone(), raw.drive_structure);
        let (at_m, node, row) = (raw.drive_m, raw.drive_node, raw.drive_row);
        let written = RawPlace { at_m, node, direction, structure, row };
        Some(places.place(&written, &keys, diagnostics)?)
    } else {
        None
    };
    if is_sound.contains(&false) {
        return None;
    }
    Some(Response { levels: levels?, drive, ..raw.response.clone() })
}

fn has_damping(
    i: usize,
    kind: ResponseKind,
    scene: &RawAnalysis,
    places: &Places<'_>,
    diagnostics: &mut Diagnostics<'_>,
) -> bool {
    if scene.damping.is_some() || kind == ResponseKind::Mode || places.are_damped() {
        return true;
    }
    let diagnostic = Diagnostic::error(format!("a response of kind \"{}\" needs a table [damping]", kind.name()));
    let help = "[damping] with ratio = 0.01 damps all modes with 1 %";
    diagnostics.put(
        &format!("response.{i}.kind"),
        diagnostic.help(help),
        "nothing else bounds the motion at a resonance",
    );
    false
}

/// The frequency or the window that the kind needs.
fn has_frequency(i: usize, raw: &RawResponse, kind: ResponseKind, diagnostics: &mut Diagnostics<'_>) -> bool {
    let path = |key: &str| format!("response.{i}.{key}");
    let given = raw.response.frequency_hz.as_slice();
    let wanted = if kind == ResponseKind::Force { 1 } else { 2 };
    let is_needed = matches!(kind, ResponseKind::Force | ResponseKind::Frequency);
    let expected = match wanted {
        1 => "expected one frequency, as frequency_hz = 41.0",
        _ => "expected the lowest and the highest frequency, as frequency_hz = [39.0, 43.0]",
    };
    if given.is_empty() && is_needed {
        let diagnostic = Diagnostic::error(format!("`{}` is missing", path("frequency_hz")));
        diagnostics.put(&path("kind"), diagnostic, expected);
        return false;
    }
    if !given.is_empty() && given.len() != wanted {
        let diagnostic = Diagnostic::error(match wanted {
            1 => format!("a response of kind \"{}\" needs a single frequency", kind.name()),
            _ => format!("a response of kind \"{}\" needs a frequency window", kind.name()),
        });
        diagnostics.put(&path("frequency_hz"), diagnostic, expected);
        return false;
    }
    if given.windows(2).any(|w| w[0] >= w[1]) {
        let diagnostic = Diagnostic::error(format!("`{}` is an empty window", path("frequency_hz")));
        diagnostics.put(&path("frequency_hz"), diagnostic, expected);
        return false;
    }
    true
}

fn has_load(
    i: usize,
    kind: ResponseKind,
    scene: &RawAnalysis,
    is_mode: bool,
    diagnostics: &mut Diagnostics<'_>,
) -> bool {
    let has_force = scene.force.as_ref().is_some_and(|f| !f.is_empty());
    let path = format!("response.{i}.kind");
    if kind == ResponseKind::Appropriation && !has_force {
        let diagnostic = Diagnostic::error("force appropriation needs [[force]]");
        diagnostics.put(&path, diagnostic, "expected a force at each drive point; its amplitude is what is computed");
        return false;
    }
    if is_mode || has_force || scene.base_motion.is_some() {
        return true;
    }
    let diagnostic = Diagnostic::error(format!("a response of kind \"{}\" needs a load", kind.name()));
    diagnostics.put(&path, diagnostic, "expected [[force]] or [base_motion] in the scene");
    false
}

/// A sweep in time takes loads that do not depend on the frequency.
fn sweeps(i: usize, raw: &RawResponse, scene: &RawAnalysis, diagnostics: &mut Diagnostics<'_>) -> bool {
    if !raw.response.sweep {
        return true;
    }
    let base = scene.base_motion.as_ref();
    let in_metres = base.is_some_and(|base| base.amplitude_m.is_some()) || raw.levels_m.is_some();
    let (title, expected) = if in_metres || base.is_some_and(|base| base.stop == Some(StopOfBase::Fixed)) {
        (
            "a base that is swept in time has an acceleration, and stops move with it",
            "expected no sweep beside a displacement of the base or fixed stops",
        )
    } else {
        return true;
    };
    diagnostics.put(&format!("response.{i}.sweep"), Diagnostic::error(title), expected);
    false
}

/// Keys that belong to another kind of response have no effect.
fn uses_its_keys(i: usize, kind: ResponseKind, diagnostics: &mut Diagnostics<'_>) {
    let is_forced = kind.is_forced();
    let keys = [
        ("lag_deg", kind == ResponseKind::PhaseResonance, "phase-resonance"),
        ("controlled_harmonics", kind == ResponseKind::Appropriation, "appropriation"),
        ("levels_n", is_forced, "frequency"),
        ("levels_m_s2", is_forced, "frequency"),
        ("levels_m", is_forced, "frequency"),
        ("subharmonic", is_forced, "frequency"),
        ("sweep", kind == ResponseKind::Frequency, "frequency"),
        ("sweep_s", kind == ResponseKind::Frequency, "frequency"),
    ];
    for (key, _, other) in keys.into_iter().filter(|(_, is_used, _)| !is_used) {
        let path = format!("response.{i}.{key}");
        if diagnostics.has(&path) {
            let label = format!("a response of kind \"{other}\" uses it, \"{}\" does not", kind.name());
            diagnostics.put(&path, Diagnostic::warning(format!("`{path}` has no effect")), label);
        }
    }
}

/// The levels in the unit of the load.
fn levels(i: usize, raw: &RawResponse, scene: &RawAnalysis, diagnostics: &mut Diagnostics<'_>) -> Option<Vec<f64>> {
    let path = |key: &str| format!("response.{i}.{key}");
    let base = scene.base_motion.as_ref();
    let given = [("levels_n", &raw.levels_n), ("levels_m_s2", &raw.levels_m_s2), ("levels_m", &raw.levels_m)];
    let given: Vec<_> = given.into_iter().filter_map(|(key, levels)| Some((key, levels.as_ref()?))).collect();
    if let [_, (second, _), ..] = given[..] {
        let diagnostic = Diagnostic::error("a response has levels of one unit");
        diagnostics.put(&path(second), diagnostic, "expected one of `levels_n`, `levels_m_s2` and `levels_m`");
        return None;
    }
    let Some(&(key, levels)) = given.first() else {
        let own = match base {
            Some(base) => base.acceleration_m_s2.or(base.amplitude_m),
            None => scene.force.iter().flatten().next().map(|force| force.amplitude_n.unwrap_or(1.0).abs()),
        };
        if own.is_none() && base.is_some() {
            let diagnostic = Diagnostic::error("the base motion has no amplitude");
            diagnostics.put("base_motion", diagnostic, "expected `acceleration_m_s2` or `amplitude_m` in this table");
        }
        return Some(vec![own?]);
    };
    let fits = match (key, base) {
        ("levels_n", None) => true,
        ("levels_m_s2", Some(base)) => base.amplitude_m.is_none(),
        ("levels_m", Some(base)) => base.acceleration_m_s2.is_none(),
        _ => false,
    };
    if !fits {
        let diagnostic =
            Diagnostic::error(format!("`{}` are levels of a load that the scene does not have", path(key)));
        let label =
            "levels_n go with [[force]], levels_m_s2 and levels_m with acceleration and amplitude of [base_motion]";
        diagnostics.put(&path(key), diagnostic, label);
        return None;
    }
    let forces = scene.force.as_deref().unwrap_or_default();
    if let [first, others @ ..] = forces
        && first.amplitude_n.is_none()
        && let Some(other) = others.iter().filter_map(|other| other.amplitude_n).find(|other| other.abs() != 1.0)
    {
        let title = format!(
            "levels are of the first force; that of {} N grows with them, as {0} N for each newton",
            number(other)
        );
        let diagnostic = Diagnostic::warning(title)
            .help("`amplitude_n` of the first [[force]]: the others keep their ratio to it at every level");
        diagnostics.put(&path(key), diagnostic, "the first force states no amplitude, which counts as 1 N");
    }
    Some(levels.clone())
}

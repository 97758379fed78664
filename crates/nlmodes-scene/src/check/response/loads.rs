//! Damping, forces, and a base that shakes.

use super::place::Places;
use crate::raw::{RawAnalysis, RawDamping, RawDashpot, RawForce, RawModeDamping};
use crate::scene::{BaseMotion, Damping, Dashpot, Force, ModeDamping, StopOfBase};
use crate::{Diagnostic, Diagnostics};

pub fn damping(raw: &RawDamping, places: &Places<'_>, diagnostics: &mut Diagnostics<'_>) -> Option<Damping> {
    let dashpots = raw.dashpot.as_deref().unwrap_or_default();
    let modes = mode_damping(&raw.modes, "damping", !dashpots.is_empty(), diagnostics)?;
    let sound: Vec<Dashpot> =
        dashpots.iter().enumerate().filter_map(|(i, raw)| dashpot(i, raw, places, diagnostics)).collect();
    (sound.len() == dashpots.len()).then_some(Damping { modes, dashpots: sound })
}

/// Damping of one structure of several.
pub fn own_damping(raw: &RawModeDamping, diagnostics: &mut Diagnostics<'_>) -> Option<ModeDamping> {
    mode_damping(raw, "structure.damping", false, diagnostics)
}

/// How the table at `path` says that modes are damped; it need not where there are dashpots.
fn mode_damping(
    raw: &RawModeDamping,
    path: &str,
    has_dashpots: bool,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<ModeDamping> {
    let count = [raw.ratio.is_some(), raw.ratios.is_some(), raw.rayleigh.is_some()];
    let count = count.iter().filter(|given| **given).count();
    if count > 1 {
        let diagnostic = Diagnostic::error(format!("`{path}` says more than once how the modes are damped"));
        diagnostics.put(path, diagnostic, "expected one of `ratio`, `ratios` and `rayleigh` in this table");
        return None;
    }
    if count == 0 && !has_dashpots {
        let diagnostic = Diagnostic::error(format!("`{path}` does not say how the structure is damped"));
        let dashpots = if path == "damping" { " or [[damping.dashpot]]" } else { "" };
        diagnostics.put(path, diagnostic, format!("expected `ratio`, `ratios`, `rayleigh`{dashpots}"));
        return None;
    }
    Some(match (&raw.ratios, &raw.rayleigh) {
        (Some(ratios), _) => ModeDamping::Ratios(ratios.clone()),
        (None, Some(r)) => {
            ModeDamping::Rayleigh { mass: r.mass_1_s.unwrap_or(0.0), stiffness: r.stiffness_s.unwrap_or(0.0) }
        }
        (None, None) => ModeDamping::Ratios(vec![raw.ratio.unwrap_or(0.0)]),
    })
}

fn dashpot(i: usize, raw: &RawDashpot, places: &Places<'_>, diagnostics: &mut Diagnostics<'_>) -> Option<Dashpot> {
    let keys = ["at_m", "node", "direction", "structure", "row"].map(|key| format!("damping.dashpot.{i}.{key}"));
    Some(Dashpot { place: places.place(&raw.place, &keys, diagnostics)?, damping: raw.damping_n_s_m })
}

pub fn forces(raw: &RawAnalysis, places: &Places<'_>, diagnostics: &mut Diagnostics<'_>) -> Vec<Force> {
    let written = raw.force.as_deref().unwrap_or_default();
    written.iter().enumerate().filter_map(|(i, raw)| force(i, raw, places, diagnostics)).collect()
}

fn force(i: usize, raw: &RawForce, places: &Places<'_>, diagnostics: &mut Diagnostics<'_>) -> Option<Force> {
    let keys = ["at_m", "node", "direction", "structure", "row"].map(|key| format!("force.{i}.{key}"));
    let place = places.place(&raw.place, &keys, diagnostics);
    let amplitude = raw.amplitude_n.unwrap_or(1.0);
    if amplitude == 0.0 {
        let path = format!("force.{i}.amplitude_n");
        let diagnostic = Diagnostic::error(format!("`{path}` is zero: this force does nothing"));
        diagnostics.put(&path, diagnostic, "expected another number");
        return None;
    }
    let (harmonic, phase_deg) = (raw.harmonic.unwrap_or(1) as usize, raw.phase_deg.unwrap_or(0.0));
    Some(Force { place: place?, amplitude, harmonic, phase_deg })
}

pub fn base_motion(raw: &RawAnalysis, places: &Places<'_>, diagnostics: &mut Diagnostics<'_>) -> Option<BaseMotion> {
    let base = raw.base_motion.as_ref()?;
    if raw.force.as_ref().is_some_and(|forces| !forces.is_empty()) {
        let diagnostic = Diagnostic::error("the scene has both forces and base motion");
        diagnostics.put("base_motion", diagnostic, "expected either this table or [[force]]");
        return None;
    }
    if matches!(places, Places::Rows) {
        let diagnostic = Diagnostic::error("the base of a structure that was reduced elsewhere cannot move");
        let help = "its mass is not known, and with it what a moving base pushes";
        diagnostics.put("base_motion", diagnostic.help(help), "expected [[force]] at rows");
        return None;
    }
    let direction = places.base_direction("base_motion.direction", base.direction.as_ref(), diagnostics)?;
    let in_metres = || raw.response.iter().flatten().any(|response| response.levels_m.is_some());
    let (amplitude, is_acceleration) = match (base.acceleration_m_s2, base.amplitude_m) {
        (Some(_), Some(_)) => {
            let diagnostic = Diagnostic::error("`base_motion` has two amplitudes");
            diagnostics.put("base_motion", diagnostic, "expected `acceleration_m_s2` or `amplitude_m` in this table");
            return None;
        }
        (Some(a), None) => (a, true),
        (None, Some(a)) => (a, false),
        // The levels of the responses say it.
        (None, None) => (0.0, !in_metres()),
    };
    Some(BaseMotion { direction, amplitude, is_acceleration, stop: base.stop.unwrap_or(StopOfBase::Moves) })
}

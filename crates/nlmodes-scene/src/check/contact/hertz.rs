//! Stops whose force is a power of the approach.

use crate::raw::{RawAnalysis, RawContact};
use crate::scene::{Contact, Hertz, StopOfBase};
use crate::{Diagnostic, Diagnostics};

/// Exponent of the contact of two round bodies.
const ROUND: f64 = 1.5;

/// The law of stop `i`, if it has one.
pub fn law(i: usize, raw: &RawContact, diagnostics: &mut Diagnostics<'_>) -> Option<Hertz> {
    let path = |key: &str| format!("contact.{i}.{key}");
    let Some(stiffness) = raw.stiffness_hertz_n_m15 else {
        for (key, _) in [("exponent", raw.exponent), ("dissipation_s_m", raw.dissipation_s_m)].iter().filter(is_there) {
            let diagnostic = Diagnostic::error(format!("`{}` belongs to a stop with a law of force", path(key)));
            let label = "expected `stiffness_hertz_n_m15` in this table too";
            diagnostics.put(&path(key), diagnostic, label);
        }
        return None;
    };
    let others = [
        ("stiffness_n_m", raw.stiffness_n_m, "a stop has one law: this one or `stiffness_hertz_n_m15`"),
        ("damping_n_s_m", raw.damping_n_s_m, "`dissipation_s_m` is what such a stop dissipates by"),
        ("friction_estimate", raw.friction_estimate, "the power of friction is estimated at linear stops alone"),
    ];
    for (key, _, help) in others.iter().filter(|(_, value, _)| value.is_some()) {
        let diagnostic = Diagnostic::error(format!("`{}` beside `stiffness_hertz_n_m15`", path(key)));
        diagnostics.put(&path(key), diagnostic.help(*help), "expected one of the two in this table");
    }
    if raw.gap_m < 0.0 {
        let diagnostic = Diagnostic::error(format!("`{}` presses a stop with a law of force", path("gap_m")));
        let help = "where both come to rest is not computed: give the law about that place, or a linear stop";
        diagnostics.put(&path("gap_m"), diagnostic.help(help), "expected a gap that is not negative");
    }
    let (exponent, dissipation) = (raw.exponent.unwrap_or(ROUND), raw.dissipation_s_m.unwrap_or(0.0));
    Some(Hertz { stiffness, exponent, dissipation })
}

fn is_there((_, value): &&(&str, Option<f64>)) -> bool {
    value.is_some()
}

/// Stops with a law of force follow the others, at nodes with mass, and move with a base that shakes.
pub fn check(raw: &RawAnalysis, is_open: bool, contacts: &[Contact], diagnostics: &mut Diagnostics<'_>) {
    let Some(first) = contacts.iter().position(|contact| contact.hertz.is_some()) else { return };
    if let Some(other) = (first..contacts.len()).find(|i| contacts[*i].hertz.is_none()) {
        let path = format!("contact.{first}.stiffness_hertz_n_m15");
        let diagnostic = Diagnostic::error(format!("`contact.{first}` has a law of force, and `contact.{other}` none"));
        let help = "stops are numbered as they are computed: rigid and linear ones, then those with a law of force";
        let label = format!("expected this table behind that of `contact.{other}`");
        diagnostics.put(&path, diagnostic.help(help), label);
    }
    if !is_open && first == 0 {
        let keys = ["method.mass_redistribution", "method.held_modes", "reduction.kind", "method.kind"];
        let path = keys.iter().find(|key| diagnostics.has(key)).copied().unwrap_or("method");
        let diagnostic = Diagnostic::error("nodes before stops with a law of force keep their mass");
        let help = "free-interface modes, the default, have all of it: without `method.mass_redistribution` and \
            `method.held_modes`, with method.kind = \"ms-hbm\"";
        diagnostics.put(path, diagnostic.help(help), "expected a scene in free-interface modes");
    }
    if raw.base_motion.as_ref().is_some_and(|base| base.stop == Some(StopOfBase::Fixed)) {
        let diagnostic = Diagnostic::error("a stop with a law of force that is fixed while the base moves");
        let help = "`stop = \"moves\"` is a stop that the base carries; linear ones (`stiffness_n_m`) may be fixed in \
            space";
        diagnostics.put("base_motion.stop", diagnostic.help(help), "expected \"moves\"");
    }
}

//! Stops whose force is a power of the approach.

use crate::raw::{RawAnalysis, RawStopLaw};
use crate::scene::{Contact, Hertz, LawContact, StopOfBase};
use crate::{Diagnostic, Diagnostics};

/// Exponent of the contact of two round bodies.
const ROUND: f64 = 1.5;

/// The law of stop `i`, if it has one; `friction` is the coefficient beside it.
pub fn law(i: usize, stop: &RawStopLaw, friction: Option<f64>, diagnostics: &mut Diagnostics<'_>) -> Option<Hertz> {
    let path = |key: &str| format!("contact.{i}.{key}");
    let Some(stiffness) = stop.stiffness_hertz_n_m15 else {
        for (key, _) in [("exponent", stop.exponent), ("dissipation_s_m", stop.dissipation_s_m)].iter().filter(is_there)
        {
            let diagnostic = Diagnostic::error(format!("`{}` belongs to a stop with a law of force", path(key)));
            let label = "expected `stiffness_hertz_n_m15` in this table too";
            diagnostics.put(&path(key), diagnostic, label);
        }
        return None;
    };
    let others = [
        ("stiffness_n_m", stop.stiffness_n_m, "a stop has one law: this one or `stiffness_hertz_n_m15`"),
        ("damping_n_s_m", stop.damping_n_s_m, "`dissipation_s_m` is what such a stop dissipates by"),
        ("friction_estimate", friction, "the power of friction is estimated at linear stops alone"),
    ];
    for (key, _, help) in others.iter().filter(|(_, value, _)| value.is_some()) {
        let diagnostic = Diagnostic::error(format!("`{}` beside `stiffness_hertz_n_m15`", path(key)));
        diagnostics.put(&path(key), diagnostic.help(*help), "expected one of the two in this table");
    }
    let (exponent, dissipation) = (stop.exponent.unwrap_or(ROUND), stop.dissipation_s_m.unwrap_or(0.0));
    Some(Hertz { stiffness, exponent, dissipation })
}

fn is_there((_, value): &&(&str, Option<f64>)) -> bool {
    value.is_some()
}

/// Stops with a law of force follow the others, at nodes with mass, and move with a base that shakes.
pub fn check(raw: &RawAnalysis, is_open: bool, contacts: &[Contact], diagnostics: &mut Diagnostics<'_>) {
    let laws: Vec<bool> = contacts.iter().map(|contact| contact.hertz.is_some()).collect();
    order(&laws, diagnostics);
    let of_base = raw.base_motion.as_ref().is_some_and(|base| base.stop == Some(StopOfBase::Fixed));
    if raw.has_law_stops && of_base {
        let diagnostic = Diagnostic::error("a stop with a law of force that is fixed while the base moves");
        let help = "`stop = \"moves\"` is a stop that the base carries; linear ones (`stiffness_n_m`) may be fixed";
        diagnostics.put("base_motion.stop", diagnostic.help(help), "expected \"moves\"");
    }
    let Some(first) = laws.iter().position(|is_law| *is_law) else { return };
    if !is_open && first == 0 {
        let keys = ["method.mass_redistribution", "method.held_modes", "reduction.kind", "method.kind"];
        let path = keys.iter().find(|key| diagnostics.has(key)).copied().unwrap_or("method");
        let diagnostic = Diagnostic::error("nodes before stops with a law of force keep their mass");
        let help = "free-interface modes, the default, have all of it: without `method.mass_redistribution` and \
            `method.held_modes`, with method.kind = \"ms-hbm\"";
        diagnostics.put(path, diagnostic.help(help), "expected a scene in free-interface modes");
    }
}

/// The contacts, those with a law of force apart, which follow the others; none where one of them is not sound.
pub fn laws_apart<C>(
    contacts: Vec<Option<C>>,
    laws: Vec<Option<Hertz>>,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<(Vec<C>, Vec<LawContact<C>>)> {
    order(&laws.iter().map(Option::is_some).collect::<Vec<_>>(), diagnostics);
    let (mut linear, mut with_law) = (Vec::new(), Vec::new());
    for (contact, hertz) in contacts.into_iter().collect::<Option<Vec<_>>>()?.into_iter().zip(laws) {
        match hertz {
            Some(hertz) => with_law.push(LawContact { contact, hertz }),
            None => linear.push(contact),
        }
    }
    Some((linear, with_law))
}

/// Stops with a law of force follow the others.
fn order(laws: &[bool], diagnostics: &mut Diagnostics<'_>) {
    let Some(first) = laws.iter().position(|is_law| *is_law) else { return };
    if let Some(other) = (first..laws.len()).find(|i| !laws[*i]) {
        let path = format!("contact.{first}.stiffness_hertz_n_m15");
        let diagnostic = Diagnostic::error(format!("`contact.{first}` has a law of force, and `contact.{other}` none"));
        let help = "stops are numbered as they are computed: rigid and linear ones, then those with a law of force";
        let label = format!("expected this table behind that of `contact.{other}`");
        diagnostics.put(&path, diagnostic.help(help), label);
    }
}

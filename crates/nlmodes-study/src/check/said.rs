//! Errors of the scene of the first case, at the corresponding position in the study.

use nlmodes_scene::scene::{ResponseKind, Scene};
use nlmodes_scene::{Diagnostic, Diagnostics, Severity};

use crate::case;
use crate::design::Points;
use crate::study::{Selected, Study};

/// Checks that the keys of the first case exist in the scene: otherwise no case is possible.
///
/// A value that the scene rejects is another matter: other values may be valid, and the case has the error.
pub fn first_case(study: &Study, diagnostics: &mut Diagnostics<'_>) {
    if diagnostics.refuse() {
        return;
    }
    let point = Points::new(study).get(0);
    let refused = match case::resolve(study, &point) {
        Err(refused) => refused,
        Ok(parts) => {
            let scenes = || parts.iter().map(|part| &part.file.scene);
            let over_frequency = |scene: &Scene| scene.responses.iter().any(|r| r.kind == ResponseKind::Frequency);
            for (k, quantity) in study.quantities.iter().enumerate() {
                let is_of_responses = quantity.of.is_of_sweeps() || quantity.response != Selected::default();
                if is_of_responses && !scenes().any(over_frequency) {
                    let title =
                        format!("`{}` is of responses over the frequency, which the scene has not", quantity.name);
                    diagnostics.put(
                        &format!("quantity.{k}"),
                        Diagnostic::error(title),
                        "expected a scene with [response]",
                    );
                }
            }
            if parts.iter().any(|part| part.file.scene.transient.is_some()) {
                let diagnostic =
                    Diagnostic::error("the scene asks for a motion in time: studies are of nonlinear modes");
                diagnostics.put("scene", diagnostic, "expected a scene without [transient]");
            }
            return;
        }
    };
    let errors = refused.diagnostics().iter().filter(|diagnostic| diagnostic.severity == Severity::Error);
    for diagnostic in errors.filter(|diagnostic| leads_nowhere(diagnostic)) {
        let names =
            |key: &String| diagnostic.title.contains(&format!("`{key}`")) || leads_through(key, &diagnostic.title);
        let Some(k) = study.variables.iter().position(|variable| variable.keys.iter().any(names)) else { continue };
        let label = diagnostic.place.as_ref().map_or("", |mark| mark.label.as_str());
        let moved =
            diagnostic.help.iter().fold(Diagnostic::error(diagnostic.title.clone()), |p, help| p.help(help.as_str()));
        diagnostics.put(&format!("vary.{k}.key"), moved, label);
    }
}

/// Whether a key is unknown, or its path does not exist.
fn leads_nowhere(diagnostic: &Diagnostic) -> bool {
    ["unknown key", "has no item", "is a single value"].iter().any(|sign| diagnostic.title.contains(sign))
}

/// Whether the first name in the title is a table on the way to the key.
fn leads_through(key: &str, title: &str) -> bool {
    title.split('`').nth(1).is_some_and(|table| key.starts_with(&format!("{table}.")))
}

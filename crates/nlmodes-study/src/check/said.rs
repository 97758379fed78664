//! What a scene says of the first case, at the place of the study that it is about.

use nlmodes_scene::{Findings, Problem, Severity};

use crate::case;
use crate::design::Points;
use crate::study::Study;

/// Looks whether the keys of the first case lead anywhere in the scene: those that do not make no case at all.
///
/// A value that the scene refuses is another matter: another one may do, and that case says so.
pub fn first_case(study: &Study, findings: &mut Findings<'_>) {
    if findings.refuse() {
        return;
    }
    let point = Points::new(study).get(0);
    let refused = match case::resolve(study, &point) {
        Err(refused) => refused,
        Ok(parts) => {
            if parts.iter().any(|part| !part.file.scene.responses.is_empty()) {
                let problem = Problem::error("the scene asks for responses: studies are of nonlinear modes so far");
                findings.put("scene", problem, "expected a scene without [response]");
            }
            return;
        }
    };
    let errors = refused.problems().iter().filter(|problem| problem.severity == Severity::Error);
    for problem in errors.filter(|problem| leads_nowhere(problem)) {
        let names = |key: &String| problem.title.contains(&format!("`{key}`")) || leads_through(key, &problem.title);
        let Some(k) = study.variables.iter().position(|variable| variable.keys.iter().any(names)) else { continue };
        let label = problem.place.as_ref().map_or("", |mark| mark.label.as_str());
        let moved = problem.help.iter().fold(Problem::error(problem.title.clone()), |p, help| p.help(help.as_str()));
        findings.put(&format!("vary.{k}.key"), moved, label);
    }
}

/// Whether a key is unknown, or its path leads nowhere.
fn leads_nowhere(problem: &Problem) -> bool {
    ["unknown key", "has no item", "is a single value"].iter().any(|sign| problem.title.contains(sign))
}

/// Whether the first name in the title is a table on the way to the key.
fn leads_through(key: &str, title: &str) -> bool {
    title.split('`').nth(1).is_some_and(|table| key.starts_with(&format!("{table}.")))
}

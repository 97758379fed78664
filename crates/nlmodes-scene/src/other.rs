//! Files of other kinds than scenes, such as studies, read with the same care.

use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use toml::de::Deserializer;

use crate::text::Text;
use crate::{Document, Findings, Mark, Problem, Refused, SceneFile, conform, file, schema};

/// Reads a file of kind `what`, as `study`: its tables against the schema of `T`, then `check` makes of them what is wanted, or tells the
/// findings why not.
///
/// # Errors
/// [`Refused`] with all that is wrong, each at its place.
pub fn load_other<T: DeserializeOwned + JsonSchema, S>(
    path: &Path,
    what: &str,
    check: impl FnOnce(&T, &mut Findings<'_>) -> Option<S>,
) -> Result<SceneFile<S>, Box<Refused>> {
    let name = path.display().to_string();
    match file::read(path) {
        Ok(text) => parse_other(&name, &text, what, check),
        Err(error) => {
            let (document, _) = Document::new(&Text::new(&name, ""), &[], 0, &mut Vec::new());
            Err(Box::new(Refused::new(document, vec![called(error.problem(), what)])))
        }
    }
}

/// The same for a text; `name` stands in messages.
///
/// # Errors
/// [`Refused`] with all that is wrong, each at its place.
pub fn parse_other<T: DeserializeOwned + JsonSchema, S>(
    name: &str,
    text: &str,
    what: &str,
    check: impl FnOnce(&T, &mut Findings<'_>) -> Option<S>,
) -> Result<SceneFile<S>, Box<Refused>> {
    let mut problems = Vec::new();
    let text = Text::new(name, text);
    let (document, root) = Document::new(&text, &[], 0, &mut problems);
    let mut findings = Findings::new(&document, problems);
    let raw = root.and_then(|mut root| {
        conform::conform(root.get_mut(), &schema::schema_of::<T>(), &mut findings);
        match <T as Deserialize>::deserialize(Deserializer::from(root)) {
            Ok(raw) => Some(raw),
            Err(error) => {
                findings.push(Problem::error(error.message()).at(error.span().unwrap_or(0..0), "in this place"));
                None
            }
        }
    });
    findings.reword(|problem| called(problem, what));
    let made = raw.and_then(|raw| check(&raw, &mut findings));
    let refused = findings.refuse();
    let problems = findings.into_sorted();
    match made {
        Some(scene) if !refused => Ok(SceneFile { scene, document, warnings: problems }),
        _ => Err(Box::new(Refused::new(document, problems))),
    }
}

/// The problem as one of a file of that kind.
fn called(problem: Problem, what: &str) -> Problem {
    let text =
        |text: String| text.replace("a scene", &format!("a {what}")).replace("the scene", &format!("the {what}"));
    let mark = |mark: Mark| Mark { label: text(mark.label), range: mark.range };
    Problem {
        severity: problem.severity,
        title: text(problem.title),
        place: problem.place.map(mark),
        context: problem.context.into_iter().map(mark).collect(),
        help: problem.help.into_iter().map(text).collect(),
    }
}

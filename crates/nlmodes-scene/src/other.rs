//! Files of other kinds than scenes, such as studies, read with the same care.

use std::path::Path;

use schemars::JsonSchema;
use serde::de::DeserializeOwned;

use crate::text::Text;
use crate::{Diagnostic, Diagnostics, Document, Mark, SceneError, SceneFile, conform, file, schema};

/// Reads a file of kind `what`, as `study`: its tables against the schema of `T`, then `check` converts them, or
/// reports errors to the diagnostics.
///
/// # Errors
/// [`SceneError`] with all that is wrong, each at its place.
pub fn load_other<T: DeserializeOwned + JsonSchema, S>(
    path: &Path,
    what: &str,
    check: impl FnOnce(&T, &mut Diagnostics<'_>) -> Option<S>,
) -> Result<SceneFile<S>, SceneError> {
    let name = path.display().to_string();
    match file::read(path) {
        Ok(text) => parse_other(&name, &text, what, check),
        Err(error) => {
            let (document, _) = Document::new(&Text::new(&name, ""), &[], 0, &mut Vec::new());
            Err(SceneError::of_checks(document, vec![called(error.diagnostic(&name), what)]))
        }
    }
}

/// The same for a text; `name` is used in messages.
///
/// # Errors
/// [`SceneError`] with all that is wrong, each at its place.
pub fn parse_other<T: DeserializeOwned + JsonSchema, S>(
    name: &str,
    text: &str,
    what: &str,
    check: impl FnOnce(&T, &mut Diagnostics<'_>) -> Option<S>,
) -> Result<SceneFile<S>, SceneError> {
    let mut diagnostics = Vec::new();
    let text = Text::new(name, text);
    let (document, root) = Document::new(&text, &[], 0, &mut diagnostics);
    let mut diagnostics = Diagnostics::new(&document, diagnostics);
    let raw: Option<T> = root.and_then(|root| {
        let conforming = conform::conform(root.get_ref(), &schema::schema_of::<T>(), &mut diagnostics);
        conform::read(conforming, &mut diagnostics)
    });
    diagnostics.reword(|diagnostic| called(diagnostic, what));
    let made = raw.and_then(|raw| check(&raw, &mut diagnostics));
    let refused = diagnostics.refuse();
    let diagnostics = diagnostics.into_sorted();
    match made {
        Some(scene) if !refused => {
            Ok(SceneFile { scene, document, warnings: diagnostics, functions: Default::default() })
        }
        _ => Err(SceneError::of_checks(document, diagnostics)),
    }
}

/// The diagnostic as one of a file of that kind.
fn called(diagnostic: Diagnostic, what: &str) -> Diagnostic {
    let text =
        |text: String| text.replace("a scene", &format!("a {what}")).replace("the scene", &format!("the {what}"));
    let mark = |mark: Mark| Mark { label: text(mark.label), range: mark.range };
    Diagnostic {
        severity: diagnostic.severity,
        title: text(diagnostic.title),
        place: diagnostic.place.map(mark),
        context: diagnostic.context.into_iter().map(mark).collect(),
        help: diagnostic.help.into_iter().map(text).collect(),
    }
}

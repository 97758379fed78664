//! Scene files: reading, checking, and saying what is wrong with them.
//!
//! ```text
//! file + --set  →  document  →  conform to the schema  →  raw tables  →  check  →  Scene
//! ```
//!
//! Each stage reports what it finds and goes on with the rest, so that a user sees every mistake of a scene at once.

mod check;
mod conform;
mod document;
mod file;
mod findings;
mod mistakes;
mod nearest;
mod planned;
mod problem;
mod raw;
mod render;
mod rule;
pub mod scene;
mod schema;
mod set;
mod sources;
mod unknown;

pub use document::{Document, Place};
pub use file::FileError;
pub use findings::Findings;
pub use problem::{Mark, Problem, Severity};
pub use render::wants_colours;
pub use rule::number;
pub use scene::Scene;
pub use schema::schema;
pub use sources::{Source, Sources};

use std::path::Path;

use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeTable, Deserializer};

/// A scene with the texts it was read from, so that what turns out to be wrong later is shown at its place too.
#[derive(Debug, Clone)]
pub struct SceneFile {
    /// The checked scene.
    pub scene: Scene,
    /// Where its keys stand.
    pub document: Document,
    /// What looks wrong, but does not stand in the way.
    pub warnings: Vec<Problem>,
}

/// What is wrong with a scene that is refused.
#[derive(Debug, Clone)]
pub struct Refused {
    document: Document,
    problems: Vec<Problem>,
}

impl SceneFile {
    /// The error `title` at the value of the key at `path` (as `contact.0.gap_m`), as text; `label` is said beside the value.
    pub fn error_at(&self, path: &str, title: &str, label: &str, help: &[&str]) -> String {
        let problem = help.iter().fold(Problem::error(title), |problem, help| problem.help(*help));
        self.document.render(&[self.document.put(problem, path, label)], wants_colours())
    }

    /// The warnings as text; empty if there are none.
    pub fn warnings_text(&self) -> String {
        self.document.render(&self.warnings, wants_colours())
    }
}

impl Refused {
    /// What is wrong.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// The same as text, with a last line that sums it up.
    pub fn text(&self, colours: bool) -> String {
        let errors = self.problems.iter().filter(|problem| problem.severity == Severity::Error).count();
        let name = &self.document.sources().file().name;
        let count = if errors == 1 { "1 error".into() } else { format!("{errors} errors") };
        format!(
            "{}\n\n{count} in {name}: nothing was computed or written",
            self.document.render(&self.problems, colours)
        )
    }
}

/// Reads and checks a scene file, with the overrides `key=value` of the command line.
///
/// # Errors
/// [`Refused`] with all that is wrong.
pub fn load(path: &Path, overrides: &[String]) -> Result<SceneFile, Box<Refused>> {
    let name = path.display().to_string();
    match file::read(path) {
        Ok(text) => parse(&name, &text, overrides),
        Err(error) => Err(refuse_file(&name, &error)),
    }
}

fn refuse_file(name: &str, error: &FileError) -> Box<Refused> {
    let (document, _) = Document::parse(name, "", &[], &mut Vec::new());
    Box::new(Refused { document, problems: vec![error.problem()] })
}

/// Reads and checks the text of a scene. `name` stands in messages, and its stem in the default of the output directory.
///
/// # Errors
/// [`Refused`] with all that is wrong.
pub fn parse(name: &str, text: &str, overrides: &[String]) -> Result<SceneFile, Box<Refused>> {
    let mut problems = Vec::new();
    let (document, root) = Document::parse(name, text, overrides, &mut problems);
    let mut findings = Findings::new(&document, problems);
    let scene = root.and_then(|root| read(root, &stem(name), &mut findings));
    finish(scene, findings)
}

fn read(mut root: Spanned<DeTable<'_>>, stem: &str, findings: &mut Findings<'_>) -> Option<Scene> {
    if let Some(problem) = planned::problem(root.get_ref()) {
        findings.push(problem);
        return None;
    }
    conform::conform(root.get_mut(), &schema(), findings);
    match raw::RawScene::deserialize(Deserializer::from(root)) {
        Ok(raw) => check::scene(&raw, stem, findings),
        Err(error) => {
            findings.push(Problem::error(error.message()).at(error.span().unwrap_or(0..0), "in this place"));
            None
        }
    }
}

fn finish(scene: Option<Scene>, findings: Findings<'_>) -> Result<SceneFile, Box<Refused>> {
    let document = findings.document().clone();
    match scene {
        Some(scene) if !findings.refuse() => Ok(SceneFile { scene, document, warnings: findings.into_sorted() }),
        _ => Err(Box::new(Refused { document, problems: findings.into_sorted() })),
    }
}

fn stem(name: &str) -> String {
    Path::new(name).file_stem().map_or_else(|| "scene".into(), |stem| stem.to_string_lossy().into_owned())
}

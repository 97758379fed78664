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
mod methods;
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
pub use scene::{RecordScene, Scene};
pub use schema::{schema, whole_schema};
pub use sources::{Source, Sources};

use std::path::Path;

use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeTable, Deserializer};

/// A scene with the texts it was read from, so that what turns out to be wrong later is shown at its place too.
#[derive(Debug, Clone)]
pub struct SceneFile<S = Scene> {
    /// The checked scene.
    pub scene: S,
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

impl<S> SceneFile<S> {
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

/// A scene of either kind.
#[derive(Debug, Clone)]
pub enum AnyScene {
    /// A structure to compute with, a scene for each method.
    Structure(Vec<SceneFile>),
    /// Records of a test.
    Records(Box<SceneFile<RecordScene>>),
}

/// Reads and checks a scene file of a structure, with the overrides `key=value` of the command line. With several methods, `[[method]]`, it
/// is a scene for each; an override of `method` holds for all of them.
///
/// # Errors
/// [`Refused`] with all that is wrong with the first one that is refused.
pub fn load_each_method(path: &Path, overrides: &[String]) -> Result<Vec<SceneFile>, Box<Refused>> {
    let (name, text) = text(path)?;
    each_method(&name, &text, overrides)
}

fn each_method(name: &str, text: &str, overrides: &[String]) -> Result<Vec<SceneFile>, Box<Refused>> {
    methods::split(text).iter().map(|text| parse(name, text, overrides)).collect()
}

/// Reads and checks a scene file of measured records, in the same way.
///
/// # Errors
/// [`Refused`] with all that is wrong.
pub fn load_records(path: &Path, overrides: &[String]) -> Result<SceneFile<RecordScene>, Box<Refused>> {
    let (name, text) = text(path)?;
    parse_records(&name, &text, overrides)
}

/// Reads and checks a scene file of either kind.
///
/// # Errors
/// [`Refused`] with all that is wrong.
pub fn load_any(path: &Path, overrides: &[String]) -> Result<AnyScene, Box<Refused>> {
    let (name, text) = text(path)?;
    let (_, root) = Document::parse(&name, &text, overrides, &mut Vec::new());
    if root.is_some_and(|root| planned::is_of_records(root.get_ref())) {
        return Ok(AnyScene::Records(Box::new(parse_records(&name, &text, overrides)?)));
    }
    Ok(AnyScene::Structure(each_method(&name, &text, overrides)?))
}

/// Name and text of a scene file.
fn text(path: &Path) -> Result<(String, String), Box<Refused>> {
    let name = path.display().to_string();
    match file::read(path) {
        Ok(text) => Ok((name, text)),
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
    let raw: Option<raw::RawScene> = root.and_then(|root| {
        let other = planned::problem(root.get_ref()).or_else(|| planned::of_records(root.get_ref()));
        read(root, other, &schema(), &mut findings)
    });
    let scene = raw.and_then(|raw| check::scene(&raw, &stem(name), &mut findings));
    finish(scene, findings)
}

/// Reads and checks the text of a scene of measured records, in the same way; paths of its files count from the directory of `name`.
///
/// # Errors
/// [`Refused`] with all that is wrong.
pub fn parse_records(name: &str, text: &str, overrides: &[String]) -> Result<SceneFile<RecordScene>, Box<Refused>> {
    let mut problems = Vec::new();
    let (document, root) = Document::parse(name, text, overrides, &mut problems);
    let mut findings = Findings::new(&document, problems);
    let raw: Option<raw::RawRecordScene> = root.and_then(|root| {
        let other = planned::problem(root.get_ref()).or_else(|| planned::not_of_records(root.get_ref()));
        read(root, other, &schema::record_schema(), &mut findings)
    });
    let base = Path::new(name).parent().unwrap_or(Path::new("")).to_path_buf();
    let scene = raw.and_then(|raw| check::record_scene(&raw, &stem(name), base, &mut findings));
    finish(scene, findings)
}

/// The raw tables, unless the scene is one of another kind.
fn read<'de, T: Deserialize<'de>>(
    mut root: Spanned<DeTable<'de>>,
    other: Option<Problem>,
    schema: &serde_json::Value,
    findings: &mut Findings<'_>,
) -> Option<T> {
    if let Some(problem) = other {
        findings.push(problem);
        return None;
    }
    conform::conform(root.get_mut(), schema, findings);
    match T::deserialize(Deserializer::from(root)) {
        Ok(raw) => Some(raw),
        Err(error) => {
            findings.push(Problem::error(error.message()).at(error.span().unwrap_or(0..0), "in this place"));
            None
        }
    }
}

fn finish<S>(scene: Option<S>, findings: Findings<'_>) -> Result<SceneFile<S>, Box<Refused>> {
    let document = findings.document().clone();
    match scene {
        Some(scene) if !findings.refuse() => Ok(SceneFile { scene, document, warnings: findings.into_sorted() }),
        _ => Err(Box::new(Refused { document, problems: findings.into_sorted() })),
    }
}

fn stem(name: &str) -> String {
    Path::new(name).file_stem().map_or_else(|| "scene".into(), |stem| stem.to_string_lossy().into_owned())
}

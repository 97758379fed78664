//! Scene files: reading, checking, and saying what is wrong with them.
//!
//! ```text
//! file + --set  →  document  →  conform to the schema  →  raw tables  →  check  →  Scene
//! ```
//!
//! Each stage reports what it finds and goes on with the rest, so that a user sees every mistake of a scene at once. Nothing is printed
//! and nothing is written: what there is to say comes back as data with the place that it is about.
//!
//! | item | what it is |
//! | --- | --- |
//! | [`parse_each_method`], [`load_each_method`] | text or file → the checked scene of a structure, one for each method |
//! | [`load_any`], [`load_to_run`] | the same for a file of any kind: [`AnyScene`] |
//! | [`SceneFile`] | the scene, the places of its keys, its warnings |
//! | [`Refused`], [`SceneError`], [`Problem`] | what is wrong, and where it stands |
//! | [`whole_schema`] | every key with its unit, limits and default |
//! | [`assemble`] | scene → structural model |
//! | [`memory`] | what a scene needs, before anything is computed |
//!
//! # Example
//! ```
//! use nlmodes_scene::{assemble::structural_model, parse};
//!
//! let text = r#"
//! [structure]
//! kind = "rod"
//! length_m = 1.0
//! elements = 8
//! start = "clamped"
//! material = { youngs_modulus_pa = 210e9, density_kg_m3 = 7800.0 }
//! section = { area_m2 = 1e-4 }
//! [[contact]]
//! at_m = 1.0
//! direction = "axial"
//! side = "positive"
//! gap_m = 1e-3
//! [method]
//! harmonics = 5
//! [continuation]
//! max_energy_ratio = 10.0
//! "#;
//! let file = parse("rod.toml", text, &["contact.0.gap_m=2e-3".to_owned()]).map_err(|refused| refused.text(false))?;
//! assert_eq!(file.scene.contacts[0].gap, 2e-3);
//! assert_eq!(structural_model(&file.scene).map_err(|error| error.to_string())?.dofs().len(), 8);
//!
//! let refused = parse("rod.toml", &text.replace("gap_m", "gap_mm"), &[]).unwrap_err();
//! assert!(refused.text(false).contains("did you mean `gap_m`?"));
//! # Ok::<(), String>(())
//! ```

pub mod assemble;
mod check;
mod conform;
mod document;
mod file;
mod findings;
pub mod memory;
mod methods;
mod mistakes;
mod nearest;
mod planned;
mod problem;
mod raw;
mod refused;
mod render;
mod rule;
pub mod scene;
mod scene_error;
mod schema;
mod set;
mod sources;
mod units;
mod unknown;

pub use document::{Document, Place};
pub use file::FileError;
pub use findings::Findings;
pub use problem::{Mark, Problem, Severity};
pub use refused::Refused;
pub use rule::number;
pub use scene::{RecordScene, Scene, TestScene};
pub use scene_error::SceneError;
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

impl<S> SceneFile<S> {
    /// The error `title` at the value of the key at `path` (as `contact.0.gap_m`); `label` is said beside the value.
    pub fn error_at(&self, path: &str, title: &str, label: &str, help: &[&str]) -> SceneError {
        let problem = help.iter().fold(Problem::error(title), |problem, help| problem.help(*help));
        SceneError::new(self.document.clone(), self.document.put(problem, path, label))
    }

    /// Adds a warning at the value of a key.
    pub fn warn_at(&mut self, path: &str, title: &str, label: &str, help: &str) {
        let problem = self.document.put(Problem::warning(title).help(help), path, label);
        self.warnings.push(problem);
    }

    /// The warnings as text; empty if there are none.
    pub fn warnings_text(&self, colours: bool) -> String {
        self.document.render(&self.warnings, colours)
    }

    /// The warnings, a line each without its place.
    pub fn warning_sentences(&self) -> Vec<String> {
        self.warnings.iter().map(Problem::sentence).collect()
    }
}

/// The warnings of all scenes of one file as text, each once; empty if there are none.
pub fn warnings_text(files: &[SceneFile], colours: bool) -> String {
    let all = files.iter().flat_map(|file| file.warnings.iter().cloned()).collect();
    files.first().map_or_else(String::new, |file| file.document.render(&problem::each_once(all), colours))
}

/// A scene of any kind.
#[derive(Debug, Clone)]
pub enum AnyScene {
    /// A structure to compute with, a scene for each method.
    Structure(Vec<SceneFile>),
    /// Records of a test.
    Records(Box<SceneFile<RecordScene>>),
    /// A test on a virtual rig.
    Test(Box<SceneFile<TestScene>>),
}

/// Reads and checks a scene file of a structure, with the overrides `key=value` of the command line. With several methods, `[[method]]`, it
/// is a scene for each; an override of `method` holds for all of them.
///
/// # Errors
/// [`Refused`] with all that is wrong with any of them, each mistake once.
pub fn load_each_method(path: &Path, overrides: &[String]) -> Result<Vec<SceneFile>, Box<Refused>> {
    let (name, text) = text(path)?;
    parse_each_method(&name, &text, overrides)
}

/// Reads and checks the text of a scene, with each of its methods; `name` as for [`parse`].
///
/// # Errors
/// [`Refused`] with all that is wrong with any of them, each mistake once.
pub fn parse_each_method(name: &str, text: &str, overrides: &[String]) -> Result<Vec<SceneFile>, Box<Refused>> {
    let read = (0..methods::count(text)).map(|number| parse_method(name, text, overrides, number));
    refused::or_all(read.collect())
}

/// Reads and checks a scene file of measured records, in the same way.
///
/// # Errors
/// [`Refused`] with all that is wrong.
pub fn load_records(path: &Path, overrides: &[String]) -> Result<SceneFile<RecordScene>, Box<Refused>> {
    let (name, text) = text(path)?;
    parse_records(&name, &text, overrides)
}

/// Reads and checks a scene file of any kind.
///
/// # Errors
/// [`Refused`] with all that is wrong.
pub fn load_any(path: &Path, overrides: &[String]) -> Result<AnyScene, Box<Refused>> {
    let (name, text) = text(path)?;
    let (_, root) = Document::parse(&name, &text, overrides, 0, &mut Vec::new());
    if root.as_ref().is_some_and(|root| planned::is_of_test(root.get_ref())) {
        return Ok(AnyScene::Test(Box::new(parse_test(&name, &text, overrides)?)));
    }
    if root.is_some_and(|root| planned::is_of_records(root.get_ref())) {
        return Ok(AnyScene::Records(Box::new(parse_records(&name, &text, overrides)?)));
    }
    Ok(AnyScene::Structure(parse_each_method(&name, &text, overrides)?))
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
    let (document, _) = Document::parse(name, "", &[], 0, &mut Vec::new());
    Box::new(Refused::new(document, vec![error.problem()]))
}

/// Reads and checks the text of a scene, with the first of its methods. `name` stands in messages, and its stem in the default of the output directory.
///
/// # Errors
/// [`Refused`] with all that is wrong.
pub fn parse(name: &str, text: &str, overrides: &[String]) -> Result<SceneFile, Box<Refused>> {
    parse_method(name, text, overrides, 0)
}

/// The scene with the method `number` of several.
fn parse_method(name: &str, text: &str, overrides: &[String], number: usize) -> Result<SceneFile, Box<Refused>> {
    let mut problems = Vec::new();
    let (document, root) = Document::parse(name, text, overrides, number, &mut problems);
    let mut findings = Findings::new(&document, problems);
    let raw: Option<raw::RawScene> = root.and_then(|root| {
        let other = planned::of_test(root.get_ref()).or_else(|| planned::of_records(root.get_ref()));
        read(root, other, schema::of_structure(), &mut findings)
    });
    let scene = raw.and_then(|raw| check::scene(&raw, &stem(name), &mut findings));
    let mut file = finish(scene, findings)?;
    file.scene.warnings = file.warning_sentences();
    Ok(file)
}

/// Reads and checks the text of a scene of measured records, in the same way; paths of its files count from the directory of `name`.
///
/// # Errors
/// [`Refused`] with all that is wrong.
pub fn parse_records(name: &str, text: &str, overrides: &[String]) -> Result<SceneFile<RecordScene>, Box<Refused>> {
    let mut problems = Vec::new();
    let (document, root) = Document::parse(name, text, overrides, 0, &mut problems);
    let mut findings = Findings::new(&document, problems);
    let raw: Option<raw::RawRecordScene> = root.and_then(|root| {
        let other = planned::of_test(root.get_ref()).or_else(|| planned::not_of_records(root.get_ref()));
        read(root, other, schema::of_records(), &mut findings)
    });
    let base = Path::new(name).parent().unwrap_or(Path::new("")).to_path_buf();
    let scene = raw.and_then(|raw| check::record_scene(&raw, &stem(name), base, &mut findings));
    let mut file = finish(scene, findings)?;
    file.scene.warnings = file.warning_sentences();
    Ok(file)
}

/// Reads and checks the text of a scene of a virtual test, in the same way.
///
/// # Errors
/// [`Refused`] with all that is wrong.
pub fn parse_test(name: &str, text: &str, overrides: &[String]) -> Result<SceneFile<TestScene>, Box<Refused>> {
    let mut problems = Vec::new();
    let (document, root) = Document::parse(name, text, overrides, 0, &mut problems);
    let mut findings = Findings::new(&document, problems);
    let raw: Option<raw::RawTestScene> = root.and_then(|root| {
        let other = planned::of_test_and_branch(root.get_ref());
        read(root, other, schema::of_test(), &mut findings)
    });
    let scene = raw.and_then(|raw| check::test_scene(&raw, &stem(name), &mut findings));
    let mut file = finish(scene, findings)?;
    file.scene.warnings = file.warning_sentences();
    Ok(file)
}

/// Reads and checks a scene file for `run`: of a virtual test, or of a structure.
///
/// # Errors
/// [`Refused`] with all that is wrong; also a scene of measured records, with the command that takes it.
pub fn load_to_run(path: &Path, overrides: &[String]) -> Result<AnyScene, Box<Refused>> {
    let (name, text) = text(path)?;
    let (_, root) = Document::parse(&name, &text, overrides, 0, &mut Vec::new());
    if root.is_some_and(|root| planned::is_of_test(root.get_ref())) {
        return Ok(AnyScene::Test(Box::new(parse_test(&name, &text, overrides)?)));
    }
    Ok(AnyScene::Structure(parse_each_method(&name, &text, overrides)?))
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
        _ => Err(Box::new(Refused::new(document, findings.into_sorted()))),
    }
}

fn stem(name: &str) -> String {
    Path::new(name).file_stem().map_or_else(|| "scene".into(), |stem| stem.to_string_lossy().into_owned())
}

//! From a file or a text to a checked scene.

mod sensitivity;

pub use sensitivity::overrides_at;

use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::DeTable;

use crate::text::Text;
use crate::{
    AnyScene, Diagnostic, Diagnostics, Document, FileError, RecordScene, SceneError, SceneFile, TestScene, check,
    conform, file, planned, raw, scene_file, schema,
};

/// Reads and checks a scene file of a structure, with the overrides `key=value` of the command line. With several
/// methods, `[[method]]`, it is a scene for each; an override of `method` holds for all of them.
///
/// # Errors
/// [`SceneError`] with all that is wrong with any of them, each mistake once.
pub fn load_structure(path: &Path, overrides: &[String]) -> Result<AnyScene, SceneError> {
    let (name, text) = content(path)?;
    parse_each_method(&name, &text, overrides).map(AnyScene::Structure)
}

/// Reads and checks the text of a scene, with each of its methods; `name` as for [`parse`].
///
/// # Errors
/// [`SceneError`] with all that is wrong with any of them, each mistake once.
pub fn parse_each_method(name: &str, text: &str, overrides: &[String]) -> Result<Vec<SceneFile>, SceneError> {
    each_method(Read::new(&Text::new(name, text), overrides, 0), overrides)
}

/// Reads and checks a scene file of measured records, in the same way.
///
/// # Errors
/// [`SceneError`] with all that is wrong.
pub fn load_records(path: &Path, overrides: &[String]) -> Result<AnyScene, SceneError> {
    let (name, text) = content(path)?;
    parse_records(&name, &text, overrides).map(|file| AnyScene::Records(Box::new(file)))
}

/// Reads and checks a scene file of any kind.
///
/// # Errors
/// [`SceneError`] with all that is wrong.
pub fn load_any(path: &Path, overrides: &[String]) -> Result<AnyScene, SceneError> {
    let (name, text) = content(path)?;
    parse_any(&name, &text, overrides)
}

/// Reads and checks the text of a scene of any kind; `name` as for [`parse`].
///
/// # Errors
/// [`SceneError`] with all that is wrong.
pub fn parse_any(name: &str, text: &str, overrides: &[String]) -> Result<AnyScene, SceneError> {
    let text = Text::new(name, text);
    let first = Read::new(&text, overrides, 0);
    if first.is(planned::is_of_test) {
        return Ok(AnyScene::Test(Box::new(test(first)?)));
    }
    if first.is(planned::is_of_records) {
        return Ok(AnyScene::Records(Box::new(records(first)?)));
    }
    Ok(AnyScene::Structure(each_method(first, overrides)?))
}

/// Reads and checks a scene file for `run`: of a virtual test, or of a structure.
///
/// # Errors
/// [`SceneError`] with all that is wrong; also a scene of measured records, with the command that takes it.
pub fn load_to_run(path: &Path, overrides: &[String]) -> Result<AnyScene, SceneError> {
    let (name, text) = content(path)?;
    let text = Text::new(&name, &text);
    let first = Read::new(&text, overrides, 0);
    if first.is(planned::is_of_test) {
        return Ok(AnyScene::Test(Box::new(test(first)?)));
    }
    Ok(AnyScene::Structure(each_method(first, overrides)?))
}

/// Reads and checks the text of a scene, with the first of its methods. `name` is used in messages, and its stem in the
/// default of the output directory.
///
/// # Errors
/// [`SceneError`] with all that is wrong.
pub fn parse(name: &str, text: &str, overrides: &[String]) -> Result<SceneFile, SceneError> {
    one_method(Read::new(&Text::new(name, text), overrides, 0))
}

/// Reads and checks the text of a scene of measured records, in the same way; paths of its files count from the
/// directory of `name`.
///
/// # Errors
/// [`SceneError`] with all that is wrong.
pub fn parse_records(name: &str, text: &str, overrides: &[String]) -> Result<SceneFile<RecordScene>, SceneError> {
    records(Read::new(&Text::new(name, text), overrides, 0))
}

/// Reads and checks the text of a scene of a virtual test, in the same way.
///
/// # Errors
/// [`SceneError`] with all that is wrong.
pub fn parse_test(name: &str, text: &str, overrides: &[String]) -> Result<SceneFile<TestScene>, SceneError> {
    test(Read::new(&Text::new(name, text), overrides, 0))
}

/// Name and text of a scene file.
fn content(path: &Path) -> Result<(String, String), SceneError> {
    let name = path.display().to_string();
    match file::read(path) {
        Ok(text) => Ok((name, text)),
        Err(error) => Err(refuse_file(&name, &error)),
    }
}

fn refuse_file(name: &str, error: &FileError) -> SceneError {
    let (document, _) = Document::new(&Text::new(name, ""), &[], 0, &mut Vec::new());
    SceneError::of_checks(document, vec![error.diagnostic(name)])
}

/// A text with its overrides and one of its methods: what there is before its kind is known.
struct Read<'t, 'a> {
    text: &'t Text<'a>,
    overrides: &'a [String],
    method: usize,
    document: Document,
    root: Option<Spanned<DeTable<'a>>>,
    diagnostics: Vec<Diagnostic>,
}

impl<'t, 'a> Read<'t, 'a> {
    fn new(text: &'t Text<'a>, overrides: &'a [String], method: usize) -> Self {
        let mut diagnostics = Vec::new();
        let (document, root) = Document::new(text, overrides, method, &mut diagnostics);
        Self { text, overrides, method, document, root, diagnostics }
    }

    fn is(&self, of_kind: fn(&DeTable<'_>) -> bool) -> bool {
        self.root.as_ref().is_some_and(|root| of_kind(root.get_ref()))
    }
}

/// The scenes of all methods, of which the first one is read.
fn each_method<'a>(first: Read<'_, 'a>, overrides: &'a [String]) -> Result<Vec<SceneFile>, SceneError> {
    let text = first.text;
    let others = (1..text.n_methods()).map(|number| one_method(Read::new(text, overrides, number)));
    scene_file::or_all(std::iter::once(one_method(first)).chain(others).collect())
}

/// The scene with one method.
fn one_method(read: Read<'_, '_>) -> Result<SceneFile, SceneError> {
    let (text, overrides, method) = (read.text, read.overrides, read.method);
    let mut file = one_state(read)?;
    sensitivity::add_states(text, overrides, method, &mut file)?;
    Ok(file)
}

/// The scene with one method, without what it is at other values of its parameters.
fn one_state(read: Read<'_, '_>) -> Result<SceneFile, SceneError> {
    let Read { text, document, root, diagnostics, .. } = read;
    let mut diagnostics = Diagnostics::new(&document, diagnostics);
    let other =
        root.as_ref().and_then(|root| planned::of_test(root.get_ref()).or_else(|| planned::of_records(root.get_ref())));
    let stem = stem(text.name);
    let scene = if root.as_ref().is_some_and(|root| planned::is_of_matrices(root.get_ref())) {
        let raw: Option<raw::RawMatrixScene> =
            root.and_then(|root| tables(root, other, schema::of_matrices(), &mut diagnostics));
        let raw = raw.map(|raw| raw::RawMatrixScene {
            analysis: raw.analysis.beside(raw.contact.iter().flatten().map(|contact| &contact.stop)),
            ..raw
        });
        raw.and_then(|raw| check::matrix_scene(&raw, &stem, &base(text.name), &mut diagnostics))
    } else if root.as_ref().is_some_and(|root| planned::is_of_reduced(root.get_ref())) {
        let raw: Option<raw::RawReducedScene> =
            root.and_then(|root| tables(root, other, schema::of_reduced(), &mut diagnostics));
        let raw = raw.map(|raw| raw::RawReducedScene {
            analysis: raw.analysis.beside(raw.contact.iter().flatten().map(|contact| &contact.stop)),
            ..raw
        });
        raw.and_then(|raw| check::reduced_scene(&raw, &stem, &base(text.name), &mut diagnostics))
    } else if root.as_ref().is_some_and(|root| planned::is_of_bodies(root.get_ref())) {
        let raw: Option<raw::RawBodiesScene> =
            root.and_then(|root| tables(root, other, schema::of_bodies(), &mut diagnostics));
        let raw = raw.map(|raw| raw::RawBodiesScene {
            analysis: raw.analysis.beside(raw.contact.iter().flatten().map(|contact| &contact.stop)),
            ..raw
        });
        raw.and_then(|raw| check::bodies_scene(&raw, &stem, &base(text.name), &mut diagnostics))
    } else {
        let raw: Option<raw::RawScene> =
            root.and_then(|root| tables(root, other, schema::of_structure(), &mut diagnostics));
        let raw = raw.map(|raw| raw::RawScene {
            analysis: raw.analysis.beside(raw.contact.iter().flatten().map(|contact| &contact.stop)),
            ..raw
        });
        raw.and_then(|raw| check::scene(&raw, &stem, &base(text.name), &mut diagnostics))
    };
    let mut file = finish(scene, diagnostics)?;
    file.scene.warnings = file.warning_sentences();
    Ok(file)
}

/// The scene of measured records.
fn records(read: Read<'_, '_>) -> Result<SceneFile<RecordScene>, SceneError> {
    let Read { text, document, root, diagnostics, .. } = read;
    let mut diagnostics = Diagnostics::new(&document, diagnostics);
    let raw: Option<raw::RawRecordScene> = root.and_then(|root| {
        let other = planned::of_test(root.get_ref()).or_else(|| planned::not_of_records(root.get_ref()));
        tables(root, other, schema::of_records(), &mut diagnostics)
    });
    let scene = raw.and_then(|raw| check::record_scene(&raw, &stem(text.name), base(text.name), &mut diagnostics));
    let mut file = finish(scene, diagnostics)?;
    file.scene.warnings = file.warning_sentences();
    Ok(file)
}

/// The scene of a virtual test.
fn test(read: Read<'_, '_>) -> Result<SceneFile<TestScene>, SceneError> {
    let Read { text, document, root, diagnostics, .. } = read;
    let mut diagnostics = Diagnostics::new(&document, diagnostics);
    let raw: Option<raw::RawTestScene> = root.and_then(|root| {
        let other = planned::of_test_and_branch(root.get_ref());
        tables(root, other, schema::of_test(), &mut diagnostics)
    });
    let scene = raw.and_then(|raw| check::test_scene(&raw, &stem(text.name), &base(text.name), &mut diagnostics));
    let mut file = finish(scene, diagnostics)?;
    file.scene.warnings = file.warning_sentences();
    Ok(file)
}

/// The raw tables, unless the scene is one of another kind.
fn tables<T: DeserializeOwned>(
    root: Spanned<DeTable<'_>>,
    other: Option<Diagnostic>,
    schema: &serde_json::Value,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<T> {
    if let Some(diagnostic) = other {
        diagnostics.push(diagnostic);
        return None;
    }
    let conforming = conform::conform(root.get_ref(), schema, diagnostics);
    // What must hold between values is checked of those that are sound.
    if diagnostics.refuse() { None } else { conform::read(conforming, diagnostics) }
}

fn finish<S>(scene: Option<S>, diagnostics: Diagnostics<'_>) -> Result<SceneFile<S>, SceneError> {
    let document = diagnostics.spelled_document();
    match scene {
        Some(scene) if !diagnostics.refuse() => {
            let warnings = diagnostics.into_sorted();
            Ok(SceneFile { scene, document, warnings, functions: Default::default() })
        }
        _ => Err(SceneError::of_checks(document, diagnostics.into_sorted())),
    }
}

/// The directory of a scene, from which paths of its files count.
fn base(name: &str) -> PathBuf {
    Path::new(name).parent().unwrap_or(Path::new("")).to_path_buf()
}

fn stem(name: &str) -> String {
    Path::new(name).file_stem().map_or_else(|| "scene".into(), |stem| stem.to_string_lossy().into_owned())
}

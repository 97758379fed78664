//! A scene with the texts that it was read from.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use nlmodes::hbm::ForceLaw;

use crate::{Diagnostic, Document, RecordScene, Scene, SceneError, TestScene, diagnostic};

/// A scene with the texts it was read from, so that what turns out to be wrong later is shown at its place too.
#[derive(Debug, Clone)]
pub struct SceneFile<S = Scene> {
    /// The checked scene.
    pub scene: S,
    /// Positions of its keys.
    pub document: Document,
    /// Warnings.
    pub warnings: Vec<Diagnostic>,
    /// Laws of springs that the program gives which computes the scene, by their names in the scene.
    pub functions: BTreeMap<String, Arc<dyn ForceLaw>>,
}

impl<S> SceneFile<S> {
    /// A checked scene without its text, such as that of results; `name` is used in messages.
    pub fn without_text(scene: S, name: &str) -> Self {
        Self { scene, document: Document::empty(name), warnings: Vec::new(), functions: BTreeMap::new() }
    }

    /// The error `title` at the value of the key at `path` (as `contact.0.gap_m`); `label` is printed beside the value.
    pub fn error_at(&self, path: &str, title: &str, label: &str, help: &[&str]) -> SceneError {
        let diagnostic = help.iter().fold(Diagnostic::error(title), |diagnostic, help| diagnostic.help(*help));
        SceneError::new(self.document.clone(), self.document.put(diagnostic, path, label))
    }

    /// Adds a warning at the value of a key.
    pub fn warn_at(&mut self, path: &str, title: &str, label: &str, help: &str) {
        let diagnostic = self.document.put(Diagnostic::warning(title).help(help), path, label);
        self.warnings.push(diagnostic);
    }

    /// The warnings as text; empty if there are none.
    pub fn warnings_text(&self, colours: bool) -> String {
        self.document.render(&self.warnings, colours)
    }

    /// The warnings, a line each without its place.
    pub fn warning_sentences(&self) -> Vec<String> {
        self.warnings.iter().map(Diagnostic::sentence).collect()
    }
}

/// All scenes of a file with several methods, or the errors of any of them.
pub(crate) fn or_all(read: Vec<Result<SceneFile, SceneError>>) -> Result<Vec<SceneFile>, SceneError> {
    if read.iter().all(Result::is_ok) {
        return Ok(read.into_iter().flatten().collect());
    }
    let mut first: Option<Document> = None;
    let mut diagnostics = Vec::new();
    for scene in read {
        match scene {
            Ok(file) => diagnostics.extend(file.warnings),
            Err(error) => {
                let (document, found) = error.into_parts();
                diagnostics.extend(found);
                first.get_or_insert(document);
            }
        }
    }
    // All of them share their texts, so that a place in one is the same place in the other.
    match first {
        Some(document) => Err(SceneError::of_checks(document, diagnostic::each_once(diagnostics))),
        None => Ok(Vec::new()),
    }
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

impl AnyScene {
    /// Positions of its keys.
    pub fn document(&self) -> Option<&Document> {
        match self {
            Self::Structure(files) => files.first().map(|file| &file.document),
            Self::Records(file) => Some(&file.document),
            Self::Test(file) => Some(&file.document),
        }
    }

    /// Where its results go.
    pub fn output_directory(&self) -> Option<&Path> {
        match self {
            Self::Structure(files) => files.first().map(|file| file.scene.output_directory.as_path()),
            Self::Records(file) => Some(&file.scene.output_directory),
            Self::Test(file) => Some(&file.scene.output_directory),
        }
    }

    /// Lets its results go elsewhere.
    pub fn set_output_directory(&mut self, directory: &Path) {
        match self {
            Self::Structure(files) => files.iter_mut().for_each(|file| file.scene.output_directory = directory.into()),
            Self::Records(file) => file.scene.output_directory = directory.into(),
            Self::Test(file) => file.scene.output_directory = directory.into(),
        }
    }

    /// Warnings, each once.
    pub fn warnings(&self) -> Vec<Diagnostic> {
        diagnostic::each_once(match self {
            Self::Structure(files) => files.iter().flat_map(|file| file.warnings.iter().cloned()).collect(),
            Self::Records(file) => file.warnings.clone(),
            Self::Test(file) => file.warnings.clone(),
        })
    }

    /// The warnings as text; empty if there are none.
    pub fn warnings_text(&self, colours: bool) -> String {
        self.document().map_or_else(String::new, |document| document.render(&self.warnings(), colours))
    }
}

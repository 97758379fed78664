//! Reading a file or text to a checked study.

use std::fs;
use std::path::Path;

use nlmodes_scene::{SceneError, SceneFile, Severity, load_other, parse_other, schema_for};
use serde_json::Value;

use crate::design::Points;
use crate::raw::RawStudy;
use crate::study::Study;
use crate::{case, check};

/// JSON schema of a study file (draft 2020-12).
pub fn schema() -> Value {
    schema_for::<RawStudy>()
}

/// A study with the text it was read from.
pub type StudyFile = SceneFile<Study>;

impl Study {
    /// Reads and checks a study file, and the scene that it names.
    ///
    /// # Errors
    /// [`SceneError`] with all errors of the study or its scene.
    pub fn load(path: &Path) -> Result<StudyFile, SceneError> {
        let name = path.display().to_string();
        with_sound_scene(load_other(path, "study", |raw: &RawStudy, diagnostics| {
            check::study(raw, &name, |scene| fs::read_to_string(scene).map_err(|error| error.to_string()), diagnostics)
        })?)
    }

    /// Reads and checks the text of a study; `name` is used in messages, and paths are relative to its directory.
    ///
    /// # Errors
    /// [`SceneError`] with all errors of the study or its scene.
    pub fn parse(name: &str, text: &str) -> Result<StudyFile, SceneError> {
        with_sound_scene(parse_other(name, text, "study", |raw: &RawStudy, diagnostics| {
            check::study(raw, name, |scene| fs::read_to_string(scene).map_err(|error| error.to_string()), diagnostics)
        })?)
    }

    /// The same with the text of the scene, which is not read from a file.
    ///
    /// # Errors
    /// [`SceneError`] with all errors of the study or its scene.
    pub fn parse_with_scene(name: &str, text: &str, scene: &str) -> Result<StudyFile, SceneError> {
        with_sound_scene(parse_other(name, text, "study", |raw: &RawStudy, diagnostics| {
            check::study(raw, name, |_| Ok(scene.to_owned()), diagnostics)
        })?)
    }
}

/// Rejects the study if its scene has errors as written, not only with the values of a case.
fn with_sound_scene(file: StudyFile) -> Result<StudyFile, SceneError> {
    let Err(refused) = case::resolve(&file.scene, &Points::new(&file.scene).get(0)) else { return Ok(file) };
    let written = |diagnostic: &nlmodes_scene::Diagnostic| {
        // Argument names differ from those of the file.
        let found = diagnostic.place.as_ref().map(|mark| mark.range.end <= file.scene.scene_text.len());
        diagnostic.severity == Severity::Error && found.unwrap_or(true)
    };
    if refused.diagnostics().iter().any(written) { Err(refused) } else { Ok(file) }
}

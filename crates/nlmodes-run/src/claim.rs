//! Whose results are in the output directory: those of another scene are not overwritten unasked.

mod keys;
mod replaced;

use std::cell::Cell;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use nlmodes::modal::EndReason;
use nlmodes::report::{ReportError, write_summary};
use serde_json::{Value, json};

use crate::files::{
    DEPTH, RUN, STEPS, folders, remove_all, remove_ends, remove_figures_of_records, remove_temporary, summary,
};
use crate::{Event, Observer, RunError, started_in};
use keys::written_key;
use nlmodes_scene::{Document, SceneFile};
use replaced::Replaced;

/// Most differences between two scenes that are shown.
const MAX_SHOWN: usize = 5;

/// Computations of a virtual test in addition to its levels.
const BACKBONES: [&str; 4] =
    ["backbone.csv", "backbone_ms-hbm.csv", "backbone_damped-mode.csv", "backbone_phase-resonance.csv"];

/// What may be overwritten.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Over {
    /// Results of the same scene.
    Same,
    /// Nothing: they are continued.
    Resumed,
    /// Anything that this program wrote.
    Anything,
}

/// An output directory that may be written; its clones are the same one.
#[derive(Debug, Clone)]
pub struct Claim {
    directory: PathBuf,
    content: Value,
    over: Over,
    taken: Rc<Cell<bool>>,
}

impl Claim {
    /// Looks whether the directory may be written; writes nothing yet.
    ///
    /// # Errors
    /// [`RunError`], where it holds the results of another scene or another run is at work in it.
    pub fn new(
        directory: &Path,
        document: &Document,
        scenes: Value,
        over: Over,
        observer: &mut dyn Observer,
    ) -> Result<Self, RunError> {
        if in_use(&directory.join(STEPS)) {
            return Err(RunError::InUse { directory: directory.to_path_buf() });
        }
        if over != Over::Anything
            && let Some(reason) = foreign(directory, &scenes, over, document)
        {
            return Err(RunError::Foreign { reason });
        }
        if over == Over::Same
            && let Some(points) = interrupted(directory)
        {
            observer.event(Event::Abandoned { directory, points });
        }
        let Replaced { certificates, drawn } = Replaced::below(directory, DEPTH);
        let certificates = if observer.certifies() { 0 } else { certificates };
        if certificates + drawn > 0 {
            observer.event(Event::Replaces { directory, certificates, drawn });
        }
        let content = json!({
            "program": "nlmodes-cli",
            "version": env!("CARGO_PKG_VERSION"),
            "file": document.sources().file().name,
            "scenes": scenes,
        });
        Ok(Self { directory: directory.to_path_buf(), content, over, taken: Rc::default() })
    }

    /// The output directory of scenes that differ in their method only, which the first one names.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of_scenes(files: &[SceneFile], over: Over, observer: &mut dyn Observer) -> Result<Self, RunError> {
        let first = files.first().ok_or(RunError::NoScene)?;
        let scene = |file: &SceneFile| identity(serde_json::to_value(&file.scene).unwrap_or_default());
        let scenes = Value::Array(files.iter().map(scene).collect());
        Self::new(&first.scene.output_directory, &first.document, scenes, over, observer)
    }

    /// Whether an earlier run is continued.
    pub fn resumes(&self) -> bool {
        self.over == Over::Resumed
    }

    /// As [`take`](Self::take), before anything was computed.
    ///
    /// # Errors
    /// [`RunError::Unwritable`] if it cannot be written.
    pub fn take_at_once(&self) -> Result<(), RunError> {
        let directory = self.directory.clone();
        self.take().map_err(|source| RunError::Unwritable { directory, source, kept: false })
    }

    /// Claims the directory: removes files of an earlier run that this one may not rewrite, and records the scene of
    /// the results.
    ///
    /// # Errors
    /// [`ReportError`] if it cannot be written.
    pub fn take(&self) -> Result<(), ReportError> {
        if self.taken.replace(true) {
            return Ok(());
        }
        let directory = &self.directory;
        fs::create_dir_all(directory).map_err(|source| ReportError::Io { path: directory.clone(), source })?;
        remove_ends(directory);
        remove_figures_of_records(directory);
        remove_temporary(directory);
        if !self.resumes() {
            remove_all(directory, &["branch.csv", "modal_points.csv", STEPS]);
            remove_all(directory, &BACKBONES);
        }
        let content = self.content.as_object().into_iter().flatten().map(|(key, value)| (key.clone(), value.clone()));
        let folder = started_in::seen_from(directory).map(|folder| ("folder".to_owned(), json!(folder)));
        write_summary(directory.join(RUN), &content.chain(folder).collect::<Value>())
    }
}

/// A scene without keys that do not influence its results.
pub fn identity(mut scene: Value) -> Value {
    if let Some(scene) = scene.as_object_mut() {
        scene.remove("title");
        scene.remove("output_directory");
        scene.remove("files");
        scene.remove("overlays");
    }
    scene
}

/// Whether another process has the file locked.
fn in_use(path: &Path) -> bool {
    File::open(path).is_ok_and(|file| matches!(file.try_lock(), Err(TryLockError::WouldBlock)))
}

/// Why the directory is not to be written; `None` if it may be. Keys are named as the document has them.
fn foreign(directory: &Path, scenes: &Value, over: Over, document: &Document) -> Option<String> {
    let place = directory.display();
    let known = match read(directory) {
        Ok(known) => known?,
        Err(why) => return Some(format!("{place} holds results whose scene cannot be determined: {why}")),
    };
    if over == Over::Resumed && known["version"] != env!("CARGO_PKG_VERSION") {
        let version = known["version"].as_str().unwrap_or("another version");
        return Some(format!("{place} was computed by nlmodes-cli {version}, from which this version does not go on"));
    }
    let mut found = Vec::new();
    differences("", &known["scenes"], scenes, &mut found);
    if over == Over::Resumed && !asks_for_fewer_points(&known["scenes"], scenes) {
        // More points may be requested; with fewer, some existing ones would be lost.
        found.retain(|(key, _)| !key.ends_with("continuation.max_points"));
    }
    if found.is_empty() {
        return None;
    }
    let mut text = format!("{place} has the results of another scene and is left alone");
    for (key, what) in found.iter().take(MAX_SHOWN) {
        text += &format!("\n  {}: {what}", written_key(key, document));
    }
    if found.len() > MAX_SHOWN {
        text += &format!("\n  … and {} more", found.len() - MAX_SHOWN);
    }
    Some(text)
}

/// Whether some limit of points is lower than it was.
fn asks_for_fewer_points(known: &Value, wanted: &Value) -> bool {
    match (known, wanted) {
        (Value::Object(known), Value::Object(wanted)) => wanted.iter().any(|(key, wanted)| match known.get(key) {
            Some(known) if key == "max_points" => wanted.as_u64() < known.as_u64(),
            Some(known) => asks_for_fewer_points(known, wanted),
            None => false,
        }),
        (Value::Array(known), Value::Array(wanted)) => {
            known.iter().zip(wanted).any(|(known, wanted)| asks_for_fewer_points(known, wanted))
        }
        _ => false,
    }
}

/// The record of the results in the directory; `None` if there is none.
fn read(directory: &Path) -> Result<Option<Value>, String> {
    let parsed = |path: &Path| -> Result<Option<Value>, String> {
        match fs::read(path) {
            Ok(bytes) => {
                serde_json::from_slice(&bytes).map(Some).map_err(|error| format!("{}: {error}", path.display()))
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) if error.kind() == io::ErrorKind::NotADirectory => Ok(None),
            Err(error) => Err(format!("{}: {error}", path.display())),
        }
    };
    if let Some(known) = parsed(&directory.join(RUN))? {
        return Ok(Some(known));
    }
    let results = ["branch.csv", "modal_points.csv", "summary.json", STEPS];
    if results.iter().any(|name| directory.join(name).exists()) {
        return Err(format!("there is no {RUN}"));
    }
    Ok(None)
}

/// How many points the directory has of a run that was cut off or stopped; `None` where there is none.
fn interrupted(directory: &Path) -> Option<usize> {
    let stopped = match directory.join("summary.json").is_file() {
        true => {
            let summary = summary(directory);
            let lists = ["branches", "curves"].into_iter().filter_map(|list| summary[list].as_array());
            let ends = lists.flatten().map(|one| if one["end"].is_object() { &one["end"] } else { one });
            let ends = ends.chain([&summary["end"]]);
            let mut reasons = ends.into_iter().filter_map(|end| end["reason"].as_str()).flat_map(str::split_whitespace);
            reasons.any(|reason| reason == EndReason::Stopped.name())
        }
        // A run writes it at its end.
        false => true,
    };
    Some(points_below(directory, DEPTH)).filter(|points| stopped && *points > 0)
}

/// Rows of tables with steps, in a directory and its folders.
fn points_below(directory: &Path, depth: usize) -> usize {
    let own = if directory.join(STEPS).is_file() {
        let table = fs::read_to_string(directory.join("branch.csv")).unwrap_or_default();
        table.lines().count().saturating_sub(1)
    } else {
        0
    };
    let below = if depth > 0 { folders(directory) } else { Vec::new() };
    own + below.iter().map(|folder| points_below(folder, depth - 1)).sum::<usize>()
}

/// Keys whose values differ, and what they are.
fn differences(key: &str, there: &Value, here: &Value, found: &mut Vec<(String, String)>) {
    let below = |name: &str| if key.is_empty() { name.to_owned() } else { format!("{key}.{name}") };
    match (there, here) {
        (Value::Object(old), Value::Object(new)) => {
            let names: std::collections::BTreeSet<&String> = old.keys().chain(new.keys()).collect();
            for name in names {
                let value = |of: &serde_json::Map<String, Value>| of.get(name).cloned().unwrap_or(Value::Null);
                differences(&below(name), &value(old), &value(new), found);
            }
        }
        (Value::Array(old), Value::Array(new)) if old.len() == new.len() => {
            // The number of the only scene is meaningless.
            let single = key.is_empty() && old.len() == 1;
            for (i, (old, new)) in old.iter().zip(new).enumerate() {
                differences(&if single { String::new() } else { below(&i.to_string()) }, old, new, found);
            }
        }
        (old, new) if old == new => {}
        (old, new) => found.push((if key.is_empty() { "the scene".into() } else { key.into() }, said(old, new))),
    }
}

fn said(there: &Value, here: &Value) -> String {
    let short = |value: &Value| match value {
        Value::Null => Some("none".to_owned()),
        Value::Array(_) | Value::Object(_) | Value::String(_) => {
            let text = value.to_string();
            (text.len() < 60).then_some(text)
        }
        _ => Some(value.to_string()),
    };
    match (short(there), short(here)) {
        (Some(there), Some(here)) => format!("{there} there, {here} here"),
        _ => "differs".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_that_was_stopped_on_one_of_two_ways_was_interrupted() {
        let directory = tempfile::tempdir().unwrap();
        let put = |name: &str, text: &str| fs::write(directory.path().join(name), text).unwrap();
        put(STEPS, "");
        put("branch.csv", "point\n0\n1\n");
        for (reason, points) in [("stopped", Some(2)), ("max-energy stopped", Some(2)), ("max-energy closed", None)] {
            put("summary.json", &json!({ "end": { "reason": reason } }).to_string());
            assert_eq!(interrupted(directory.path()), points, "{reason}");
            put("summary.json", &json!({ "curves": [{ "end": { "reason": reason } }] }).to_string());
            assert_eq!(interrupted(directory.path()), points, "a curve, {reason}");
        }
    }
}

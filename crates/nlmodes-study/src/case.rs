//! One case: a point of the design with one method and one number of harmonics.

mod name;

use std::sync::Arc;

use nlmodes_scene::{SceneError, SceneFile, parse_each_method};
use serde_json::Value;

use crate::design::Points;
use crate::parallel;
use crate::study::Study;
pub use name::hex;
use name::id;

/// A case as in the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Number in the study, or in its shard, from 0.
    pub number: usize,
    /// Number of its point in the design, from 0.
    pub point: usize,
    /// Index of the method and number of harmonics of its point, from 0.
    pub part: usize,
    /// Value of each variable; if several keys vary together, that of the first one.
    pub values: Vec<Value>,
    /// Method of its scene; empty if it is rejected.
    pub method: &'static str,
    /// Number of harmonics of its scene; 0 if it is rejected.
    pub harmonics: usize,
    /// Name of its directory: a hash of the resolved scene and the version of the program. Or why its scene is
    /// rejected.
    pub id: Result<String, Arc<str>>,
}

/// The scene of a case, ready to run except for its directory.
#[derive(Debug, Clone)]
pub struct Resolved {
    /// With one method and one number of harmonics.
    pub file: SceneFile,
    /// As [`Case::id`].
    pub id: String,
    /// The `--set` arguments that create it from the scene of the study.
    pub set: Vec<String>,
}

/// The `--set` arguments for a point of the design.
pub fn overrides(study: &Study, point: &[Vec<Value>]) -> Vec<String> {
    let pairs = study.variables.iter().zip(point).flat_map(|(variable, values)| variable.keys.iter().zip(values));
    pairs.map(|(key, value)| setting(key, value)).collect()
}

/// The `--set` argument for a key and its value.
pub fn setting(key: &str, value: &Value) -> String {
    format!("{key}={}", toml(value))
}

/// A value as TOML.
fn toml(value: &Value) -> String {
    match value {
        Value::Number(number) if number.is_f64() => format!("{:?}", number.as_f64().unwrap_or(f64::NAN)),
        Value::Array(items) => format!("[{}]", items.iter().map(toml).collect::<Vec<_>>().join(", ")),
        Value::Object(entries) => {
            let entries: Vec<String> = entries.iter().map(|(key, value)| format!("{key} = {}", toml(value))).collect();
            format!("{{ {} }}", entries.join(", "))
        }
        // JSON strings are TOML strings.
        other => other.to_string(),
    }
}

/// The scenes of a point: one for each method and number of harmonics.
///
/// # Errors
/// [`SceneError`], the errors of the scene with these values.
pub fn resolve(study: &Study, point: &[Vec<Value>]) -> Result<Vec<Resolved>, SceneError> {
    match study.design.is_differentiated() {
        true => resolve_differentiated(study, overrides(study, point)),
        false => resolve_set(study, overrides(study, point)),
    }
}

/// The scenes with these values, in the form of `--set`.
///
/// # Errors
/// [`SceneError`], the errors of the scene with these values.
pub fn resolve_set(study: &Study, set: Vec<String>) -> Result<Vec<Resolved>, SceneError> {
    resolve_text(study, &study.scene_text, set)
}

/// The scenes with these values, whose points are differentiated by all keys of the variables, beside those by which
/// the scene differentiates them itself.
///
/// # Errors
/// [`SceneError`], the errors of the scene with these values, such as that it has no gradients.
pub fn resolve_differentiated(study: &Study, set: Vec<String>) -> Result<Vec<Resolved>, SceneError> {
    let files = parse_each_method(&study.scene_name, &study.scene_text, &set)?;
    let own = files.first().map(|file| file.scene.sensitivities.as_slice()).unwrap_or_default();
    let mut text = study.scene_text.clone();
    let keys = study.variables.iter().flat_map(|variable| &variable.keys);
    for key in keys.filter(|key| own.iter().all(|own| own.key != **key)) {
        text.push_str(&format!("\n[[sensitivity]]\nkey = {}\n", toml(&Value::from(key.as_str()))));
    }
    resolve_text(study, &text, set)
}

fn resolve_text(study: &Study, text: &str, set: Vec<String>) -> Result<Vec<Resolved>, SceneError> {
    let files = parse_each_method(&study.scene_name, text, &set)?;
    let mut parts = Vec::new();
    for file in files {
        let list = file.scene.method.harmonics_list.clone();
        for &harmonics in &list {
            let mut own = file.clone();
            let mut set = set.clone();
            set.extend((list.len() > 1).then(|| format!("method.harmonics={harmonics}")));
            own.scene.method.harmonics = harmonics;
            own.scene.method.harmonics_list = vec![harmonics];
            let id = id(&own);
            parts.push(Resolved { file: own, id, set });
        }
    }
    Ok(parts)
}

/// All cases of a study in their order, with their scenes read by this many threads.
pub fn cases(study: &Study, threads: usize) -> Vec<Case> {
    cases_of(study, |_| true, threads)
}

/// Those of some points of the design, as of a shard: nothing is read of the others.
pub fn cases_of(study: &Study, has: impl Fn(usize) -> bool + Sync, threads: usize) -> Vec<Case> {
    let points = Points::new(study);
    let of = |number| if has(number) { of_point(study, number, &points.get(number)) } else { Vec::new() };
    let mut cases = parallel::each(points.len(), threads, of).concat();
    cases.iter_mut().enumerate().for_each(|(number, case)| case.number = number);
    cases
}

fn of_point(study: &Study, number: usize, point: &[Vec<Value>]) -> Vec<Case> {
    let values: Vec<Value> = point.iter().map(|keys| keys.first().cloned().unwrap_or_default()).collect();
    let case = |part, method, harmonics, id| Case {
        number: 0,
        point: number,
        part,
        values: values.clone(),
        method,
        harmonics,
        id,
    };
    match resolve(study, point) {
        Ok(parts) => {
            let one = |(part, resolved): (usize, Resolved)| {
                let method = &resolved.file.scene.method;
                case(part, method.kind.name(), method.harmonics, Ok(resolved.id))
            };
            parts.into_iter().enumerate().map(one).collect()
        }
        Err(refused) => vec![case(0, "", 0, Err(refused.sentence().into()))],
    }
}

//! Names of cases: hashes of everything on which their results depend.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::SystemTime;

use nlmodes_scene::SceneFile;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

/// Keys of a scene without influence on the results of its branch.
const WITHOUT_INFLUENCE: [&str; 4] = ["title", "output_directory", "warnings", "files"];

/// A hash of everything that influences the results: the scene with all its defaults, the contents of its files, the
/// version of the program.
pub fn id(file: &SceneFile) -> String {
    let mut scene = serde_json::to_value(&file.scene).unwrap_or_default();
    if let Some(scene) = scene.as_object_mut() {
        WITHOUT_INFLUENCE.iter().for_each(|key| drop(scene.remove(*key)));
    }
    if let Some(structure) = scene.get_mut("structure").filter(|structure| structure.get("files").is_some()) {
        read_files(structure);
    }
    let mut text = String::new();
    canonical(&json!({ "version": env!("CARGO_PKG_VERSION"), "scene": scene }), &mut text);
    hex(&Sha256::digest(text.as_bytes())[..8])
}

/// Bytes as text.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// JSON with the keys of all objects in alphabetical order.
fn canonical(value: &Value, text: &mut String) {
    match value {
        Value::Object(entries) => {
            let mut sorted: Vec<(&String, &Value)> = entries.iter().collect();
            sorted.sort_by_key(|(key, _)| *key);
            text.push('{');
            for (key, value) in sorted {
                text.push_str(&format!("{key:?}:"));
                canonical(value, text);
                text.push(',');
            }
            text.push('}');
        }
        Value::Array(items) => {
            text.push('[');
            for item in items {
                canonical(item, text);
                text.push(',');
            }
            text.push(']');
        }
        single => text.push_str(&single.to_string()),
    }
}

/// Replaces the path of a file by its contents.
fn read_files(value: &mut Value) {
    match value {
        Value::Object(entries) => entries.values_mut().for_each(read_files),
        Value::Array(items) => items.iter_mut().for_each(read_files),
        Value::String(text) => {
            if let Some(digest) = digest(Path::new(text)) {
                *text = digest;
            }
        }
        _ => {}
    }
}

/// Cached digests, with length and time of the file.
type Known = HashMap<PathBuf, (u64, SystemTime, String)>;

/// Digest of a file, which is read again only if it has changed; `None` if there is no such file.
fn digest(path: &Path) -> Option<String> {
    static KNOWN: OnceLock<Mutex<Known>> = OnceLock::new();
    let data = fs::metadata(path).ok().filter(fs::Metadata::is_file)?;
    let (length, modified) = (data.len(), data.modified().ok()?);
    let mut known = KNOWN.get_or_init(Mutex::default).lock().unwrap_or_else(PoisonError::into_inner);
    match known.get(path) {
        Some((l, m, digest)) if (*l, *m) == (length, modified) => Some(digest.clone()),
        _ => {
            let mut hasher = Sha256::new();
            io::copy(&mut File::open(path).ok()?, &mut hasher).ok()?;
            let digest = hex(&hasher.finalize());
            known.insert(path.to_path_buf(), (length, modified, digest.clone()));
            Some(digest)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_count_by_what_is_in_them() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("k.mtx");
        let named = || {
            let mut value = json!({ "files": { "stiffness": { "path": path.to_str() } }, "kind": "no file" });
            read_files(&mut value);
            value
        };
        fs::write(&path, "1").unwrap();
        let first = named();
        assert_eq!(first["kind"], "no file");
        assert_eq!(first, named());
        fs::write(&path, "22").unwrap();
        assert_ne!(first, named());
    }

    #[test]
    fn the_order_of_keys_does_not_count() {
        let text = |value: &Value| {
            let mut text = String::new();
            canonical(value, &mut text);
            text
        };
        let (a, b): (Value, Value) = (
            serde_json::from_str(r#"{"b":[1,{"d":2,"c":3}],"a":0.1}"#).unwrap(),
            json!({"a": 0.1, "b": [1, {"c": 3, "d": 2}]}),
        );
        assert_eq!(text(&a), text(&b));
        assert_ne!(text(&a), text(&json!({"a": 0.1, "b": [{"c": 3, "d": 2}, 1]})));
    }
}

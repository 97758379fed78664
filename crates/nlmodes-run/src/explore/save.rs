//! A scene with other values: the original text except for these.

use std::collections::BTreeMap;
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Maximum number of scenes saved beside one.
const MOST: usize = 1000;

/// A number as in a scene: integers without a decimal point.
pub fn number(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e9 { format!("{value:.0}") } else { nlmodes_scene::number(value) }
}

/// Writes the text with these values beside the scene, under an unused name.
pub fn save(path: &Path, text: &str, values: &BTreeMap<String, f64>) -> Result<PathBuf, String> {
    let changed = with_values(path, text, values)?;
    let stem = path.file_stem().map_or_else(|| "scene".into(), |stem| stem.to_string_lossy().into_owned());
    for number in 1..=MOST {
        let ending = if number == 1 { String::new() } else { format!("-{number}") };
        let free = path.with_file_name(format!("{stem}-explored{ending}.toml"));
        match OpenOptions::new().write(true).create_new(true).open(&free) {
            Ok(mut file) => {
                return file.write_all(changed.as_bytes()).map(|()| free).map_err(|error| error.to_string());
            }
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(format!("cannot write {}: {error}", free.display())),
        }
    }
    Err(format!("{MOST} scenes were saved beside {} already", path.display()))
}

/// The text with the values of these keys replaced in place.
fn with_values(path: &Path, text: &str, values: &BTreeMap<String, f64>) -> Result<String, String> {
    let files = nlmodes_scene::parse_each_method(&path.display().to_string(), text, &[]);
    let file = files.map_err(|refused| refused.text(false))?.into_iter().next().ok_or("there is no scene")?;
    let mut places: Vec<(Range<usize>, f64)> = Vec::new();
    for (key, value) in values {
        let place = file.document.place(key).ok_or_else(|| format!("`{key}` is not in the scene"))?;
        places.push((place.value.clone(), file.document.in_written_unit(key, *value)));
    }
    // From the end, so that positions remain valid.
    places.sort_by_key(|(place, _)| std::cmp::Reverse(place.start));
    let mut changed = text.to_owned();
    for (place, value) in places {
        let old = changed.get(place.clone()).ok_or("a value lies beyond the scene")?;
        let has_point = old.contains(['.', 'e', 'E']);
        let mut new = number(value);
        if has_point && !new.contains(['.', 'e']) {
            new += ".0";
        }
        changed.replace_range(place, &new);
    }
    Ok(changed)
}

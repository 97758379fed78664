//! Parameters by which curves are differentiated: which there can be.

use std::collections::HashMap;
use std::path::Path;

use nlmodes_io::read_parameter_entries;

use crate::raw::{RawAnalysis, RawSensitivity};
use crate::scene::{Scene, SceneStructure, Sensitivity, StaticLoads};
use crate::{Diagnostic, Diagnostics, Document};

/// Tables that enter the structure or its load.
const TABLES: [&str; 9] =
    ["structure", "contact", "spring", "damping", "force", "base_motion", "gravity", "static_force", "thermal"];

/// The parameters that are sound, their files below `base`; their values and states come when the scene is there.
pub fn check(raw: &RawAnalysis, base: &Path, diagnostics: &mut Diagnostics<'_>) -> Vec<Sensitivity> {
    let written = raw.sensitivity.iter().flatten().enumerate();
    let one = |(k, raw): (usize, &RawSensitivity)| match (&raw.key, &raw.entries) {
        (Some(key), None) => parameter(k, key, diagnostics).into_iter().collect(),
        (None, Some(file)) => of_entries(k, &base.join(file), diagnostics),
        _ => {
            let diagnostic = Diagnostic::error("a parameter is a number of the scene or changes entries of matrices");
            diagnostics.put(&format!("sensitivity.{k}"), diagnostic, "expected `key` or `entries`");
            Vec::new()
        }
    };
    written.flat_map(one).collect()
}

/// The parameters of a table of entries, in the order in which they first come.
fn of_entries(k: usize, file: &Path, diagnostics: &mut Diagnostics<'_>) -> Vec<Sensitivity> {
    let entries = match read_parameter_entries(file) {
        Ok(entries) => entries,
        Err(error) => {
            let path = format!("sensitivity.{k}.entries");
            diagnostics.put(&path, Diagnostic::error(error.to_string()), "expected a table of entries");
            return Vec::new();
        }
    };
    let (mut all, mut number) = (Vec::<Sensitivity>::new(), HashMap::new());
    for entry in entries {
        let at = *number.entry(entry.parameter.clone()).or_insert_with(|| {
            let key = entry.parameter.clone();
            all.push(Sensitivity { key, value: 1.0, states: Vec::new(), entries: Vec::new() });
            all.len() - 1
        });
        all[at].entries.push(entry);
    }
    all
}

fn parameter(k: usize, key: &str, diagnostics: &mut Diagnostics<'_>) -> Option<Sensitivity> {
    let path = format!("sensitivity.{k}.key");
    let table = key.split('.').next().unwrap_or_default();
    let is_level = key.starts_with("response.") && key.contains(".levels_");
    if !(TABLES.contains(&table) || is_level || key.starts_with("response.levels_")) {
        let diagnostic = Diagnostic::error(format!("`{key}` is no parameter of the structure or its load"));
        let help = format!("parameters are numbers of {}", TABLES.map(|name| format!("[{name}]")).join(", "));
        diagnostics.put(&path, diagnostic.help(help), "expected a key such as \"contact.0.gap_m\"");
        return None;
    }
    let document = diagnostics.document();
    let there = written_path(key, diagnostics);
    let Some(there) = there else {
        let diagnostic = Diagnostic::error(format!("the scene does not write `{key}`"));
        let help = "gradients need a value that is written in the scene; to use a default, write it down";
        diagnostics.put(&path, diagnostic.help(help), "expected the key of a number of this scene");
        return None;
    };
    let number = document.written(&there).replace('_', "");
    let Ok(written) = number.trim().parse::<f64>() else {
        let diagnostic = Diagnostic::error(format!("`{key}` is {number}, no single number"));
        diagnostics.put(&path, diagnostic, "expected the key of a number; items of lists go by number, from 0");
        return None;
    };
    // What is written in another unit is at another key.
    let value = if there == key { written } else { diagnostics.spelled_document().in_schema_unit(key, written) };
    if value == 0.0 || !value.is_finite() {
        let diagnostic = Diagnostic::error(format!("`{key}` is {number}: its size says how far a difference goes"));
        let help = "for a gap that touches at rest, take the gradient at a small one";
        diagnostics.put(&path, diagnostic.help(help), "expected a parameter that is not zero");
        return None;
    }
    Some(Sensitivity { key: key.to_owned(), value, states: Vec::new(), entries: Vec::new() })
}

/// The path of the value of a key: with another unit, and that of the only response is a list too.
fn written_path(key: &str, diagnostics: &Diagnostics<'_>) -> Option<String> {
    let names = std::iter::once(key.to_owned()).chain(listed(key));
    let mut spelled = names.flat_map(|name| [diagnostics.as_written(&name), name]);
    spelled.find(|path| diagnostics.document().place(path).is_some())
}

/// The key of a number of the response with the number 0.
fn listed(key: &str) -> Option<String> {
    key.strip_prefix("response.").map(|rest| format!("response.0.{rest}"))
}

/// Refuses what has no gradients: scenes that are not in free-interface modes, exact motions.
pub fn refuse(scene: &Scene, diagnostics: &mut Diagnostics<'_>) {
    if scene.sensitivities.is_empty() {
        return;
    }
    let refused = |title: &str, help: &str, label: &str, diagnostics: &mut Diagnostics<'_>| {
        diagnostics.put("sensitivity.0", Diagnostic::error(title).help(help), label);
    };
    if !scene.is_in_open_modes() {
        let title = "gradients are computed in free-interface modes alone";
        let help = "without `method.mass_redistribution` and `method.held_modes`, or with [reduction] kind = \
            \"free-interface\", the structure is reduced by them and keeps all its mass";
        refused(title, help, "expected a scene without a rule for the mass of its contacts", diagnostics);
    } else if scene.method.kind == crate::scene::MethodKind::Shooting {
        let title = "gradients are computed of motions in harmonics, not by shooting";
        refused(title, "method.kind = \"ms-hbm\" computes the same mode", "expected another method", diagnostics);
    } else if scene.updating.is_some() {
        let title = "gradients are not computed of parameters that are fitted first";
        refused(
            title,
            "write the fitted values, which summary.json has",
            "expected a scene without [updating]",
            diagnostics,
        );
    } else if scene.sensitivities.iter().any(|own| !own.entries.is_empty()) {
        let (title, help) = match &scene.structure {
            SceneStructure::Matrices(_) if scene.static_loads == StaticLoads::default() => return,
            SceneStructure::Matrices(_) => (
                "by entries of stiffness and mass nothing is differentiated beside static loads",
                "the place at rest moves with them; a parameter of the scene may change it",
            ),
            _ => (
                "only a structure from files has entries of stiffness and mass",
                "parameters of rods and beams are keys of the scene: `key = \"structure.section.height_m\"`",
            ),
        };
        refused(title, help, "expected a structure from files, kind = \"matrices\"", diagnostics);
    }
}

/// Names of positions along a structure that move with its length, by their beginning.
const POSITIONS: [&str; 3] = ["at_", "to_", "drive_"];

/// The overrides of a scene with the parameter `sensitivity` times `factor`: its key, and where that is the length of
/// the structure every position along it, so that all keep their nodes.
pub fn overrides(sensitivity: &Sensitivity, factor: f64, document: &Document) -> Vec<String> {
    let Sensitivity { key, value, .. } = sensitivity;
    // The only one of several tables may go without its number.
    let numbered = listed(key).filter(|numbered| document.place(key).is_none() && document.place(numbered).is_some());
    let own = format!("{}={:?}", numbered.as_deref().unwrap_or(key), value * factor);
    if !key.starts_with("structure.length_") {
        return vec![own];
    }
    let is_position = |path: &&str| {
        let name = path.rsplit('.').next().unwrap_or_default();
        POSITIONS.iter().any(|begin| name.starts_with(begin))
            && name.split('_').nth(1).is_some_and(|u| u.ends_with('m'))
    };
    let moved = document.keys().filter(is_position).filter_map(|path| {
        let at = document.written(path).replace('_', "").trim().parse::<f64>().ok()?;
        Some(format!("{path}={:?}", at * factor))
    });
    std::iter::once(own).chain(moved).collect()
}

/// Values beside that of the parameter, as multiples of the step, with their weights over twelve steps: the difference
/// quotient of fourth order.
pub const QUOTIENT: [(f64, f64); 4] = [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)];

/// Step over the value of the parameter: the fourth power is what the quotient leaves, its inverse how it enlarges
/// rounding.
pub const STEP: f64 = 1.0 / 1024.0;

//! From raw tables, of which every single value is sound, to a [`Scene`]: what must hold between the values.

mod contact;
mod continuation;
mod frequencies;
mod method;
mod modes;
mod nodes;
mod plausible;
mod records;
mod shooting;
mod structure;
mod updating;
mod virtual_test;

pub use records::scene as record_scene;
pub use virtual_test::scene as test_scene;

use std::path::PathBuf;

use crate::Findings;
use crate::raw::{RawOutput, RawScene};
use crate::scene::{Scene, StabilityChoice};

/// The checked scene, or `None` if a problem of the findings stands in its way. `stem` is the name of the file.
pub fn scene(raw: &RawScene, stem: &str, findings: &mut Findings<'_>) -> Option<Scene> {
    let structure = raw.structure.as_ref().and_then(|raw| structure::check(raw, findings));
    let mesh = raw.structure.as_ref().and_then(|raw| nodes::mesh(raw, findings));
    let mut contacts = contact::check(raw, mesh.as_ref(), findings);
    let method = raw.method.as_ref().and_then(|method| method::check(method, raw, &contacts, findings));
    if let Some(stiffness) = method.as_ref().and_then(|method| method.contact_stiffness) {
        contacts.iter_mut().for_each(|contact| _ = contact.stiffness.get_or_insert(stiffness));
    }
    let continuation = raw.continuation.as_ref().and_then(|raw| continuation::check(raw, findings));
    let updating = raw.updating.as_ref().map(|raw| updating::check(raw, findings));
    let scene = Scene {
        title: raw.title.clone().unwrap_or_else(|| stem.to_owned()),
        structure: structure?,
        contacts,
        updating: match updating {
            Some(updating) => Some(updating?),
            None => None,
        },
        method: method?,
        continuation: continuation?,
        output_directory: output_directory(raw.output.as_ref(), stem),
        stability: raw.output.as_ref().and_then(|output| output.stability).unwrap_or(StabilityChoice::Auto),
        warnings: Vec::new(),
    };
    plausible::warn(&scene, findings);
    Some(scene)
}

fn output_directory(raw: Option<&RawOutput>, stem: &str) -> PathBuf {
    let written = raw.and_then(|output| output.directory.as_ref());
    written.map_or_else(|| PathBuf::from("results").join(stem), PathBuf::from)
}

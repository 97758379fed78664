//! From raw tables, of which every single value is sound, to a [`Scene`]: what must hold between the values.

mod contact;
mod continuation;
mod frequencies;
mod matrices;
mod method;
mod modes;
mod nodes;
mod parts;
mod plausible;
mod records;
mod reduction;
mod response;
mod shooting;
mod structure;
mod updating;
mod virtual_test;

pub use records::scene as record_scene;
pub use virtual_test::scene as test_scene;

use std::path::{Path, PathBuf};

use crate::Findings;
use crate::check::response::Places;
use crate::raw::{RawContact, RawMatrixScene, RawOverlay, RawResults, RawScene};
use crate::scene::{Contact, OutputFiles, Overlay, ReductionKind, Scene, SceneStructure, StabilityChoice};

/// The checked scene, or `None` if a problem of the findings stands in its way. `stem` is the name of the file.
pub fn scene(raw: &RawScene, stem: &str, base: &Path, findings: &mut Findings<'_>) -> Option<Scene> {
    let mesh = raw.structure.as_ref().and_then(|raw| nodes::mesh(raw, findings));
    let structure = raw.structure.as_ref().and_then(|raw| structure::check(raw, findings));
    let contacts = contact::check(raw, mesh.as_ref(), findings);
    let structure = structure.map(SceneStructure::Straight);
    let places = Places::along(raw.structure.as_ref(), mesh.as_ref());
    let scene = rest(raw, (stem, base), structure, contacts, (ReductionKind::HeldModes, &places), findings)?;
    plausible::warn(&scene, findings);
    Some(scene)
}

/// The checked scene of a structure from files, in the same way; paths count from `base`.
pub fn matrix_scene(raw: RawMatrixScene, stem: &str, base: &Path, findings: &mut Findings<'_>) -> Option<Scene> {
    let matrices = matrices::check(&raw, base, findings).map(SceneStructure::Matrices);
    let plain = RawScene {
        title: raw.title,
        contact: raw.contact.map(|tables| tables.iter().map(|_| RawContact::default()).collect()),
        reduction: raw.reduction,
        damping: raw.damping,
        force: raw.force,
        base_motion: raw.base_motion,
        response: raw.response,
        method: raw.method,
        continuation: raw.continuation,
        overlay: raw.overlay,
        output: raw.output,
        ..RawScene::default()
    };
    rest(&plain, (stem, base), matrices, Vec::new(), (ReductionKind::OpenModes, &Places::Nodes), findings)
}

/// What all structures share.
fn rest(
    raw: &RawScene,
    (stem, base): (&str, &Path),
    mut structure: Option<SceneStructure>,
    mut contacts: Vec<Contact>,
    (default, places): (ReductionKind, &Places<'_>),
    findings: &mut Findings<'_>,
) -> Option<Scene> {
    let method = raw.method.as_ref().and_then(|method| method::check(method, raw, &contacts, findings));
    if let Some(stiffness) = method.as_ref().and_then(|method| method.contact_stiffness) {
        contacts.iter_mut().for_each(|contact| _ = contact.stiffness.get_or_insert(stiffness));
        if let Some(SceneStructure::Matrices(matrices)) = &mut structure {
            matrices.contacts.iter_mut().for_each(|contact| _ = contact.stiffness.get_or_insert(stiffness));
        }
    }
    let reduction = reduction::check(raw.reduction.as_ref(), raw, default, findings);
    let has_responses = raw.response.as_ref().is_some_and(|responses| !responses.is_empty());
    let continuation = raw.continuation.as_ref().and_then(|raw| continuation::check(raw, has_responses, findings));
    let updating = raw.updating.as_ref().map(|raw| updating::check(raw, findings));
    let of_responses = response::check(raw, places, method.as_ref(), findings);
    Some(Scene {
        title: raw.title.clone().unwrap_or_else(|| stem.to_owned()),
        structure: structure?,
        contacts,
        reduction,
        updating: match updating {
            Some(updating) => Some(updating?),
            None => None,
        },
        damping: of_responses.damping,
        forces: of_responses.forces,
        base_motion: of_responses.base_motion,
        responses: of_responses.responses,
        method: method?,
        continuation: continuation?,
        output_directory: output_directory(raw.output.as_ref().and_then(|output| output.directory.as_ref()), stem),
        overlays: overlays(raw, base),
        files: files(raw.output.as_ref()),
        stability: raw.output.as_ref().and_then(|output| output.stability).unwrap_or(StabilityChoice::Auto),
        warnings: Vec::new(),
    })
}

/// Where results go; `stem` is the name of the file.
fn output_directory(written: Option<&String>, stem: &str) -> PathBuf {
    written.map_or_else(|| PathBuf::from("results").join(stem), PathBuf::from)
}

/// What is laid over the results; paths count from `base`.
fn overlays(raw: &RawScene, base: &Path) -> Vec<Overlay> {
    let overlay = |raw: &RawOverlay| {
        let path = base.join(raw.path.as_ref()?);
        let name = path.file_stem().map(|name| name.to_string_lossy().into_owned());
        Some(Overlay { label: raw.label.clone().or(name).unwrap_or_default(), path })
    };
    raw.overlay.iter().flatten().filter_map(overlay).collect()
}

fn files(raw: Option<&RawResults>) -> OutputFiles {
    let (Some(raw), default) = (raw, OutputFiles::default()) else { return OutputFiles::default() };
    let mut histories = raw.histories.clone().unwrap_or_default();
    histories.sort_unstable();
    histories.dedup();
    OutputFiles {
        figures: raw.figures.unwrap_or(default.figures),
        page: raw.page.unwrap_or(default.page),
        matlab: raw.matlab.unwrap_or(default.matlab),
        histories,
        figure_width_mm: raw.figure_width_mm,
        figure_titles: raw.figure_titles.unwrap_or(default.figure_titles),
    }
}

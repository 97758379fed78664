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
mod reduced;
mod reduction;
mod response;
mod section;
pub(crate) mod sensitivity;
mod shooting;
mod springs;
mod static_loads;
mod structure;
mod transient;
mod updating;
mod virtual_test;

pub use records::scene as record_scene;
pub use virtual_test::scene as test_scene;

use std::path::{Path, PathBuf};

use parts::Fixed;

use crate::Diagnostics;
use crate::check::contact::Body;
use crate::check::response::Places;
use crate::raw::{RawAnalysis, RawBodiesScene, RawMatrixScene, RawMethod, RawReducedScene, RawScene, RawStructure};
use crate::scene::{
    Contact, MassRule, Method, MethodKind, OutputFiles, Overlay, ReductionKind, Scene, SceneStructure, Structure,
};

/// What a scene computes with, as far as its other tables have to fit it.
pub struct Subject<'a> {
    /// Where loads act.
    places: Places<'a>,
    /// Number of `[[contact]]` tables.
    contact_tables: usize,
}

/// The checked scene, or `None` if an error among the diagnostics prevents it. `stem` is the name of the file.
pub fn scene(raw: &RawScene, stem: &str, base: &Path, diagnostics: &mut Diagnostics<'_>) -> Option<Scene> {
    let tables = raw.contact.as_deref().unwrap_or_default();
    let stops: Vec<f64> = tables.iter().map(|contact| contact.at_m).collect();
    let fixed = Fixed::of_one(&raw.structure, diagnostics);
    let nodes = nodes::mesh(&raw.structure, &stops, &fixed.places(), diagnostics)?;
    structure::alone(&raw.structure, diagnostics);
    let structure = structure::check(&raw.structure, &nodes, &fixed, diagnostics);
    let bodies = [Body { raw: &raw.structure, mesh: &nodes.mesh }];
    let contacts = contact::check(tables, &bodies, diagnostics);
    let structure = structure.map(SceneStructure::Straight);
    let places = Places::Along(&bodies[0]);
    let subject = Subject { places, contact_tables: tables.len() };
    let scene = rest(&raw.analysis, (stem, base), structure, contacts, &subject, diagnostics)?;
    plausible::warn(&scene, diagnostics);
    plausible::stops(&scene, diagnostics);
    Some(scene)
}

/// The checked scene of several rods and beams, in the same way.
pub fn bodies_scene(raw: &RawBodiesScene, stem: &str, base: &Path, diagnostics: &mut Diagnostics<'_>) -> Option<Scene> {
    let (raws, tables) = (&raw.structure, raw.contact.as_deref().unwrap_or_default());
    let fixed = Fixed::of_several(raws, diagnostics);
    let (mut nodes, mut structures) = (Vec::new(), Vec::new());
    for (i, (raw, fixed)) in raws.iter().zip(&fixed).enumerate() {
        diagnostics.about_structure(Some(i));
        let own = nodes::mesh(raw, &contact::stops_of(i, tables), &fixed.places(), diagnostics)?;
        structures.push(structure::check(raw, &own, fixed, diagnostics));
        nodes.push(own);
    }
    let bodies: Vec<Body<'_>> = raws.iter().zip(&nodes).map(|(raw, nodes)| Body { raw, mesh: &nodes.mesh }).collect();
    diagnostics.about_structure(None);
    let contacts = contact::check(tables, &bodies, diagnostics);
    let structures = structures.into_iter().collect::<Option<Vec<Structure>>>().map(SceneStructure::Several);
    let subject = Subject { places: Places::Bodies(&bodies), contact_tables: tables.len() };
    let scene = rest(&raw.analysis, (stem, base), structures, contacts, &subject, diagnostics)?;
    for (i, structure) in scene.structure.bodies().iter().enumerate() {
        diagnostics.about_structure(Some(i));
        plausible::structure(structure, diagnostics);
    }
    diagnostics.about_structure(None);
    plausible::stops(&scene, diagnostics);
    Some(scene)
}

/// The checked scene of a structure from files, in the same way; paths count from `base`.
pub fn matrix_scene(raw: &RawMatrixScene, stem: &str, base: &Path, diagnostics: &mut Diagnostics<'_>) -> Option<Scene> {
    let matrices = matrices::check(raw, base, diagnostics).map(SceneStructure::Matrices);
    let contact_tables = raw.contact.as_ref().map_or(0, Vec::len);
    let subject = Subject { places: Places::Nodes, contact_tables };
    let scene = rest(&raw.analysis, (stem, base), matrices, Vec::new(), &subject, diagnostics)?;
    plausible::stops(&scene, diagnostics);
    Some(scene)
}

/// The checked scene of a structure that was reduced elsewhere, in the same way; paths count from `base`.
pub fn reduced_scene(
    raw: &RawReducedScene,
    stem: &str,
    base: &Path,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<Scene> {
    let model = reduced::check(raw, base, diagnostics).map(SceneStructure::Reduced);
    let contact_tables = raw.contact.as_ref().map_or(0, Vec::len);
    let subject = Subject { places: Places::Rows, contact_tables };
    let scene = rest(&raw.analysis, (stem, base), model, Vec::new(), &subject, diagnostics)?;
    plausible::stops(&scene, diagnostics);
    Some(scene)
}

/// A rod or beam of a scene that has its stops elsewhere, at these positions.
fn one_structure(raw: &RawStructure, stops: &[f64], diagnostics: &mut Diagnostics<'_>) -> Option<Structure> {
    let fixed = Fixed::of_one(raw, diagnostics);
    let nodes = nodes::mesh(raw, stops, &fixed.places(), diagnostics)?;
    structure::alone(raw, diagnostics);
    structure::check(raw, &nodes, &fixed, diagnostics)
}

/// What all structures share.
fn rest(
    raw: &RawAnalysis,
    (stem, base): (&str, &Path),
    mut structure: Option<SceneStructure>,
    mut contacts: Vec<Contact>,
    subject: &Subject<'_>,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<Scene> {
    let is_along = matches!(subject.places, Places::Along(_));
    // No mass is taken away unless the scene asks for it: by a rule for the mass of the contacts or by modes with held
    // contacts; the springs of harmonic balance are at nodes that keep their mass.
    let method = &raw.method;
    let names_held = method.mass_redistribution.is_some() || method.held_modes.is_some();
    let is_held = is_along && (names_held || method.kind == Some(MethodKind::Hbm));
    let default = if is_held { ReductionKind::HeldModes } else { ReductionKind::OpenModes };
    let kind = raw.reduction.and_then(|reduction| reduction.kind).unwrap_or(default);
    let is_open = kind == ReductionKind::OpenModes;
    // No contact of open modes has mass: what the scene says of it has no effect.
    let rule = raw.method.mass_redistribution.filter(|_| !is_open);
    let written = RawMethod { mass_redistribution: rule, ..raw.method.with_harmonics(raw) };
    let method = method::check((&written, is_open), raw, subject, &contacts, diagnostics).map(|method| match is_open {
        true => Method { mass_redistribution: MassRule::None, ..method },
        false => method,
    });
    if let Some(stiffness) = method.as_ref().and_then(|method| method.contact_stiffness) {
        let linear = contacts.iter_mut().filter(|contact| contact.hertz.is_none());
        linear.for_each(|contact| _ = contact.stiffness.get_or_insert(stiffness));
        if let Some(SceneStructure::Matrices(matrices)) = &mut structure {
            matrices.contacts.iter_mut().for_each(|contact| _ = contact.stiffness.get_or_insert(stiffness));
        }
        if let Some(SceneStructure::Reduced(model)) = &mut structure {
            model.row_contacts.iter_mut().for_each(|contact| _ = contact.stiffness.get_or_insert(stiffness));
        }
    }
    let reduction = reduction::check(raw, (default, &subject.places), diagnostics);
    let has_responses = raw.has_responses() || raw.transient.is_some();
    continuation::check(&raw.continuation, [raw.has_springs(), raw.has_laws()], diagnostics);
    let uniform = structure.as_ref().is_none_or(|s| s.straight().is_some_and(|s| s.segments.is_empty()));
    let updating = raw.updating.as_ref().map(|written| updating::checked(written, uniform, diagnostics));
    contact::dampers(&contacts, structure.as_ref(), has_responses, diagnostics);
    contact::check_laws(raw, is_open, &contacts, diagnostics);
    let static_loads = static_loads::check(raw, base, &subject.places, diagnostics);
    let springs = springs::check(raw, base, &subject.places, diagnostics);
    let of_responses = response::check(raw, &subject.places, method.as_ref(), diagnostics);
    let transient = transient::check(raw, base, &subject.places, diagnostics);
    let output = raw.output.clone().unwrap_or_default();
    let sensitivities = sensitivity::check(raw, base, diagnostics);
    let scene = Scene {
        title: raw.title.clone().unwrap_or_else(|| stem.to_owned()),
        structure: structure?,
        contacts,
        reduction,
        updating,
        static_loads,
        springs,
        damping: of_responses.damping,
        forces: of_responses.forces,
        base_motion: of_responses.base_motion,
        responses: of_responses.responses,
        transient,
        sensitivities,
        method: method?,
        continuation: raw.continuation.clone(),
        output_directory: output_directory(output.directory.as_ref(), stem),
        overlays: overlays(raw.overlay.as_deref(), base),
        files: ascending(output.files),
        stability: output.stability,
        stability_budget_s: output.stability_budget_s,
        require: output.require,
        warnings: Vec::new(),
    };
    sensitivity::refuse(&scene, diagnostics);
    Some(scene)
}

/// Where results go; `stem` is the name of the file.
fn output_directory(written: Option<&PathBuf>, stem: &str) -> PathBuf {
    written.cloned().unwrap_or_else(|| PathBuf::from("results").join(stem))
}

/// What is laid over the results; paths count from `base`, and names are those of the files where none is given.
fn overlays(written: Option<&[Overlay]>, base: &Path) -> Vec<Overlay> {
    let overlay = |Overlay { path, label }: &Overlay| {
        let name = path.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        Overlay { path: base.join(path), label: if label.is_empty() { name } else { label.clone() } }
    };
    written.into_iter().flatten().map(overlay).collect()
}

/// The same with its points in order, each once.
fn ascending(mut files: OutputFiles) -> OutputFiles {
    files.histories.sort_unstable();
    files.histories.dedup();
    files
}

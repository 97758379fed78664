//! Values that are possible but look like mistakes, mostly of units.

mod masses;
mod material;
mod section;
mod stop;
mod test;
mod window;

pub use test::{damping, warn as warn_of_test};

use nlmodes_io::GapChoice;

use crate::rule::number;
use crate::scene::{ModeDamping, Scene, Section, SpringDirection, Structure, StructureKind, Support};
use crate::{Diagnostic, Diagnostics};

/// Structures that are longer are rare, m.
const LONG: f64 = 100.0;

/// Warnings about stops and damping of any structure.
pub fn stops(scene: &Scene, diagnostics: &mut Diagnostics<'_>) {
    let files = scene.structure.matrices().map(|files| files.contacts.as_slice()).unwrap_or_default();
    let given = files.iter().map(|contact| match contact.gap {
        Some(GapChoice::Same(gap)) => gap,
        Some(GapChoice::WallPoint(_)) | None => 0.0,
    });
    let rows = scene.structure.reduced().map(|model| model.row_contacts.as_slice()).unwrap_or_default();
    let given = given.chain(rows.iter().map(|contact| contact.gap));
    let gaps = scene.contacts.iter().map(|contact| contact.gap).chain(given);
    for (i, gap) in gaps.enumerate() {
        stop::pressed(&format!("contact.{i}.gap_m"), gap, diagnostics);
    }
    if let Some(ModeDamping::Ratios(ratios)) = scene.damping.as_ref().map(|damping| &damping.modes) {
        damping(if diagnostics.has("damping.ratio") { "damping.ratio" } else { "damping.ratios" }, ratios, diagnostics);
    }
}

pub fn warn(scene: &Scene, diagnostics: &mut Diagnostics<'_>) {
    let Some(straight) = scene.structure.straight() else { return };
    let before = diagnostics.count();
    structure(straight, diagnostics);
    let sound = diagnostics.count() == before;
    for (i, contact) in scene.contacts.iter().enumerate() {
        stop::gap(&format!("contact.{i}.gap_m"), contact.gap, straight, diagnostics);
        stop::stiffness(i, contact, straight, diagnostics);
    }
    // With a slip in the structure its frequencies are wrong too.
    if sound {
        window::warn(scene, straight, diagnostics);
    }
}

pub fn structure(structure: &Structure, diagnostics: &mut Diagnostics<'_>) {
    rigid_body(structure, diagnostics);
    let ratios = structure.modes.as_ref().and_then(|modes| modes.damping_ratios.as_deref());
    damping("structure.modes.damping_ratios", ratios.unwrap_or_default(), diagnostics);
    if let Some(ModeDamping::Ratios(ratios)) = &structure.damping {
        let path = ["structure.damping.ratio", "structure.damping.ratios"];
        damping(path[usize::from(!diagnostics.has(path[0]))], ratios, diagnostics);
    }
    if is_dimensionless(structure) {
        return;
    }
    masses::warn(structure, diagnostics);
    material::warn(structure, diagnostics);
    if !section::warn(structure, diagnostics) {
        slenderness(structure, diagnostics);
    }
    length(structure.length, diagnostics);
}

/// Whether the scene is dimensionless, as `EA = ρA = 1`: then magnitudes cannot be checked.
fn is_dimensionless(structure: &Structure) -> bool {
    (structure.youngs_modulus, structure.density) == (1.0, 1.0)
}

/// `if 210 GPa is meant, write 2.1e11`
fn meant(value: f64, unit: &str, factor: f64) -> String {
    format!("if {} {unit} is meant, write {}", number(value), number(value * factor))
}

fn length(length: f64, diagnostics: &mut Diagnostics<'_>) {
    let path = "structure.length_m";
    if length > LONG {
        let diagnostic = Diagnostic::warning(format!("`{path}` is very long"))
            .help(format!("{}; all lengths of a scene are in m", meant(length, "mm", 1e-3)));
        diagnostics.put(path, diagnostic, format!("{} m", number(length)));
    }
}

fn slenderness(structure: &Structure, diagnostics: &mut Diagnostics<'_>) {
    let Section::Beam { area, second_moment, .. } = structure.section else { return };
    let height = (12.0 * second_moment / area).sqrt();
    if structure.length < 2.0 * height {
        let label = format!("{} m, but {} m high", number(structure.length), number(height));
        let diagnostic = Diagnostic::warning("the beam is too short for beam theory")
            .help("a Timoshenko beam should be at least twice as long as it is high; lengths are in m");
        diagnostics.put("structure.length_m", diagnostic, label);
    }
}

/// Supports that hold nothing, and how far springs make up for that.
fn rigid_body(structure: &Structure, diagnostics: &mut Diagnostics<'_>) {
    if (structure.start, structure.end) != (Support::Free, Support::Free) {
        return;
    }
    let left = rigid_motions(structure);
    if left == 0 {
        return;
    }
    let (title, label) = match structure.springs.is_empty() {
        true => ("the structure has no support", "free, as is the end"),
        false => ("the structure is not held all round", "free, as is the end; springs hold the rest"),
    };
    let modes = match left {
        1 => "its first mode is a rigid-body motion".to_owned(),
        _ => format!("its first {left} modes are rigid-body motions"),
    };
    let is_loaded = ["gravity", "static_force"].into_iter().any(|key| diagnostics.has(key));
    let help = match is_loaded {
        true => "under its static loads its contacts alone carry it; its rigid-body motions that no contact feels \
            are its first modes, of 0 Hz"
            .to_owned(),
        false => format!("{modes} at 0 Hz; method.mode = {} is the first that vibrates", left + 1),
    };
    diagnostics.put("structure.start", Diagnostic::warning(title).help(help), label);
}

/// Rigid motions that the springs of a free structure leave: along the axis, and of a beam across it and about a point.
fn rigid_motions(structure: &Structure) -> usize {
    let of = |direction| structure.springs.iter().filter(move |s| s.direction == direction && s.stiffness > 0.0);
    let along = usize::from(of(SpringDirection::Axial).next().is_none());
    let mut across: Vec<usize> = of(SpringDirection::Transverse).map(|spring| spring.node).collect();
    across.sort_unstable();
    across.dedup();
    // Two springs across at different nodes, or one and another about a point, hold both motions; springs about points
    // alone only one.
    let held = across.len().min(2) + usize::from(of(SpringDirection::Rotation).next().is_some());
    match structure.kind() {
        StructureKind::Rod => along,
        StructureKind::Beam => along + 2_usize.saturating_sub(held),
    }
}

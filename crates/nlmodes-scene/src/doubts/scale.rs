use nlmodes_io::{Component, Mesh, UnitSystem};

use super::{Subject, short};

/// Plausible mean densities of structures, kg/m³: from foam to metals with attachments.
const DENSITIES: std::ops::RangeInclusive<f64> = 50.0..=3e4;
/// Densities of solid materials, kg/m³: the range in which units are suggested.
const MATERIALS: std::ops::RangeInclusive<f64> = 5e2..=2.5e4;
/// Units in which models are written, those that are met more often first.
const USUAL: [&str; 6] = ["m-kg-s", "mm-t-s", "mm-kg-ms", "mm-g-ms", "in-slinch-s", "ft-slug-s"];

/// A mass that no material makes of the volume of the mesh.
pub fn doubts(subject: &Subject<'_>) -> Option<String> {
    let mesh = subject.model.mesh.as_ref().filter(|mesh| is_solid_alone(mesh, subject))?;
    let volume = subject.skin.volume(mesh);
    let mass = subject.model.mass_along_axes().into_iter().fold(0.0, f64::max);
    let density = mass / volume;
    if !(volume > 0.0 && density > 0.0) || DENSITIES.contains(&density) {
        return None;
    }
    let units = subject.matrices.files.units;
    let (mass_unit, volume_unit) = (units.mass(Component::X, Component::X), units.length().powi(3));
    // In the units of the files.
    let written = density * volume_unit / mass_unit;
    let help = match suggested(mass / mass_unit, volume / volume_unit) {
        // The same as if the density alone were in kg/m³.
        Some("m-kg-s") => format!(
            "in m-kg-s it would be plausible; or the material has {} where {units} needs {}",
            short(written),
            short(written * volume_unit / mass_unit)
        ),
        Some(other) => format!("in {other} it would be plausible"),
        None => "are mesh and matrices in the same units, and of the same structure?".into(),
    };
    Some(format!(
        "`structure.units` {units} gives a density of {} kg/m³ ({} kg that can move, {} m³ of the mesh), which no \
            material has: {help}",
        short(density),
        short(mass),
        short(volume)
    ))
}

/// Whether the volume of the mesh has the mass: solids alone, most of whose nodes move.
fn is_solid_alone(mesh: &Mesh, subject: &Subject<'_>) -> bool {
    let moves = |index: u32| subject.model.translations_of(mesh.numbers[index as usize]).iter().any(Option::is_some);
    let skin = subject.skin.nodes();
    let moving = skin.iter().filter(|index| moves(**index)).count();
    let solids = mesh.elements.iter().all(|element| element.kind.is_solid());
    solids && mesh.passed_over.is_empty() && 2 * moving > skin.len()
}

/// The units in which the numbers of the files are those of a material.
fn suggested(mass: f64, volume: f64) -> Option<&'static str> {
    let density =
        |units: &UnitSystem| mass * units.mass(Component::X, Component::X) / (volume * units.length().powi(3));
    USUAL.into_iter().find(|name| name.parse().is_ok_and(|units| MATERIALS.contains(&density(&units))))
}

//! Values that are possible, but look like slips: of units mostly.

use crate::config::rule::number;
use crate::config::scene::{Contact, Scene, Section, Structure, Support};
use crate::config::{Findings, Problem};

pub fn warn(scene: &Scene, findings: &mut Findings<'_>) {
    stiffness(scene.structure.youngs_modulus, findings);
    density(scene.structure.density, findings);
    slenderness(&scene.structure, findings);
    rigid_body(&scene.structure, findings);
    for (i, contact) in scene.contacts.iter().enumerate() {
        gap(i, contact, &scene.structure, findings);
    }
    if scene.contacts.is_empty() && !findings.has("contact") {
        let problem = Problem::warning("the structure has no stop").help("stops stand under headings [[contact]]");
        findings.push(problem);
    }
}

fn stiffness(modulus: f64, findings: &mut Findings<'_>) {
    let path = "structure.material.youngs_modulus_pa";
    let meant =
        |factor: f64, unit: &str| format!("if {} {unit} is meant, write {}", number(modulus), number(modulus * factor));
    let hint = match modulus {
        m if m < 2e3 => meant(1e9, "GPa"),
        m if m < 1e6 => meant(1e6, "MPa (N/mm²)"),
        m if m > 2e12 => "diamond has 1.2e12 Pa, steel 2.1e11 Pa".into(),
        _ => return,
    };
    let softness = if modulus < 1e6 { "softer than rubber" } else { "stiffer than diamond" };
    let problem = Problem::warning(format!("`{path}` is {softness}")).help(hint);
    findings.put(path, problem, format!("{} Pa", number(modulus)));
}

fn density(density: f64, findings: &mut Findings<'_>) {
    let path = "structure.material.density_kg_m3";
    let (than, hint) = match density {
        d if d < 30.0 => ("lighter than foam", format!("if {} g/cm³ is meant, write {}", number(d), number(d * 1e3))),
        d if d > 3e4 => ("heavier than any solid", "osmium has 2.26e4 kg/m³, steel 7.85e3 kg/m³".into()),
        _ => return,
    };
    let problem = Problem::warning(format!("`{path}` is {than}")).help(hint);
    findings.put(path, problem, format!("{} kg/m³", number(density)));
}

fn slenderness(structure: &Structure, findings: &mut Findings<'_>) {
    let Section::Beam { area, second_moment, .. } = structure.section else { return };
    let height = (12.0 * second_moment / area).sqrt();
    if structure.length < 2.0 * height {
        let label = format!("{} m, but {} m high", number(structure.length), number(height));
        let problem = Problem::warning("the beam is too short for beam theory")
            .help("a Timoshenko beam should be at least twice as long as it is high; lengths are in m");
        findings.put("structure.length_m", problem, label);
    }
}

fn rigid_body(structure: &Structure, findings: &mut Findings<'_>) {
    if (structure.start, structure.end) == (Support::Free, Support::Free) {
        let problem = Problem::warning("the structure is held nowhere")
            .help("its first modes are rigid-body motions at 0 Hz; start = \"clamped\" would hold it");
        findings.put("structure.start", problem, "free, as is the end");
    }
}

fn gap(i: usize, contact: &Contact, structure: &Structure, findings: &mut Findings<'_>) {
    if contact.gap.abs() > structure.length {
        let path = format!("contact.{i}.gap_m");
        let size = if contact.gap > 0.0 {
            "longer than the structure"
        } else {
            "pressed in by more than the structure's length"
        };
        let label = format!("{} m, beside a length of {} m", number(contact.gap), number(structure.length));
        findings.put(&path, Problem::warning(format!("`{path}` is {size}")).help("gaps are in m"), label);
    }
}

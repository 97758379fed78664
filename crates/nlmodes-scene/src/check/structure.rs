use crate::raw::{RawMaterial, RawSection, RawStructure};
use crate::scene::{MassMatrix, Section, Structure, StructureKind, Support};
use crate::{Findings, Problem};

const POISSONS_RATIO: f64 = 0.3;
const SHEAR_FACTOR: f64 = 5.0 / 6.0;

pub fn check(raw: &RawStructure, findings: &mut Findings<'_>) -> Option<Structure> {
    let section = section(raw, findings);
    let modes = raw.modes.as_ref().map(|modes| super::modes::check(modes, findings));
    let mesh = super::nodes::mesh(raw, findings);
    let masses = mesh.as_ref().map(|mesh| super::parts::masses(raw, mesh, findings));
    let springs = mesh.as_ref().map(|mesh| super::parts::springs(raw, mesh, findings));
    let material = raw.material.as_ref()?;
    Some(Structure {
        length: raw.length_m?,
        elements: raw.elements? as usize,
        grading: raw.grading.unwrap_or(1.0),
        mass_matrix: raw.mass_matrix.unwrap_or(MassMatrix::Consistent),
        start: raw.start?,
        end: raw.end.unwrap_or(Support::Free),
        youngs_modulus: material.youngs_modulus_pa?,
        density: material.density_kg_m3?,
        section: section?,
        mass_points: masses.unwrap_or_default(),
        springs: springs.unwrap_or_default(),
        modes: match modes {
            Some(modes) => Some(modes?),
            None => None,
        },
    })
}

fn section(raw: &RawStructure, findings: &mut Findings<'_>) -> Option<Section> {
    let (kind, section) = (raw.kind?, raw.section.as_ref()?);
    match kind {
        StructureKind::Rod => {
            warn_unused(findings);
            Some(Section::Rod { area: area(section, kind, findings)? })
        }
        StructureKind::Beam => beam(section, raw.material.as_ref(), findings),
    }
}

fn beam(section: &RawSection, material: Option<&RawMaterial>, findings: &mut Findings<'_>) -> Option<Section> {
    let area = area(section, StructureKind::Beam, findings)?;
    let rectangle = section.width_m.zip(section.height_m).map(|(width, height)| width * height.powi(3) / 12.0);
    Some(Section::Beam {
        area,
        second_moment: computable(rectangle.or(section.second_moment_m4)?, findings)?,
        shear_factor: section.shear_factor.unwrap_or(SHEAR_FACTOR),
        poissons_ratio: material.and_then(|material| material.poissons_ratio).unwrap_or(POISSONS_RATIO),
    })
}

/// The area, if the section is given completely and in one way only.
fn area(section: &RawSection, kind: StructureKind, findings: &mut Findings<'_>) -> Option<f64> {
    let general: &[&str] = match kind {
        StructureKind::Rod => &["area_m2"],
        StructureKind::Beam => &["area_m2", "second_moment_m4"],
    };
    let (has_rectangle, has_general) = (any(&["width_m", "height_m"], findings), any(general, findings));
    if has_rectangle && has_general {
        let problem = Problem::error("`structure.section` gives the section twice");
        findings.put("structure.section", problem.help(ways(kind)), "found keys of both ways to give it");
        return None;
    }
    let wanted = if has_rectangle { &["width_m", "height_m"] } else { general };
    for key in wanted {
        if !findings.has(&path(key)) {
            let problem = Problem::error(format!("`{}` is missing", path(key))).help(ways(kind));
            let label = format!("expected `{key}` in this table: a number greater than 0, in {}", unit(key));
            findings.put(&path(key), problem, label);
        }
    }
    let rectangle = section.width_m.zip(section.height_m).map(|(width, height)| width * height);
    computable(rectangle.or(section.area_m2)?, findings)
}

/// The value, unless products of the given numbers left the range of floating point.
fn computable(value: f64, findings: &mut Findings<'_>) -> Option<f64> {
    let sound = value.is_finite() && value > 0.0;
    if !sound {
        let problem = Problem::error("`structure.section` is too large or too small to compute with");
        findings.put("structure.section", problem, "expected values of a section, in m");
    }
    sound.then_some(value)
}

fn any(keys: &[&str], findings: &Findings<'_>) -> bool {
    keys.iter().any(|key| findings.has(&path(key)))
}

fn path(key: &str) -> String {
    format!("structure.section.{key}")
}

fn unit(key: &str) -> &'static str {
    match key {
        "area_m2" => "m²",
        "second_moment_m4" => "m⁴",
        _ => "m",
    }
}

fn ways(kind: StructureKind) -> &'static str {
    match kind {
        StructureKind::Rod => "a rod has either `area_m2`, or `width_m` and `height_m`",
        StructureKind::Beam => "a beam has either `width_m` and `height_m`, or `area_m2` and `second_moment_m4`",
    }
}

fn warn_unused(findings: &mut Findings<'_>) {
    let unused =
        ["structure.material.poissons_ratio", "structure.section.second_moment_m4", "structure.section.shear_factor"];
    for path in unused {
        if findings.has(path) {
            let problem = Problem::warning(format!("`{path}` has no effect"));
            findings.put(path, problem, "a rod moves along its axis only and does not use it");
        }
    }
}

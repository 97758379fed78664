//! Cross sections: a rectangle, a tube, or area and second moment, each complete and only one of them.

use crate::raw::{RawMaterial, RawSection};
use crate::scene::{Section, StructureKind};
use crate::{Diagnostic, Diagnostics};

const POISSONS_RATIO: f64 = 0.3;
const SHEAR_FACTOR: f64 = 5.0 / 6.0;

const RECTANGLE: &[&str] = &["width_m", "height_m"];
const TUBE: &[&str] = &["outer_m", "wall_m"];

/// The section in the table at `table`.
pub fn section(
    table: &str,
    raw: &RawSection,
    kind: StructureKind,
    material: &RawMaterial,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<Section> {
    if kind == StructureKind::Rod {
        warn_unused(table, diagnostics);
    }
    let poissons_ratio = material.poissons_ratio.unwrap_or(POISSONS_RATIO);
    let general: &[&str] = match kind {
        StructureKind::Rod => &["area_m2"],
        StructureKind::Beam => &["area_m2", "second_moment_m4"],
    };
    let is_begun = |keys: &[&str]| keys.iter().any(|key| diagnostics.has(&format!("{table}.{key}")));
    let begun: Vec<&[&str]> = [RECTANGLE, TUBE, general].into_iter().filter(|keys| is_begun(keys)).collect();
    if begun.len() > 1 {
        let diagnostic = Diagnostic::error(format!("`{table}` gives the section twice"));
        diagnostics.put(table, diagnostic.help(ways(kind)), "found keys of more than one way to give it");
        return None;
    }
    let way = begun.first().copied().unwrap_or(general);
    for key in way {
        let path = format!("{table}.{key}");
        if !diagnostics.has(&path) {
            let diagnostic = Diagnostic::error(format!("`{path}` is missing")).help(ways(kind));
            let label = format!("expected `{key}` in this table: a number greater than 0, in {}", unit(key));
            diagnostics.put(&path, diagnostic, label);
        }
    }
    let rectangle = raw.width_m.zip(raw.height_m);
    let tube = tube(table, raw, poissons_ratio, diagnostics);
    let area = rectangle.map(|(width, height)| width * height).or(tube.map(|tube| tube.area())).or(raw.area_m2)?;
    let area = computable(table, area, diagnostics)?;
    if kind == StructureKind::Rod {
        return Some(Section::Rod { area });
    }
    let of_rectangle = rectangle.map(|(width, height)| width * height.powi(3) / 12.0);
    let second_moment = of_rectangle.or(tube.map(|tube| tube.second_moment())).or(raw.second_moment_m4)?;
    Some(Section::Beam {
        area,
        second_moment: computable(table, second_moment, diagnostics)?,
        shear_factor: raw.shear_factor.or(tube.map(|tube| tube.shear_factor())).unwrap_or(SHEAR_FACTOR),
        poissons_ratio,
        outer_fibre: raw.outer_fibre_m.or(raw.height_m.or(raw.outer_m).map(|whole| 0.5 * whole)),
    })
}

/// The tube, if the section is one.
fn tube(
    table: &str,
    raw: &RawSection,
    poissons_ratio: f64,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<nlmodes_fem::Section> {
    let (outer, wall) = raw.outer_m.zip(raw.wall_m)?;
    let path = format!("{table}.wall_m");
    if 2.0 * wall > outer {
        let diagnostic = Diagnostic::error(format!("`{path}` is more than half of the outer diameter"));
        let label =
            format!("found {}, expected at most {}", diagnostics.written(&path), crate::rule::number(0.5 * outer));
        diagnostics.put(&path, diagnostic, label);
        return None;
    }
    let tube = nlmodes_fem::Section::tube(outer, wall, poissons_ratio);
    if tube.is_err() {
        computable(table, f64::NAN, diagnostics);
    }
    tube.ok()
}

/// The value, unless products of the given numbers left the range of floating point.
fn computable(table: &str, value: f64, diagnostics: &mut Diagnostics<'_>) -> Option<f64> {
    let sound = value.is_finite() && value > 0.0;
    if !sound {
        let diagnostic = Diagnostic::error(format!("`{table}` is too large or too small to compute with"));
        diagnostics.put(table, diagnostic, "expected values of a section, in m");
    }
    sound.then_some(value)
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
        StructureKind::Rod => {
            "a rod has either `area_m2`, or `width_m` and `height_m`, or `outer_m` and `wall_m` of a tube"
        }
        StructureKind::Beam => {
            "a beam has either `width_m` and `height_m`, or `outer_m` and `wall_m` of a tube, or `area_m2` and \
                `second_moment_m4`"
        }
    }
}

fn warn_unused(table: &str, diagnostics: &mut Diagnostics<'_>) {
    let material = table.trim_end_matches("section");
    let unused = [
        format!("{material}material.poissons_ratio"),
        format!("{table}.second_moment_m4"),
        format!("{table}.shear_factor"),
        format!("{table}.outer_fibre_m"),
    ];
    for path in unused {
        if diagnostics.has(&path) {
            let diagnostic = Diagnostic::warning(format!("`{path}` has no effect"));
            diagnostics.put(&path, diagnostic, "a rod moves along its axis only and does not use it");
        }
    }
}

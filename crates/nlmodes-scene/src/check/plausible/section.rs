use super::meant;
use crate::rule::number;
use crate::scene::{Section, Structure};
use crate::{Diagnostic, Diagnostics};

/// Height over width of a rectangle as stiff and as large as the section: sheets have 1e-3, deep girders 1e2.
const SHAPES: std::ops::RangeInclusive<f64> = 1e-5..=1e4;

/// Warns of a section larger than the structure is long; whether it did.
pub fn warn(structure: &Structure, diagnostics: &mut Diagnostics<'_>) -> bool {
    let length = structure.length;
    let (area, second_moment) = match structure.section {
        Section::Rod { area } => (area, None),
        Section::Beam { area, second_moment, .. } => (area, Some(second_moment)),
    };
    if diagnostics.has("structure.section.width_m") {
        let height = second_moment.map_or(0.0, |second_moment| (12.0 * second_moment / area).sqrt());
        let sides = second_moment.map_or((area.sqrt(), area.sqrt()), |_| (area / height, height));
        return rectangle(sides, length, diagnostics);
    }
    let large = area > length * length;
    if large {
        let path = "structure.section.area_m2";
        let diagnostic = Diagnostic::warning(format!("`{path}` is more than the square of the length"));
        let label = format!("{} m², beside a length of {} m", number(area), number(length));
        diagnostics.put(path, diagnostic.help(meant(area, "mm²", 1e-6)), label);
    }
    second_moment.is_some_and(|second_moment| general(area, second_moment, length, diagnostics)) || large
}

fn rectangle((width, height): (f64, f64), length: f64, diagnostics: &mut Diagnostics<'_>) -> bool {
    let mut warned = false;
    for (name, side) in [("width_m", width), ("height_m", height)] {
        if side > length && side >= 1.0 {
            let path = format!("structure.section.{name}");
            let diagnostic = Diagnostic::warning(format!("`{path}` is more than the length of the structure"));
            let label = format!("{} m, beside a length of {} m", number(side), number(length));
            diagnostics.put(&path, diagnostic.help(meant(side, "mm", 1e-3)), label);
            warned = true;
        }
    }
    warned
}

/// Area and second moment that belong to no section, or to one higher than the beam is long.
fn general(area: f64, second_moment: f64, length: f64, diagnostics: &mut Diagnostics<'_>) -> bool {
    let path = "structure.section.second_moment_m4";
    let height = (12.0 * second_moment / area).sqrt();
    let shape = height * height / area;
    let odd = height > length || !SHAPES.contains(&shape);
    if odd {
        let diagnostic = Diagnostic::warning(format!("`{path}` and `area_m2` do not go together"));
        let label = format!("that of a rectangle {} m high and {} m wide", number(height), number(area / height));
        let hint = match shape {
            s if s > 1.0 => meant(second_moment, "mm⁴", 1e-12),
            _ => "a rectangle has b h³/12, with the height h in the bending direction".into(),
        };
        diagnostics.put(path, diagnostic.help(hint), label);
    }
    odd
}

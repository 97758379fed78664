use super::meant;
use crate::rule::{number, significant};
use crate::scene::Structure;
use crate::{Diagnostic, Diagnostics};

/// Point masses and added masses above this multiple of the structure's mass look like a mistake of the unit.
const HEAVY: f64 = 100.0;

/// Warns of masses that no such structure carries.
pub fn warn(structure: &Structure, diagnostics: &mut Diagnostics<'_>) {
    let own = structure.section_mass();
    for (i, point) in structure.mass_points.iter().enumerate().filter(|(_, point)| point.mass > HEAVY * own) {
        let path = format!("structure.mass_point.{i}.mass_kg");
        let label = format!("{} kg, on a structure of {} kg", number(point.mass), significant(own, 2));
        let diagnostic = Diagnostic::warning(format!(
            "`{path}` is {} times the mass of the structure",
            significant(point.mass / own, 2)
        ));
        diagnostics.put(&path, diagnostic.help(meant(point.mass, "g", 1e-3)), label);
    }
    let segments = structure.segments.iter().enumerate();
    let of_segments =
        segments.map(|(i, s)| (format!("structure.segment.{i}"), s.added_mass, s.density * s.section.area()));
    let whole = ("structure".to_owned(), structure.added_mass, structure.density * structure.section.area());
    for (table, added, own) in std::iter::once(whole).chain(of_segments) {
        let path = format!("{table}.added_mass_kg_m");
        if added > HEAVY * own && diagnostics.has(&path) {
            let label = format!("{} kg/m, beside {} kg/m of the section", number(added), significant(own, 2));
            let diagnostic =
                Diagnostic::warning(format!("`{path}` is {} times that of the section", significant(added / own, 2)));
            diagnostics.put(&path, diagnostic.help(meant(added, "g/m", 1e-3)), label);
        }
    }
}

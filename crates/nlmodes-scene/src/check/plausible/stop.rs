use super::{is_dimensionless, meant};
use crate::rule::{number, significant};
use crate::scene::{Contact, Direction, Section, Structure};
use crate::{Diagnostic, Diagnostics};

/// Displacements of this share of the length are beyond linear theory.
const LARGE: f64 = 0.2;
/// A stop softer than the structure by this factor is hardly felt.
const SOFT: f64 = 1e-3;

pub fn gap(path: &str, gap: f64, structure: &Structure, diagnostics: &mut Diagnostics<'_>) {
    let part = gap.abs() / structure.length;
    let size = match (part > 1.0, gap > 0.0) {
        (true, true) => "longer than the structure",
        (true, false) => "pressed in by more than the structure's length",
        (false, _) if part > LARGE && !is_dimensionless(structure) => "a large part of the structure's length",
        _ => return,
    };
    let label = format!("{} m, beside a length of {} m", number(gap), number(structure.length));
    diagnostics.put(path, Diagnostic::warning(format!("`{path}` is {size}")).help(meant(gap, "mm", 1e-3)), label);
}

/// A negative gap: it is legal, and has another meaning than a clearance on the other side.
pub fn pressed(path: &str, gap: f64, diagnostics: &mut Diagnostics<'_>) {
    if gap >= 0.0 {
        return;
    }
    let title = format!("`{path}` is negative: at rest the structure is pressed against this stop");
    let label = format!("the stop is {} m beyond where it would just touch", number(-gap));
    let help = "so it is computed, with the force of rest in the mean; a clearance is positive on either side";
    diagnostics.put(path, Diagnostic::warning(title).help(help), label);
}

pub fn stiffness(i: usize, contact: &Contact, structure: &Structure, diagnostics: &mut Diagnostics<'_>) {
    let Some(stiffness) = contact.stiffness.filter(|_| !is_dimensionless(structure)) else { return };
    let (length, modulus) = (structure.length, structure.youngs_modulus);
    let own = match (structure.section, contact.direction) {
        (Section::Beam { second_moment, .. }, Direction::Transverse) => 3.0 * modulus * second_moment / length.powi(3),
        (Section::Beam { area, .. } | Section::Rod { area }, _) => modulus * area / length,
    };
    if stiffness >= SOFT * own {
        return;
    }
    let own_path = format!("contact.{i}.stiffness_n_m");
    let path = if diagnostics.has(&own_path) { own_path } else { "method.contact_stiffness_n_m".into() };
    let diagnostic = Diagnostic::warning(format!("`{path}` is so soft that the stop hardly matters"));
    let label = format!("{} N/m; the structure has some {} N/m", number(stiffness), significant(own, 2));
    diagnostics.put(&path, diagnostic.help(meant(stiffness, "N/mm", 1e3)), label);
}

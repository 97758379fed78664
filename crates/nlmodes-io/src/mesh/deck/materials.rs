use std::collections::{BTreeMap, HashMap};
use std::str;

use crate::text::commas;

/// Materials of a deck, as far as they are linear elastic and isotropic, and where they are.
#[derive(Debug, Default)]
pub(super) struct Materials {
    /// The material under way.
    current: Option<String>,
    /// Lines of `*ELASTIC` of each material: Young's modulus and Poisson's ratio, none of a line that says else.
    lines: BTreeMap<String, Vec<Option<[f64; 2]>>>,
    /// Sets of elements with their materials.
    sections: Vec<(String, String)>,
}

impl Materials {
    /// `*MATERIAL`.
    pub(super) fn begin(&mut self, name: Option<String>) {
        self.current = name;
    }

    /// A line of `*ELASTIC`: `E, ν[, temperature]`.
    pub(super) fn elastic(&mut self, line: &[u8]) {
        let number = |field: &[u8]| str::from_utf8(field.trim_ascii()).ok()?.parse::<f64>().ok();
        let mut fields = commas(line);
        let mut next = || number(fields.next()?);
        let found = next().zip(next()).map(|(e, nu)| [e, nu]);
        let is_sound = |[e, nu]: &[f64; 2]| e.is_finite() && *e > 0.0 && *nu > -1.0 && *nu < 0.5;
        let found = found.filter(is_sound);
        self.current.iter().for_each(|name| self.lines.entry(name.clone()).or_default().push(found));
    }

    /// `*SOLID SECTION`.
    pub(super) fn section(&mut self, set: Option<String>, material: Option<String>) {
        self.sections.extend(set.zip(material));
    }

    /// Young's modulus and Poisson's ratio of elements by their numbers, of those whose material does not depend on the
    /// temperature.
    pub(super) fn of_elements(&self, sets: &BTreeMap<String, Vec<u64>>) -> HashMap<u64, [f64; 2]> {
        let mut found = HashMap::new();
        for (set, material) in &self.sections {
            let Some([Some(elastic)]) = self.lines.get(material).map(Vec::as_slice) else { continue };
            found.extend(sets.get(set).into_iter().flatten().map(|number| (*number, *elastic)));
        }
        found
    }
}

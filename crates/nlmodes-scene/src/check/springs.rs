//! Springs and dampers with a law of force: what must hold between their values.

use std::path::Path;

use super::response::Places;
use crate::raw::{RawAnalysis, RawDirection, RawLaw, RawLawSpring, RawPlace};
use crate::scene::{LawSpring, Place, SpringLaw};
use crate::{Diagnostic, Diagnostics};

/// The springs that are sound; paths count from `base`.
pub fn check(raw: &RawAnalysis, base: &Path, places: &Places<'_>, diagnostics: &mut Diagnostics<'_>) -> Vec<LawSpring> {
    let springs = raw.spring.iter().flatten().enumerate();
    springs.filter_map(|(i, raw)| spring(i, raw, base, places, diagnostics)).collect()
}

fn spring(
    i: usize,
    raw: &RawLawSpring,
    base: &Path,
    places: &Places<'_>,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<LawSpring> {
    let keys = |at: &str| ["at_m", "node", "direction", "structure", "row"].map(|key| format!("spring.{i}.{at}{key}"));
    let law = law(i, &raw.law, base, diagnostics);
    let at = places.place(&raw.place, &keys(""), diagnostics)?;
    let against = match &raw.against {
        None => None,
        Some(written) => {
            // The direction is that of the spring.
            let own = written.direction.clone().or_else(|| direction_of(&at, &raw.place));
            let (structure, node, row) = (written.structure, written.node, written.row);
            let written = RawPlace { at_m: written.at_m, structure, node, row, direction: own };
            Some(places.place(&written, &keys("against."), diagnostics)?)
        }
    };
    if against == Some(at) {
        let diagnostic = Diagnostic::error(format!("`spring.{i}` joins a place to itself"));
        diagnostics.put(&format!("spring.{i}.against"), diagnostic, "expected another place, or the ground without it");
        return None;
    }
    Some(LawSpring { at, against, law: law? })
}

fn direction_of(at: &Place, written: &RawPlace) -> Option<RawDirection> {
    match *at {
        Place::Along { direction, .. } => Some(RawDirection::Word(direction)),
        Place::Node { .. } | Place::Row { .. } => written.direction.clone(),
    }
}

fn law(i: usize, raw: &RawLaw, base: &Path, diagnostics: &mut Diagnostics<'_>) -> Option<SpringLaw> {
    let path = |key: &str| format!("spring.{i}.law.{key}");
    let given: Vec<&str> = [
        ("polynomial", raw.polynomial.is_some()),
        ("table", raw.table.is_some()),
        ("power", raw.power.is_some()),
        ("exponential", raw.exponential.is_some()),
        ("bilinear", raw.bilinear.is_some()),
        ("damper", raw.damper.is_some()),
        ("damper_table", raw.damper_table.is_some()),
        ("function", raw.function.is_some()),
    ]
    .into_iter()
    .filter_map(|(key, there)| there.then_some(key))
    .collect();
    if let [first, second, ..] = given[..] {
        let diagnostic = Diagnostic::error(format!("`spring.{i}.law` has two laws, `{first}` and `{second}`"));
        diagnostics.put(&path(second), diagnostic.help("two springs at one place add"), "expected one law");
        return None;
    }
    if let Some(coefficients) = &raw.polynomial
        && coefficients.iter().all(|k| *k == 0.0)
    {
        let diagnostic = Diagnostic::error(format!("`{}` is zero: this spring does nothing", path("polynomial")));
        diagnostics.put(&path("polynomial"), diagnostic, "expected coefficients, as [0.0, 0.0, 6e9] of a cubic one");
        return None;
    }
    let polynomial = raw.polynomial.clone().map(SpringLaw::Polynomial);
    let table = raw.table.as_ref().map(|file| SpringLaw::Table(base.join(file)));
    let power = raw.power.as_ref().map(|law| SpringLaw::Power {
        stiffness: law.stiffness,
        exponent: law.exponent,
        one_sided: law.one_sided,
    });
    let exponential =
        raw.exponential.as_ref().map(|law| SpringLaw::Exponential { force: law.force_n, length: law.length_m });
    let bilinear = raw.bilinear.as_ref().map(|law| SpringLaw::Bilinear {
        inner: law.stiffness_n_m,
        outer: law.beyond_n_m,
        knee: law.from_m,
    });
    let damper =
        raw.damper.as_ref().map(|law| SpringLaw::Damper { coefficient: law.coefficient, exponent: law.exponent });
    let damper_table = raw.damper_table.as_ref().map(|file| SpringLaw::DamperTable(base.join(file)));
    let function = raw.function.clone().map(SpringLaw::Function);
    polynomial.or(table).or(power).or(exponential).or(bilinear).or(damper).or(damper_table).or(function)
}

use super::meant;
use crate::rule::number;
use crate::scene::Structure;
use crate::{Diagnostic, Diagnostics};

const MODULUS: &str = "structure.material.youngs_modulus_pa";
const DENSITY: &str = "structure.material.density_kg_m3";

pub fn warn(structure: &Structure, diagnostics: &mut Diagnostics<'_>) {
    let (modulus, density) = (structure.youngs_modulus, structure.density);
    if modulus < 1e5 && density > 1e9 {
        exchanged(modulus, density, diagnostics);
        return;
    }
    stiffness(modulus, diagnostics);
    heaviness(density, diagnostics);
}

fn exchanged(modulus: f64, density: f64, diagnostics: &mut Diagnostics<'_>) {
    let diagnostic = Diagnostic::warning("Young's modulus and density look swapped").help(format!(
        "write youngs_modulus_pa = {}, density_kg_m3 = {}",
        number(density),
        number(modulus)
    ));
    let diagnostic = match diagnostics.place(DENSITY) {
        Some(place) => diagnostic.with(place.value.clone(), format!("{} kg/m³", number(density))),
        None => diagnostic,
    };
    diagnostics.put(MODULUS, diagnostic, format!("{} Pa", number(modulus)));
}

fn stiffness(modulus: f64, diagnostics: &mut Diagnostics<'_>) {
    let hint = match modulus {
        m if m < 2e3 => meant(m, "GPa", 1e9),
        m if m < 1e6 => meant(m, "MPa (N/mm²)", 1e6),
        m if m > 2e12 => "diamond has 1.2e12 Pa, steel 2.1e11 Pa".into(),
        _ => return,
    };
    let softness = if modulus < 1e6 { "softer than rubber" } else { "stiffer than diamond" };
    let diagnostic = Diagnostic::warning(format!("`{MODULUS}` is {softness}")).help(hint);
    diagnostics.put(MODULUS, diagnostic, format!("{} Pa", number(modulus)));
}

fn heaviness(density: f64, diagnostics: &mut Diagnostics<'_>) {
    let (than, hint) = match density {
        d if d < 1e-4 => ("lighter than any gas", meant(d, "t/mm³", 1e12)),
        d if d < 30.0 => ("lighter than foam", meant(d, "g/cm³", 1e3)),
        d if d > 3e4 => ("heavier than any solid", "osmium has 2.26e4 kg/m³, steel 7.85e3 kg/m³".into()),
        _ => return,
    };
    let diagnostic = Diagnostic::warning(format!("`{DENSITY}` is {than}")).help(hint);
    diagnostics.put(DENSITY, diagnostic, format!("{} kg/m³", number(density)));
}

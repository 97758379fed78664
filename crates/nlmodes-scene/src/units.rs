//! Unit conversion: a key that ends with a unit may have another one of the same kind, and a quoted number may be
//! followed by its unit.

/// How a number in one unit becomes one in another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Factor {
    /// By a power of ten, which keeps the decimals as they are written.
    Ten(i32),
    /// By any other factor.
    Times(f64),
}

impl Factor {
    fn value(self) -> f64 {
        match self {
            Self::Ten(power) => 10_f64.powi(power),
            Self::Times(factor) => factor,
        }
    }

    /// From a unit with this factor to one with another.
    fn over(self, other: Self) -> Self {
        match (self, other) {
            (Self::Ten(own), Self::Ten(other)) => Self::Ten(own - other),
            (own, other) => Self::Times(own.value() / other.value()),
        }
    }

    /// The number, rounded as decimals are.
    pub fn apply(self, x: f64) -> f64 {
        match self {
            Self::Ten(0) => x,
            Self::Ten(power) => scaled(&format!("{x:e}"), power),
            Self::Times(factor) => x * factor,
        }
    }

    /// The number before.
    pub fn undo(self, x: f64) -> f64 {
        match self {
            Self::Ten(power) => Self::Ten(-power).apply(x),
            Self::Times(factor) => x / factor,
        }
    }
}

/// The end of a key, its unit as people write it, and the factor to the first of its kind.
type Unit = (&'static str, &'static [&'static str], Factor);

/// Kinds of units.
const KINDS: &[&[Unit]] = {
    use Factor::{Ten, Times};
    const TURN: f64 = std::f64::consts::TAU;
    &[
        &[("m", &["m"], Ten(0)), ("cm", &["cm"], Ten(-2)), ("mm", &["mm"], Ten(-3)), ("um", &["µm", "um"], Ten(-6))],
        &[
            ("m2", &["m²", "m2", "m^2"], Ten(0)),
            ("cm2", &["cm²", "cm2", "cm^2"], Ten(-4)),
            ("mm2", &["mm²", "mm2", "mm^2"], Ten(-6)),
        ],
        &[
            ("m4", &["m⁴", "m4", "m^4"], Ten(0)),
            ("cm4", &["cm⁴", "cm4", "cm^4"], Ten(-8)),
            ("mm4", &["mm⁴", "mm4", "mm^4"], Ten(-12)),
        ],
        &[
            ("pa", &["Pa"], Ten(0)),
            ("kpa", &["kPa"], Ten(3)),
            ("mpa", &["MPa"], Ten(6)),
            ("gpa", &["GPa"], Ten(9)),
            ("n_mm2", &["N/mm²", "N/mm2", "N/mm^2"], Ten(6)),
        ],
        &[("kg", &["kg"], Ten(0)), ("g", &["g"], Ten(-3)), ("t", &["t"], Ten(3))],
        &[("kg_m", &["kg/m"], Ten(0)), ("g_m", &["g/m"], Ten(-3)), ("g_mm", &["g/mm"], Ten(0))],
        &[
            ("kg_m2", &["kg·m²", "kg m2"], Ten(0)),
            ("kg_mm2", &["kg·mm²", "kg mm2"], Ten(-6)),
            ("g_mm2", &["g·mm²", "g mm2"], Ten(-9)),
        ],
        &[
            ("kg_m3", &["kg/m³", "kg/m3", "kg/m^3"], Ten(0)),
            ("g_cm3", &["g/cm³", "g/cm3", "g/cm^3"], Ten(3)),
            ("t_m3", &["t/m³", "t/m3", "t/m^3"], Ten(3)),
            ("t_mm3", &["t/mm³", "t/mm3", "t/mm^3"], Ten(12)),
        ],
        &[
            ("n_m", &["N/m"], Ten(0)),
            ("kn_m", &["kN/m"], Ten(3)),
            ("n_mm", &["N/mm"], Ten(3)),
            ("n_um", &["N/µm", "N/um"], Ten(6)),
            ("kn_mm", &["kN/mm"], Ten(6)),
        ],
        &[("m_n", &["m/N"], Ten(0)), ("mm_n", &["mm/N"], Ten(-3)), ("um_n", &["µm/N", "um/N"], Ten(-6))],
        &[("n_s_m", &["N·s/m", "N s/m"], Ten(0)), ("n_s_mm", &["N·s/mm", "N s/mm"], Ten(3))],
        &[("nm", &["N·m", "Nm"], Ten(0)), ("knm", &["kN·m", "kNm"], Ten(3)), ("nmm", &["N·mm", "Nmm"], Ten(-3))],
        &[("n", &["N"], Ten(0)), ("kn", &["kN"], Ten(3))],
        &[
            ("hz", &["Hz"], Ten(0)),
            ("khz", &["kHz"], Ten(3)),
            ("rpm", &["1/min", "rpm"], Times(1.0 / 60.0)),
            ("rad_s", &["rad/s"], Times(1.0 / TURN)),
        ],
        &[("s", &["s"], Ten(0)), ("ms", &["ms"], Ten(-3)), ("us", &["µs", "us"], Ten(-6))],
        &[("1_s", &["1/s"], Ten(0))],
        &[("m_s", &["m/s"], Ten(0)), ("mm_s", &["mm/s"], Ten(-3))],
        &[
            ("m_s2", &["m/s²", "m/s2", "m/s^2"], Ten(0)),
            ("mm_s2", &["mm/s²", "mm/s2", "mm/s^2"], Ten(-3)),
            ("g", &["g"], Times(9.80665)),
        ],
        &[("deg", &["°", "deg", "degrees"], Ten(0)), ("rad", &["rad"], Times(360.0 / TURN))],
        &[("v", &["V"], Ten(0)), ("mv", &["mV"], Ten(-3))],
        &[("ohm", &["Ω", "ohm"], Ten(0)), ("kohm", &["kΩ", "kohm"], Ten(3))],
        &[("h", &["H"], Ten(0)), ("mh", &["mH"], Ten(-3))],
    ]
};

/// A key in another unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Spelling {
    /// The key.
    pub key: String,
    /// The unit as people write it.
    pub unit: &'static str,
    /// Conversion of a number from the unit of an alias to that of the key.
    pub factor: Factor,
}

/// A ratio, which may be in per cent.
fn is_ratio(key: &str) -> bool {
    key.ends_with("ratio") || key.ends_with("ratios")
}

/// The same key in the other units of its kind; `key` itself ends in a unit of the schema.
pub fn spellings(key: &str) -> Vec<Spelling> {
    if is_ratio(key) {
        return vec![Spelling { key: format!("{key}_percent"), unit: "%", factor: Factor::Ten(-2) }];
    }
    let Some((stem, kind, own)) = ends(key).min_by_key(|(stem, ..)| stem.len()) else {
        return Vec::new();
    };
    let others = kind.iter().filter(|unit| unit.0 != own.0);
    others
        .map(|(end, names, factor)| Spelling {
            key: format!("{stem}_{end}"),
            unit: names[0],
            factor: factor.over(own.2),
        })
        .collect()
}

/// The kinds of units at the end of a key: the part before it, the kind, the unit.
fn ends(key: &str) -> impl Iterator<Item = (&str, &'static [Unit], &'static Unit)> {
    KINDS.iter().flat_map(move |kind| {
        let of = move |unit: &'static Unit| {
            let stem = key.strip_suffix(unit.0)?.strip_suffix('_').filter(|stem| !stem.is_empty())?;
            Some((stem, *kind, unit))
        };
        kind.iter().filter_map(of)
    })
}

/// Whether two keys are the same quantity in different units.
pub fn is_same_quantity(one: &str, other: &str) -> bool {
    let same = |a: &str, b: &str| spellings(a).iter().any(|spelling| spelling.key == b);
    one != other && (same(one, other) || same(other, one))
}

/// What to write for a number with its unit, as `210 GPa` for the key `youngs_modulus_pa`: `210e9`. `None` if it is
/// something else.
pub fn converted(key: &str, text: &str) -> Option<String> {
    let (_, kind, own) = ends(key).min_by_key(|(stem, ..)| stem.len())?;
    let split = text.find(|c: char| c.is_alphabetic() && !"eE".contains(c)).or_else(|| text.find([' ', '°', 'Ω']))?;
    let (value, unit) = (text[..split].trim(), text[split..].trim());
    let found = kind.iter().find(|(_, names, _)| names.contains(&unit))?;
    let number: f64 = value.parse().ok()?;
    match found.2.over(own.2) {
        Factor::Ten(0) => Some(value.to_owned()),
        Factor::Ten(power) if !value.contains(['e', 'E']) => Some(format!("{value}e{power}")),
        factor => Some(crate::number(factor.apply(number))),
    }
}

/// The number times a power of ten, rounded as decimals are.
fn scaled(value: &str, power: i32) -> f64 {
    let (digits, exponent) = value.split_once(['e', 'E']).unwrap_or((value, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    format!("{digits}e{}", exponent.saturating_add(power)).parse().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_with_units_are_those_of_the_key() {
        let cases = [
            ("youngs_modulus_pa", "210 GPa", Some("210e9")),
            ("youngs_modulus_pa", "2.1e5 MPa", Some("210000000000")),
            ("youngs_modulus_pa", "210 GPA", None),
            ("gap_m", "1.03mm", Some("1.03e-3")),
            ("gap_m", "0.5 m", Some("0.5")),
            ("contact_stiffness_n_m", "2300 N/mm", Some("2300e3")),
            ("density_kg_m3", "7.73 g/cm³", Some("7.73e3")),
            ("mass_kg", "50 g", Some("50e-3")),
            ("gap_m", "wide", None),
            ("title", "5 m", None),
        ];
        for (key, text, wanted) in cases {
            let found = converted(key, text);
            assert_eq!(found.as_deref().map(str::parse::<f64>), wanted.map(str::parse), "{key} = {text}: {found:?}");
        }
    }

    #[test]
    fn a_key_has_the_units_of_its_own_kind_only() {
        let factor = |key: &str, other: &str| {
            spellings(key).into_iter().find(|spelling| spelling.key == other).map(|spelling| spelling.factor)
        };
        let cases = [
            ("gap_m", "gap_mm", Some(Factor::Ten(-3))),
            ("figure_width_mm", "figure_width_cm", Some(Factor::Ten(1))),
            ("stiffness_n_m", "stiffness_n_mm", Some(Factor::Ten(3))),
            ("stiffness_n_m", "stiffness_n_cm", None),
            ("flexibility_m_n", "flexibility_mm_n", Some(Factor::Ten(-3))),
            ("flexibility_m_n", "flexibility_m_kn", None),
            ("acceleration_m_s2", "acceleration_g", Some(Factor::Times(9.80665))),
            ("mass_kg", "mass_g", Some(Factor::Ten(-3))),
            ("mass_1_s", "mass_1_ms", None),
            ("ratio", "ratio_percent", Some(Factor::Ten(-2))),
            ("poissons_ratio", "poissons_ratio_percent", Some(Factor::Ten(-2))),
            ("elements", "elements_percent", None),
            ("second_moment_m4", "second_moment_mm4", Some(Factor::Ten(-12))),
        ];
        for (key, other, wanted) in cases {
            assert_eq!(factor(key, other), wanted, "{key} {other}");
        }
        assert!(is_same_quantity("gap_um", "gap_m") && !is_same_quantity("stiffness_nm", "stiffness_n_m"));
        assert!(!is_same_quantity("gap_m", "gap_m"));
    }

    #[test]
    fn decimals_stay_as_they_are_written() {
        assert_eq!(Factor::Ten(-3).apply(1.03), 1.03e-3);
        assert_eq!(Factor::Ten(9).apply(181.36), 181.36e9);
        assert_eq!(Factor::Ten(-3).undo(1.03e-3), 1.03);
        assert!((Factor::Times(1.0 / 60.0).apply(3000.0) - 50.0).abs() < 1e-12);
    }
}

//! Numbers with the unit behind them, as people write them, in the unit of the key.

/// Units by the end of the keys that they belong to, and their power of ten there.
const UNITS: [(&str, &[(&str, i32)]); 7] = [
    ("_pa", &[("GPa", 9), ("MPa", 6), ("kPa", 3), ("Pa", 0), ("N/mm2", 6), ("N/mm^2", 6), ("N/mm²", 6)]),
    ("_n_m", &[("N/m", 0), ("kN/m", 3), ("MN/m", 6), ("N/mm", 3), ("kN/mm", 6)]),
    ("_kg_m3", &[("kg/m3", 0), ("kg/m^3", 0), ("kg/m³", 0), ("g/cm3", 3), ("g/cm^3", 3), ("g/cm³", 3), ("t/m3", 3)]),
    ("_m2", &[("m2", 0), ("m^2", 0), ("m²", 0), ("cm2", -4), ("cm²", -4), ("mm2", -6), ("mm^2", -6), ("mm²", -6)]),
    ("_m4", &[("m4", 0), ("m⁴", 0), ("cm4", -8), ("mm4", -12), ("mm^4", -12), ("mm⁴", -12)]),
    ("_hz", &[("Hz", 0), ("kHz", 3)]),
    ("_m", &[("m", 0), ("cm", -2), ("mm", -3), ("µm", -6), ("um", -6)]),
];

/// What to write for a number with its unit, as `210 GPa` for the key `youngs_modulus_pa`: `210e9`. `None` if it is
/// something else.
pub fn converted(key: &str, text: &str) -> Option<String> {
    let (_, units) = UNITS.iter().find(|(end, _)| key.ends_with(end))?;
    let power = |name: &str| units.iter().find(|(unit, _)| *unit == name).map(|(_, power)| *power);
    let split = text.find(|c: char| c.is_alphabetic() && !"eE".contains(c)).or_else(|| text.find(' '))?;
    let (value, unit) = (text[..split].trim(), text[split..].trim());
    let (power, value_is_number) = (power(unit)?, value.parse::<f64>().is_ok());
    match power {
        _ if !value_is_number => None,
        0 => Some(value.to_owned()),
        _ if value.contains(['e', 'E']) => Some(crate::number(scaled(value, power))),
        _ => Some(format!("{value}e{power}")),
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
            ("gap_m", "wide", None),
            ("title", "5 m", None),
        ];
        for (key, text, wanted) in cases {
            let found = converted(key, text);
            assert_eq!(found.as_deref().map(str::parse::<f64>), wanted.map(str::parse), "{key} = {text}: {found:?}");
        }
    }
}

//! Trees of names and values, such as a scene.

use crate::svg::escape;
use crate::unit::superscript;
use serde_json::Value;

/// As nested lists of names and values.
pub(super) fn tree(value: &Value) -> String {
    match value {
        Value::Object(entries) => {
            let entry = |(name, value): (&String, &Value)| {
                let unit = if holds_numbers(value) { unit(name) } else { "" };
                let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
                // Stops are numbered from 0 everywhere.
                let content = match value {
                    Value::Array(values) if name == "contacts" => list(values, 0),
                    value => tree(value),
                };
                format!("<dt>{}</dt>{}\n", escape(&plain(name)), described(&format!("{content}{unit}")))
            };
            let entries: String = entries.iter().filter(|(_, value)| !value.is_null()).map(entry).collect();
            format!("<dl class=\"tree\">{entries}</dl>")
        }
        Value::Array(values) if values.iter().any(Value::is_object) => list(values, 1),
        Value::Array(values) => values.iter().map(tree).collect::<Vec<_>>().join(", "),
        Value::String(text) => escape(text),
        Value::Number(number) => {
            number.as_f64().filter(|_| number.is_f64()).map_or_else(|| number.to_string(), readable)
        }
        Value::Bool(true) => "yes".into(),
        Value::Bool(false) => "no".into(),
        Value::Null => "–".into(),
    }
}

/// The value beside a name; a nested value has its own lines if space is limited.
fn described(content: &str) -> String {
    let class = if content.starts_with("<dl") { " class=\"parts\"" } else { "" };
    format!("<dd{class}>{content}</dd>")
}

/// Entries with their numbers, from `first` on.
fn list(values: &[Value], first: usize) -> String {
    let entry = |(k, value): (usize, &Value)| format!("<dt>{}</dt>{}\n", k + first, described(&tree(value)));
    let entries: String = values.iter().enumerate().map(entry).collect();
    format!("<dl class=\"tree\">{entries}</dl>")
}

/// Names of quantities in SI units without a unit suffix; masses and stiffnesses are not included, since they have
/// several units.
const UNITS: [(&str, &[&str]); 10] = [
    (
        "m",
        &[
            "length",
            "at",
            "gap",
            "position",
            "height",
            "width",
            "thickness",
            "outer",
            "wall",
            "drive",
            "accelerometers",
        ],
    ),
    ("m²", &["area"]),
    ("m⁴", &["second_moment"]),
    ("Pa", &["youngs_modulus"]),
    ("kg/m³", &["density"]),
    ("kg/m", &["added_mass"]),
    ("kg m²", &["inertia"]),
    ("N/m", &["contact_stiffness"]),
    ("Hz", &["sample_rate"]),
    ("s", &["delay"]),
];
/// Unit suffixes of names, and their notation.
const ENDINGS: [(&str, &str); 11] = [
    ("_kg_m3", "kg/m³"),
    ("_m_s2", "m/s²"),
    ("_n_s_m", "N s/m"),
    ("_n_m", "N/m"),
    ("_m_s", "m/s"),
    ("_hz", "Hz"),
    ("_deg", "°"),
    ("_kg", "kg"),
    ("_pa", "Pa"),
    ("_n", "N"),
    ("_m", "m"),
];

fn holds_numbers(value: &Value) -> bool {
    match value {
        Value::Array(values) => values.iter().all(Value::is_number) && !values.is_empty(),
        other => other.is_number(),
    }
}

/// The unit of a quantity with this name; empty for none.
fn unit(name: &str) -> &'static str {
    let known = UNITS.iter().find(|(_, names)| names.contains(&name)).map(|(unit, _)| *unit);
    known.or_else(|| ending(name).map(|(_, unit)| unit)).unwrap_or_default()
}

fn ending(name: &str) -> Option<(&'static str, &'static str)> {
    ENDINGS.into_iter().find(|(ending, _)| name.ends_with(ending))
}

/// A name without its unit, in words.
fn plain(name: &str) -> String {
    let without = ending(name).map_or(name, |(ending, _)| &name[..name.len() - ending.len()]);
    without.replace('_', " ")
}

/// A number in readable form, with up to twelve digits.
fn readable(value: f64) -> String {
    let digits = format!("{value:.11e}");
    let (mantissa, exponent) = digits.split_once('e').unwrap_or((&digits, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if value == 0.0 || (-4..6).contains(&exponent) {
        let decimals = (11 - exponent).clamp(0, 17) as usize;
        let text = format!("{value:.decimals$}");
        let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        return text.replace('-', "−");
    }
    let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.').replace('-', "−");
    format!("{mantissa}\u{2009}×\u{2009}10{}", superscript(exponent))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_have_their_units_and_numbers_their_digits() {
        let value = serde_json::json!({"youngs_modulus": 1.8136e11, "gap": 0.00103, "second_moment": 8e-9,
            "frequency_hz": [39.0, 50.5], "elements": 21, "start": "clamped", "lag_deg": -90.0, "at": "grazing",
            "length": 0.6297552});
        let html = tree(&value);
        for wanted in [
            "<dt>youngs modulus</dt><dd>1.8136\u{2009}×\u{2009}10¹¹ Pa</dd>",
            "<dt>gap</dt><dd>0.00103 m</dd>",
            "<dd>8\u{2009}×\u{2009}10⁻⁹ m⁴</dd>",
            "<dt>frequency</dt><dd>39, 50.5 Hz</dd>",
            "<dt>elements</dt><dd>21</dd>",
            "<dt>lag</dt><dd>−90 °</dd>",
            "<dt>at</dt><dd>grazing</dd>",
            "<dd>0.6297552 m</dd>",
        ] {
            assert!(html.contains(wanted), "{wanted}: {html}");
        }
    }

    #[test]
    fn names_and_values_are_escaped_and_nulls_left_out() {
        let value =
            serde_json::json!({"a_b": "<b>", "<i>": [1, 2.5], "none": null, "many": [{"x": true}, {"x": false}]});
        let html = tree(&value);
        assert!(html.contains("<dt>a b</dt><dd>&lt;b&gt;</dd>"), "{html}");
        assert!(html.contains("<dt>&lt;i&gt;</dt><dd>1, 2.5</dd>"), "{html}");
        assert!(html.contains("<dt>2</dt><dd class=\"parts\"><dl class=\"tree\"><dt>x</dt><dd>no</dd>"), "{html}");
        assert!(!html.contains("none"));
        assert!(roxmltree::Document::parse(&html).is_ok());
    }
}

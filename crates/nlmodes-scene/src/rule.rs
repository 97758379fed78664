//! What the schema says about one key, and the same in words.

use nlmodes_linalg::rounded;
use serde_json::{Map, Value};
use toml::de::DeValue;

/// The schema of one key.
#[derive(Debug, Clone, Copy)]
pub struct Rule<'a>(pub &'a Value);

/// Kinds of values that scenes are made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Table,
    Array,
    Number,
    Integer,
    /// A whole number or a list of them.
    Integers,
    /// A whole number or a word.
    IntegerOrText,
    /// A number or a list of them.
    Numbers,
    /// A word or a list of numbers.
    TextOrNumbers,
    Text,
    Boolean,
    /// One of several kinds, in the words of the schema.
    OneOf,
    /// Whatever is written: who reads it checks it.
    Any,
}

impl<'a> Rule<'a> {
    pub fn kind(self) -> Kind {
        if self.0.get("expected").is_some() {
            return Kind::OneOf;
        }
        if self.0.get("anyValue").is_some() {
            return Kind::Any;
        }
        if let Some(types) = self.0.get("type").and_then(Value::as_array) {
            let has = |wanted: &str| types.iter().any(|name| name == wanted);
            return match (has("string"), has("array"), has("number")) {
                (true, true, _) => Kind::TextOrNumbers,
                (true, false, _) => Kind::IntegerOrText,
                (false, _, true) => Kind::Numbers,
                (false, _, false) => Kind::Integers,
            };
        }
        match self.0.get("type").and_then(Value::as_str) {
            Some("object") => Kind::Table,
            Some("array") => Kind::Array,
            Some("number") => Kind::Number,
            Some("integer") => Kind::Integer,
            Some("boolean") => Kind::Boolean,
            _ => Kind::Text,
        }
    }

    fn properties(self) -> Option<&'a Map<String, Value>> {
        self.0.get("properties").and_then(Value::as_object)
    }

    /// Keys of a table.
    pub fn keys(self) -> impl Iterator<Item = &'a str> {
        self.properties().into_iter().flat_map(|map| map.keys().map(String::as_str))
    }

    /// Rule of a key of a table.
    pub fn of(self, key: &str) -> Option<Rule<'a>> {
        self.properties()?.get(key).map(Rule)
    }

    /// Rule of the items of an array.
    pub fn items(self) -> Option<Rule<'a>> {
        self.0.get("items").map(Rule)
    }

    /// Keys that a table must have.
    pub fn required(self) -> impl Iterator<Item = &'a str> {
        self.0.get("required").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str)
    }

    /// Keys of which a table must have one.
    pub fn one_required(self) -> Vec<&'a str> {
        self.0.get("oneRequired").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str).collect()
    }

    /// Permitted values of a text, or nothing where any will do.
    pub fn choices(self) -> Vec<&'a str> {
        let listed = |key| self.0.get(key).and_then(Value::as_array).into_iter().flatten();
        // A single word is the pattern of a text that may be a number too.
        let word = self
            .0
            .get("pattern")
            .and_then(Value::as_str)
            .and_then(|pattern| pattern.strip_prefix('^')?.strip_suffix('$'));
        let constants = listed("oneOf").filter_map(|branch| branch.get("const"));
        constants.chain(listed("enum")).chain(listed("enum_of_text")).filter_map(Value::as_str).chain(word).collect()
    }

    /// First line of the description.
    pub fn description(self) -> Option<&'a str> {
        self.0.get("description").and_then(Value::as_str)
    }

    fn limit(self, key: &str) -> Option<f64> {
        self.0.get(key).and_then(Value::as_f64)
    }

    /// Whether a number lies between the limits. NaN does not.
    pub fn admits(self, x: f64) -> bool {
        x.is_finite()
            && self.limit("minimum").is_none_or(|limit| x >= limit)
            && self.limit("exclusiveMinimum").is_none_or(|limit| x > limit)
            && self.limit("maximum").is_none_or(|limit| x <= limit)
            && self.limit("exclusiveMaximum").is_none_or(|limit| x < limit)
    }

    /// Whether an array may have so many items.
    pub fn admits_length(self, n: usize) -> bool {
        let n = n as f64;
        self.limit("minItems").is_none_or(|limit| n >= limit) && self.limit("maxItems").is_none_or(|limit| n <= limit)
    }

    /// Whether a text must not be empty.
    pub fn demands_text(self) -> bool {
        self.limit("minLength").is_some_and(|limit| limit > 0.0)
    }

    /// The unit, preceded by `lead`; empty where there is none.
    pub fn unit(self, lead: &str) -> String {
        self.0.get("unit").and_then(Value::as_str).map_or_else(String::new, |unit| format!("{lead}{unit}"))
    }

    /// What is expected, in words.
    pub fn expected(self) -> String {
        let unit = self.unit(", in ");
        match self.kind() {
            Kind::Table => "a table".into(),
            Kind::Array => self.expected_array(),
            Kind::Number => format!("a number{}{unit}", self.limits()),
            Kind::Integer => format!("a whole number{}{unit}", self.limits()),
            Kind::Integers => format!("a whole number{}{unit}, or a list of them", self.limits()),
            Kind::IntegerOrText => format!("a whole number{}{unit}, or {}", self.limits(), either(&self.choices())),
            Kind::Boolean => "true or false".into(),
            Kind::Numbers => format!("a number{}{unit}, or a list of them", self.limits()),
            Kind::TextOrNumbers => format!("{}, or {}", either(&self.choices()), self.expected_array()),
            Kind::Text => self.expected_text(),
            Kind::Any => "a value".into(),
            Kind::OneOf => self.0.get("expected").and_then(Value::as_str).unwrap_or_default().to_owned(),
        }
    }

    /// Whether a value is of one of the kinds that the schema has.
    pub fn fits(self, value: &DeValue<'_>) -> bool {
        let types = self.0.get("type");
        let is = |name: &str| {
            types.is_some_and(|t| t == name || t.as_array().is_some_and(|all| all.iter().any(|t| t == name)))
        };
        match value {
            DeValue::String(text) => {
                let words = self.0.get("enum_of_text").and_then(Value::as_array);
                is("string")
                    && !text.is_empty()
                    && words.is_none_or(|words| words.iter().any(|word| word == text.as_ref()))
            }
            DeValue::Integer(n) => {
                let exact = i64::from_str_radix(n.as_str(), n.radix()).ok();
                (is("integer") || is("number")) && exact.is_some_and(|n| self.admits(n as f64))
            }
            DeValue::Float(x) => is("number") && x.as_str().parse().is_ok_and(|x| self.admits(x)),
            DeValue::Table(table) => {
                let known = |key: &str, value: &DeValue<'_>| self.of(key).is_some_and(|rule| rule.fits(value));
                is("object")
                    && table.iter().all(|(key, value)| known(key.get_ref(), value.get_ref()))
                    && self.required().all(|key| table.contains_key(key))
            }
            DeValue::Array(items) => {
                let each =
                    |item: &toml::Spanned<DeValue<'_>>| self.items().is_none_or(|rule| rule.fits(item.get_ref()));
                is("array") && self.admits_length(items.len()) && items.iter().all(each)
            }
            _ => false,
        }
    }

    fn expected_text(self) -> String {
        match self.choices().as_slice() {
            [] => "a text in quotes".into(),
            choices => either(choices),
        }
    }

    fn expected_array(self) -> String {
        let Some(items) = self.items().filter(|items| items.kind() != Kind::Table) else {
            return "a list of tables".into();
        };
        let (unit, fixed) = (self.unit(", in "), self.limit("minItems").filter(|n| self.limit("maxItems") == Some(*n)));
        match (items.kind(), fixed) {
            (Kind::Text, _) => "texts in quotes, in square brackets".into(),
            (Kind::Array, _) => format!("a list of lists of numbers{unit}"),
            (_, Some(n)) => format!("{n} numbers in square brackets,{}{unit}", each(items)),
            (_, None) if self.limit("minItems").is_some() => {
                format!("a list of one or more in square brackets, each {}{unit}", items.expected())
            }
            (_, None) => format!("numbers in square brackets{}{unit}", each(items)),
        }
    }

    /// The limits, with a space or a comma in front.
    fn limits(self) -> String {
        let text = |key| self.limit(key).map(number);
        let low = text("minimum").map(|x| format!("{x} or more"));
        let low = low.or_else(|| text("exclusiveMinimum").map(|x| format!("greater than {x}")));
        let high = text("maximum").map(|x| format!("at most {x}"));
        let high = high.or_else(|| text("exclusiveMaximum").map(|x| format!("less than {x}")));
        match (text("minimum").zip(text("maximum")), low, high) {
            (Some((low, high)), ..) => format!(" from {low} to {high}"),
            (None, Some(low), Some(high)) => format!(" {low}, {high}"),
            (None, Some(limit), None) | (None, None, Some(limit)) => format!(" {limit}"),
            (None, None, None) => String::new(),
        }
    }
}

/// ` each greater than 0`, or nothing where numbers have no limits.
fn each(items: Rule<'_>) -> String {
    let limits = items.limits();
    if limits.is_empty() { limits } else { format!(" each{limits}") }
}

/// `"a"`, `"b"` or `"c"`.
pub fn either(choices: &[&str]) -> String {
    let quoted: Vec<String> = choices.iter().map(|choice| format!("\"{choice}\"")).collect();
    match quoted.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => quoted.concat(),
    }
}

/// A computed number, with six digits at most.
pub fn short(x: f64) -> String {
    significant(x, 6)
}

/// A number with so many digits at most.
pub fn significant(x: f64, digits: usize) -> String {
    number(rounded(x, digits))
}

/// A number as people write it: up to nine significant digits, a power of ten where it is very large or very small.
pub fn number(x: f64) -> String {
    let magnitude = x.abs();
    if magnitude != 0.0 && !(1e-4..1e9).contains(&magnitude) {
        let text = format!("{x:.8e}");
        return match text.split_once('e') {
            Some((digits, exponent)) if digits.contains('.') => {
                format!("{}e{exponent}", digits.trim_end_matches('0').trim_end_matches('.'))
            }
            _ => text,
        };
    }
    let decimals = if magnitude == 0.0 { 0 } else { (8 - magnitude.log10().floor() as i32).max(0) as usize };
    let text = format!("{x:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A share in percent, to two digits.
pub fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share, 2))
}

/// `1 node`, `2 nodes`.
pub fn counted(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// The path of a key in a table.
pub fn join(table: &str, key: &str) -> String {
    if table.is_empty() { key.to_owned() } else { format!("{table}.{key}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::schema;

    #[test]
    fn numbers_are_written_as_people_write_them() {
        let written: Vec<String> = [0.0, 20.0, -0.5, 0.62975520, 1e6, 181.36e9, 1e-5, 1.0 / 3.0].map(number).into();
        assert_eq!(written, ["0", "20", "-0.5", "0.6297552", "1000000", "1.8136e11", "1e-5", "0.333333333"]);
        assert_eq!(number(f64::INFINITY), "inf");
        assert_eq!(number(f64::NAN), "NaN");
    }

    #[test]
    fn expectations_name_limits_units_and_choices() {
        let schema = schema();
        let structure = Rule(&schema).of("structure").unwrap();
        let expected = |rule: Rule, key: &str| rule.of(key).unwrap().expected();
        assert_eq!(expected(structure, "length_m"), "a number greater than 0, in m");
        assert_eq!(expected(structure, "elements"), "a whole number from 1 to 1000000");
        assert_eq!(expected(structure, "start"), "\"clamped\", \"pinned\", \"sliding\" or \"free\"");
        assert_eq!(expected(structure, "mass_matrix"), "\"consistent\" or \"lumped\"");
        let continuation = Rule(&schema).of("continuation").unwrap();
        assert_eq!(expected(continuation, "frequency_hz"), "2 numbers in square brackets, each 0 or more, in Hz");
    }
}

//! What is wrong with single values, in words.

use std::ops::Range;

use toml::de::DeValue;

use super::unknown::{absent, heading, with_absent};
use crate::Diagnostic;
use crate::nearest::nearest;
use crate::rule::{Kind, Rule, number};
use crate::units::converted;

/// A number outside the limits, or one that is not finite.
pub fn out_of_range(path: &str, x: f64, rule: Rule<'_>) -> Diagnostic {
    let what = if x.is_finite() { "out of range" } else { "not a finite number" };
    let diagnostic = Diagnostic::error(format!("`{path}` is {what}"));
    let key = path.split('.').rfind(|part| part.parse::<usize>().is_err()).unwrap_or_default();
    let is_ratio = key.ends_with("ratio") || key.ends_with("ratios");
    if is_ratio && (1.0..100.0).contains(&x) && rule.admits(1e-2 * x) {
        let (percent, part) = (number(x), number(1e-2 * x));
        return diagnostic.help(format!("a ratio is a fraction: {percent} % is {part}"));
    }
    diagnostic
}

/// A key that already occurs in the table, in another unit.
pub fn twice(path: &str, place: Range<usize>, first: Range<usize>) -> Diagnostic {
    let diagnostic = Diagnostic::error(format!("`{path}` is given twice, in two units"));
    diagnostic.at(place, "expected one of the two").with(first, "the first one")
}

/// An array with too few or too many items.
pub fn wrong_length(path: &str, found: usize) -> Diagnostic {
    Diagnostic::error(format!("`{path}` has {found} {}", if found == 1 { "item" } else { "items" }))
}

/// A text that is not one of those permitted, or empty where it must not be.
pub fn in_text(path: &str, text: &str, rule: Rule<'_>) -> Option<Diagnostic> {
    let choices = rule.choices();
    if choices.is_empty() {
        let empty = rule.demands_text() && text.trim().is_empty();
        return empty.then(|| Diagnostic::error(format!("`{path}` is empty")));
    }
    if choices.contains(&text) {
        return None;
    }
    let diagnostic = Diagnostic::error(format!("`{path}` cannot be \"{text}\""));
    if let Some(what) = absent(text) {
        return Some(with_absent(diagnostic, what));
    }
    Some(match nearest(text, choices) {
        Some(choice) => diagnostic.help(format!("did you mean \"{choice}\"?")),
        None => match elsewhere(text, &rule.choices()) {
            Some(choice) => diagnostic.help(format!("here it is called \"{choice}\"")),
            None => diagnostic,
        },
    })
}

/// What is called so in other programs.
const SYNONYMS: [(&str, &[&str]); 9] = [
    ("clamped", &["fixed", "built-in", "encastre", "fix", "cantilever", "rigid"]),
    ("pinned", &["hinged", "simply supported", "simply-supported", "supported", "simple"]),
    ("sliding", &["roller", "guided"]),
    ("transverse", &["vertical", "lateral", "bending", "y", "z", "deflection"]),
    ("axial", &["longitudinal", "x", "horizontal"]),
    ("positive", &["top", "up", "upper", "right", "above", "+"]),
    ("negative", &["bottom", "down", "lower", "left", "below", "-"]),
    ("rod", &["bar", "truss"]),
    ("beam", &["timoshenko", "euler-bernoulli", "cantilever"]),
];

/// The permitted value that other programs call so.
fn elsewhere<'c>(text: &str, choices: &[&'c str]) -> Option<&'c str> {
    let text = text.trim().to_lowercase();
    let meant = SYNONYMS.iter().filter(|(_, theirs)| theirs.contains(&text.as_str())).map(|(ours, _)| *ours);
    meant.filter_map(|ours| choices.iter().copied().find(|choice| *choice == ours)).next()
}

/// A value that is none of those that the schema has.
pub fn unfit(path: &str) -> Diagnostic {
    Diagnostic::error(format!("`{path}` is not a valid choice"))
}

/// A file under a key in another unit, which converts numbers of the scene alone.
pub fn of_a_file(path: &str, rule: Rule<'_>) -> Diagnostic {
    let diagnostic = Diagnostic::error(format!("`{path}` is a text, whose numbers no unit of the key converts"));
    diagnostic.help(format!("a file is named under `{}`, with its numbers in {}", last(path), rule.unit("")))
}

/// A value of another kind than the schema has.
pub fn wrong_kind(path: &str, found: &DeValue<'_>, rule: Rule<'_>) -> Diagnostic {
    let diagnostic =
        Diagnostic::error(format!("`{path}` must be {}, not {}", kind_wanted(rule), kind_found(found, rule.kind())));
    match (rule.kind(), found) {
        (Kind::Number | Kind::Integer | Kind::Integers | Kind::Numbers, DeValue::String(text)) => {
            numeric_help(diagnostic, path, text, rule)
        }
        (Kind::Array, DeValue::String(text)) if is_numbers(rule) => match listed(text, rule) {
            Some(list) => diagnostic.help(in_brackets(path, &list)),
            None => diagnostic,
        },
        (Kind::Integer | Kind::Integers, DeValue::Float(x)) => match x.as_str().parse::<f64>() {
            Ok(x) if x.fract() == 0.0 && x.abs() < 1e9 => diagnostic.help(format!("write {x:.0}")),
            _ => diagnostic,
        },
        (Kind::Array, DeValue::Table(_)) if is_tables(rule) => {
            diagnostic.help(format!("write the heading with two brackets: {}", heading(path)))
        }
        (Kind::Table, _) => diagnostic.help(format!("its keys go below a heading {}", heading(path))),
        (Kind::Text, _) if !rule.choices().is_empty() => diagnostic.help("texts are written in quotes"),
        _ => diagnostic,
    }
}

fn numeric_help(diagnostic: Diagnostic, path: &str, text: &str, rule: Rule<'_>) -> Diagnostic {
    let text = text.trim();
    if text.parse::<f64>().is_ok() {
        return diagnostic.help(format!("write it without quotes: {text}"));
    }
    if let Some(list) = listed(text, rule) {
        let diagnostic = diagnostic.help(in_brackets(path, &list));
        return match text.replacen(',', ".", 1).parse::<f64>() {
            Ok(x) if rule.kind() == Kind::Numbers => diagnostic.help(format!("one number has a decimal point: {x:?}")),
            _ => diagnostic,
        };
    }
    let with_point = text.replacen(',', ".", 1);
    if with_point.parse::<f64>().is_ok() {
        return diagnostic.help(format!("numbers have a decimal point, not a comma: write {with_point}"));
    }
    if let Some(value) = converted(last(path), &with_point) {
        return diagnostic.help(format!("write {value}; the unit, {}, is part of the key", rule.unit("")));
    }
    let unit = rule.unit("");
    if unit.is_empty() || !text.starts_with(|c: char| c.is_ascii_digit() || c == '-' || c == '.') {
        return diagnostic;
    }
    diagnostic.help(format!("write the number alone; the unit, {unit}, is part of the key"))
}

/// The numbers of a text as a list in brackets, where the key takes a list of them.
fn listed(text: &str, rule: Rule<'_>) -> Option<String> {
    let is_whole = rule.kind() == Kind::Integers || rule.items().is_some_and(|items| items.kind() == Kind::Integer);
    let takes_a_list = matches!(rule.kind(), Kind::Integers | Kind::Numbers) || is_numbers(rule);
    let parts: Vec<&str> = text.split([',', ';', ' ']).map(str::trim).filter(|part| !part.is_empty()).collect();
    let is_number = |part: &&str| if is_whole { part.parse::<i64>().is_ok() } else { part.parse::<f64>().is_ok() };
    (takes_a_list && parts.len() > 1 && parts.iter().all(is_number)).then(|| format!("[{}]", parts.join(",")))
}

fn in_brackets(path: &str, list: &str) -> String {
    format!("several numbers are written in square brackets: {path}={list}, in a shell between quotation marks")
}

fn is_numbers(rule: Rule<'_>) -> bool {
    rule.kind() == Kind::Array && rule.items().is_some_and(|i| matches!(i.kind(), Kind::Number | Kind::Integer))
}

fn is_tables(rule: Rule<'_>) -> bool {
    rule.items().is_some_and(|items| items.kind() == Kind::Table)
}

fn kind_wanted(rule: Rule<'_>) -> &'static str {
    match rule.kind() {
        Kind::Table => "a table",
        Kind::Array if is_tables(rule) => "a list of tables",
        Kind::Array if rule.items().is_some_and(|items| items.kind() == Kind::Text) => "a list of texts",
        Kind::Array => "a list of numbers",
        Kind::Number => "a number",
        Kind::Integer => "a whole number",
        Kind::Integers => "a whole number or a list of them",
        Kind::IntegerOrText => "a whole number or a text",
        Kind::Boolean => "true or false",
        Kind::Numbers => "a number or a list of them",
        Kind::TextOrNumbers => "a text or a list of numbers",
        Kind::Text => "a text",
        Kind::OneOf => "a value of another kind",
        Kind::Any => "a value",
    }
}

fn kind_found(value: &DeValue<'_>, wanted: Kind) -> &'static str {
    match value {
        DeValue::String(_) => "a text",
        DeValue::Float(_) if matches!(wanted, Kind::Integer | Kind::Integers | Kind::IntegerOrText) => {
            "a number with decimals"
        }
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date or time",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}

/// A key that must be there and is not.
pub fn missing(path: &str, rule: Rule<'_>) -> Diagnostic {
    let diagnostic = match rule.kind() {
        Kind::Table => Diagnostic::error(format!("the table {} is missing", heading(path))),
        _ => Diagnostic::error(format!("`{path}` is missing")),
    };
    match (rule.description(), rule.kind()) {
        (Some(text), Kind::Table) => {
            let required: Vec<String> = rule.required().map(|key| format!("`{key}`")).collect();
            let required =
                if required.is_empty() { String::new() } else { format!(", at least {}", required.join(", ")) };
            diagnostic.help(format!("add a heading {} and its keys below it{required}: {}", heading(path), lower(text)))
        }
        (Some(text), _) => diagnostic.help(format!("`{}` means: {}", last(path), lower(text))),
        (None, _) => diagnostic,
    }
}

/// The label of the heading of the table where the key is missing.
pub fn missing_label(path: &str, rule: Rule<'_>) -> String {
    match rule.kind() {
        Kind::Table => format!("expected a table {} that belongs to this one", heading(path)),
        _ => format!("expected `{}` in this table: {}", last(path), rule.expected()),
    }
}

fn last(path: &str) -> &str {
    path.rsplit_once('.').map_or(path, |(_, key)| key)
}

/// The text with a small first letter, unless a name or abbreviation begins it.
fn lower(text: &str) -> String {
    let mut letters = text.chars();
    match letters.next() {
        Some(first) if !text.starts_with("Young") && !text.starts_with("Poisson") => {
            first.to_lowercase().chain(letters).collect()
        }
        _ => text.to_owned(),
    }
}

//! The document against the schema: unknown keys, units, kinds of values, limits, permitted values, missing keys.
//!
//! Whatever does not conform is reported and omitted from the result: the tables in the units and with the keys of the
//! schema, from which the types of a scene are read.

mod unknown;
mod value;

use std::ops::Range;

use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use crate::rule::{Kind, Rule, join};
use crate::units::{Factor, Spelling, spellings};
use crate::{Diagnostic, Diagnostics};

/// What of the table conforms to the schema; the rest is reported.
pub fn conform(root: &DeTable<'_>, schema: &Value, diagnostics: &mut Diagnostics<'_>) -> Value {
    let mut walk = Walk { root: Rule(schema), diagnostics, missing: Vec::new(), missing_one: Vec::new() };
    let found = walk.table(root, Rule(schema), "");
    let Walk { mut missing, missing_one, diagnostics, .. } = walk;
    // The first of several is the requested one.
    let first = missing_one.into_iter().filter(|keys| !keys.iter().any(|(path, _)| diagnostics.is_meant(path)));
    missing.extend(first.filter_map(|keys| keys.into_iter().next()));
    for (path, rule) in missing {
        if diagnostics.is_meant(&path) {
            continue;
        }
        let diagnostic = value::missing(&path, rule);
        diagnostics.put(&path, diagnostic, value::missing_label(&path, rule));
    }
    found
}

/// What conforms as the types of a scene, which take all that does.
pub fn read<T: DeserializeOwned>(conforming: Value, diagnostics: &mut Diagnostics<'_>) -> Option<T> {
    let read = serde_json::from_value(conforming);
    read.map_err(|error| diagnostics.push(Diagnostic::error(error.to_string()))).ok()
}

/// A value of a document.
type Item<'d> = Spanned<DeValue<'d>>;

/// A key of a table: as the schema has it, and in which unit it is written.
struct Key<'s> {
    own: &'s str,
    spelling: Option<Spelling>,
}

impl<'s> Key<'s> {
    /// The key of a table that is written so.
    fn of(written: &str, table: Rule<'s>) -> Option<Self> {
        let spelled = |own: &'s str| {
            let spelling = spellings(own).into_iter().find(|spelling| spelling.key == written)?;
            Some(Self { own, spelling: Some(spelling) })
        };
        let own = table.keys().find(|own| *own == written).map(|own| Self { own, spelling: None });
        own.or_else(|| table.keys().find_map(spelled))
    }
}

struct Walk<'w, 'b, 'f> {
    root: Rule<'w>,
    diagnostics: &'b mut Diagnostics<'f>,
    /// Required keys that are not there.
    missing: Vec<(String, Rule<'w>)>,
    /// Keys of which one is required but none is present.
    missing_one: Vec<Vec<(String, Rule<'w>)>>,
}

impl<'w> Walk<'w, '_, '_> {
    fn table(&mut self, table: &DeTable<'_>, rule: Rule<'w>, path: &str) -> Value {
        let mut there: Vec<(&str, Range<usize>)> = Vec::new();
        let mut conforming = Map::new();
        for (written, value) in table {
            let name = written.get_ref();
            let Some(Key { own, spelling }) = Key::of(name, rule) else {
                self.unknown(name, written.span(), value, rule, path);
                continue;
            };
            let first = there.iter().find(|(other, _)| *other == own).map(|(_, place)| place.clone());
            there.push((own, written.span()));
            if let Some(first) = first {
                self.diagnostics.push(value::twice(&join(path, own), written.span(), first));
            } else if let Some(value) = self.entry(own, spelling, value, rule, path) {
                conforming.insert(own.to_owned(), value);
            }
        }
        self.absent(&there, rule, path);
        Value::Object(conforming)
    }

    /// Records the required keys that are missing.
    fn absent(&mut self, there: &[(&str, Range<usize>)], rule: Rule<'w>, path: &str) {
        let has = |key: &str| there.iter().any(|(own, _)| *own == key);
        let at = |key: &str| Some((join(path, key), rule.of(key)?));
        self.missing.extend(rule.required().filter(|key| !has(key)).filter_map(at));
        let alternatives = rule.one_required();
        if !alternatives.iter().any(|key| has(key)) {
            self.missing_one.push(alternatives.into_iter().filter_map(at).collect());
        }
    }

    /// Reports an unknown key.
    fn unknown(&mut self, name: &str, place: Range<usize>, value: &Item<'_>, table: Rule<'w>, path: &str) {
        let guess = unknown::guess(name, value.get_ref().as_str(), path, self.root);
        self.diagnostics.push(unknown::diagnostic(name, path, table, &guess).at(place, guess.label(path)));
        if let Some(meant) = guess.path(path) {
            self.diagnostics.mean(meant);
        }
    }

    /// The value of a key of the table, if it conforms.
    fn entry(
        &mut self,
        own: &str,
        spelling: Option<Spelling>,
        value: &Item<'_>,
        table: Rule<'w>,
        path: &str,
    ) -> Option<Value> {
        let (rule, full) = (table.of(own)?, join(path, own));
        let factor = spelling.as_ref().map_or(Factor::Ten(0), |spelling| spelling.factor);
        if let Some(spelling) = spelling {
            self.diagnostics.spell(full.clone(), Spelling { key: join(path, &spelling.key), ..spelling });
        }
        self.value(value, rule, &full, factor)
    }

    /// The value, if it conforms; of a table the rest that does.
    fn value(&mut self, item: &Item<'_>, rule: Rule<'w>, path: &str, factor: Factor) -> Option<Value> {
        let found = match (rule.kind(), item.get_ref()) {
            (Kind::Any, value) => Ok(any(value)),
            (Kind::Table, DeValue::Table(table)) => return Some(self.table(table, rule, path)),
            (Kind::Array | Kind::Integers | Kind::Numbers | Kind::TextOrNumbers, DeValue::Array(items)) => {
                return self.array(items, rule, path, factor);
            }
            (
                Kind::Number | Kind::Integer | Kind::Integers | Kind::IntegerOrText | Kind::Numbers,
                DeValue::Integer(_),
            )
            | (Kind::Number | Kind::Numbers, DeValue::Float(_)) => number(item.get_ref(), rule, path, factor),
            (Kind::Boolean, DeValue::Boolean(value)) => Ok(Value::Bool(*value)),
            (Kind::Text | Kind::IntegerOrText | Kind::TextOrNumbers, DeValue::String(text)) => {
                value::in_text(path, text, rule).map_or_else(|| Ok(Value::from(text.as_ref())), Err)
            }
            (Kind::OneOf, DeValue::String(_)) if factor != Factor::Ten(0) => Err(value::of_a_file(path, rule)),
            (Kind::OneOf, value) if rule.fits(value) => Ok(in_unit(any(value), factor)),
            (Kind::OneOf, _) => Err(value::unfit(path)),
            (_, other) => Err(value::wrong_kind(&self.diagnostics.as_written(path), other, rule)),
        };
        match found {
            // A single value is a list of one where lists are taken.
            Ok(single) if matches!(rule.kind(), Kind::Integers | Kind::Numbers) => Some(Value::Array(vec![single])),
            Ok(value) => Some(value),
            Err(diagnostic) => {
                self.report(path, diagnostic, rule);
                None
            }
        }
    }

    fn array(&mut self, items: &DeArray<'_>, rule: Rule<'w>, path: &str, factor: Factor) -> Option<Value> {
        if !rule.admits_length(items.len()) {
            self.report(path, value::wrong_length(path, items.len()), rule);
            return None;
        }
        let Some(each) = rule.items() else {
            return Some(Value::Array(items.iter().map(|i| any(i.get_ref())).collect()));
        };
        let conforming: Vec<Option<Value>> =
            items.iter().enumerate().map(|(i, item)| self.value(item, each, &format!("{path}.{i}"), factor)).collect();
        conforming.into_iter().collect::<Option<Vec<Value>>>().map(Value::Array)
    }

    fn report(&mut self, path: &str, diagnostic: Diagnostic, rule: Rule<'_>) {
        let label = format!("found {}, expected {}", self.diagnostics.written(path), rule.expected());
        self.diagnostics.put(path, diagnostic, label);
    }
}

/// A number in the unit of the schema, if it lies between the limits.
fn number(found: &DeValue<'_>, rule: Rule<'_>, path: &str, factor: Factor) -> Result<Value, Diagnostic> {
    let whole = whole(found).filter(|_| factor == Factor::Ten(0));
    let is_whole = matches!(rule.kind(), Kind::Integer | Kind::Integers | Kind::IntegerOrText);
    let x = factor.apply(size(found));
    match whole {
        _ if !rule.admits(x) => Err(value::out_of_range(path, x, rule)),
        Some(n) => Ok(Value::from(n)),
        // More digits than a whole number of the machine has.
        None if is_whole => Err(value::out_of_range(path, x, rule)),
        None => Ok(Value::from(x)),
    }
}

/// A whole number that the machine has.
fn whole(value: &DeValue<'_>) -> Option<i64> {
    value.as_integer().and_then(|n| i64::from_str_radix(n.as_str(), n.radix()).ok())
}

fn size(value: &DeValue<'_>) -> f64 {
    match value {
        DeValue::Float(x) => x.as_str().parse().unwrap_or(f64::NAN),
        DeValue::Integer(_) => whole(value).map_or(f64::MAX, |n| n as f64),
        _ => f64::NAN,
    }
}

/// The same with its numbers in the unit of the schema.
fn in_unit(value: Value, factor: Factor) -> Value {
    match value {
        Value::Array(items) => items.into_iter().map(|item| in_unit(item, factor)).collect(),
        Value::Number(x) if factor != Factor::Ten(0) => Value::from(factor.apply(x.as_f64().unwrap_or(f64::NAN))),
        other => other,
    }
}

/// A value as written.
fn any(value: &DeValue<'_>) -> Value {
    match value {
        DeValue::String(text) => Value::from(text.as_ref()),
        DeValue::Boolean(value) => Value::Bool(*value),
        DeValue::Datetime(time) => Value::from(time.to_string()),
        DeValue::Array(items) => items.iter().map(|item| any(item.get_ref())).collect(),
        DeValue::Table(table) => {
            Value::Object(table.iter().map(|(key, value)| (key.get_ref().to_string(), any(value.get_ref()))).collect())
        }
        number => whole(number).map_or_else(|| Value::from(size(number)), Value::from),
    }
}

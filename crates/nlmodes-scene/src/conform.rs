//! The document against the schema: unknown keys, kinds of values, limits, permitted values, missing keys.
//!
//! Whatever does not conform is reported and taken out, so that the rest can still be read and checked further.

mod unknown;
mod value;

use std::borrow::Cow;

use serde_json::Value;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use crate::rule::{Kind, Rule, join};
use crate::{Diagnostic, Diagnostics};

/// Reports whatever in the table does not conform to the schema, and takes it out.
pub fn conform(root: &mut DeTable<'_>, schema: &Value, diagnostics: &mut Diagnostics<'_>) {
    let mut walk = Walk { root: Rule(schema), diagnostics, missing: Vec::new(), missing_one: Vec::new() };
    walk.table(root, Rule(schema), "");
    let Walk { mut missing, missing_one, diagnostics, .. } = walk;
    // The first of several is the one that is asked for.
    let first = missing_one.into_iter().filter(|keys| !keys.iter().any(|(path, _)| diagnostics.is_meant(path)));
    missing.extend(first.filter_map(|keys| keys.into_iter().next()));
    for (path, rule) in missing {
        if diagnostics.is_meant(&path) {
            continue;
        }
        let diagnostic = value::missing(&path, rule);
        diagnostics.put(&path, diagnostic, value::missing_label(&path, rule));
    }
}

/// A key of a document.
type Key<'d> = Spanned<Cow<'d, str>>;
/// A value of a document.
type Item<'d> = Spanned<DeValue<'d>>;

struct Walk<'w, 'b, 'f> {
    root: Rule<'w>,
    diagnostics: &'b mut Diagnostics<'f>,
    /// Required keys that are not there.
    missing: Vec<(String, Rule<'w>)>,
    /// Keys of which one is required and none is there.
    missing_one: Vec<Vec<(String, Rule<'w>)>>,
}

impl<'w> Walk<'w, '_, '_> {
    fn table(&mut self, table: &mut DeTable<'_>, rule: Rule<'w>, path: &str) {
        let absent = rule.required().filter(|key| !table.contains_key(*key));
        self.missing.extend(absent.filter_map(|key| Some((join(path, key), rule.of(key)?))));
        let alternatives = rule.one_required();
        if !alternatives.iter().any(|key| table.contains_key(*key)) {
            self.missing_one
                .push(alternatives.iter().filter_map(|key| Some((join(path, key), rule.of(key)?))).collect());
        }
        let written = std::mem::take(table);
        *table = written.into_iter().filter_map(|(key, value)| self.entry(key, value, rule, path)).collect();
    }

    /// The entry, if the table has such a key and the value conforms.
    fn entry<'d>(
        &mut self,
        key: Key<'d>,
        mut value: Item<'d>,
        table: Rule<'w>,
        path: &str,
    ) -> Option<(Key<'d>, Item<'d>)> {
        let name = key.get_ref();
        if let Some(rule) = table.of(name) {
            return self.value(&mut value, rule, &join(path, name)).then_some((key, value));
        }
        let guess = unknown::guess(name, path, self.root);
        self.diagnostics.push(unknown::diagnostic(name, path, table, &guess).at(key.span(), guess.label(path)));
        if let Some(meant) = guess.path(path) {
            self.diagnostics.mean(meant);
        }
        None
    }

    /// Whether the value conforms, or is a table of which the rest does.
    fn value(&mut self, value: &mut Item<'_>, rule: Rule<'w>, path: &str) -> bool {
        let diagnostic = match (rule.kind(), value.get_mut()) {
            (Kind::Any, _) => None,
            (Kind::Table, DeValue::Table(table)) => {
                self.table(table, rule, path);
                None
            }
            (Kind::Array | Kind::Integers | Kind::Numbers | Kind::TextOrNumbers, DeValue::Array(items)) => {
                return self.array(items, rule, path);
            }
            (
                Kind::Number | Kind::Integer | Kind::Integers | Kind::IntegerOrText | Kind::Numbers,
                DeValue::Integer(n),
            ) => {
                let exact = i64::from_str_radix(n.as_str(), n.radix()).ok();
                let x = exact.map_or(f64::MAX, |n| n as f64);
                (!rule.admits(x)).then(|| value::out_of_range(path, x))
            }
            (Kind::Boolean, DeValue::Boolean(_)) => None,
            (Kind::Number | Kind::Numbers, DeValue::Float(x)) => {
                let x = x.as_str().parse().unwrap_or(f64::NAN);
                (!rule.admits(x)).then(|| value::out_of_range(path, x))
            }
            (Kind::Text | Kind::IntegerOrText | Kind::TextOrNumbers, DeValue::String(text)) => {
                value::in_text(path, text, rule)
            }
            (Kind::OneOf, other) => (!rule.fits(other)).then(|| value::unfit(path)),
            (_, other) => Some(value::wrong_kind(path, other, rule)),
        };
        let conforms = diagnostic.is_none();
        if let Some(diagnostic) = diagnostic {
            self.report(path, diagnostic, rule);
        } else if matches!(rule.kind(), Kind::Integers | Kind::Numbers) {
            wrap(value);
        }
        conforms
    }

    fn array(&mut self, items: &mut DeArray<'_>, rule: Rule<'w>, path: &str) -> bool {
        if !rule.admits_length(items.len()) {
            self.report(path, value::wrong_length(path, items.len()), rule);
            return false;
        }
        let Some(each) = rule.items() else { return true };
        let mut conforms = true;
        for (i, item) in items.iter_mut().enumerate() {
            conforms &= self.value(item, each, &format!("{path}.{i}"));
        }
        conforms
    }

    fn report(&mut self, path: &str, diagnostic: Diagnostic, rule: Rule<'_>) {
        let label = format!("found {}, expected {}", self.diagnostics.written(path), rule.expected());
        self.diagnostics.put(path, diagnostic, label);
    }
}

/// Makes a list of one of a single value.
fn wrap(value: &mut Item<'_>) {
    let span = value.span();
    let mut list = DeArray::new();
    list.push(std::mem::replace(value, Spanned::new(span.clone(), DeValue::Boolean(false))));
    *value = Spanned::new(span, DeValue::Array(list));
}

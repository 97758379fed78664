//! The quantities of each case.

use nlmodes::modal::Event;
use nlmodes::report::columns::{BranchRow, ResponseRow, Row};
use nlmodes_scene::{Diagnostic, Diagnostics, nearest};
use serde_json::Value;

use crate::curve::{ENERGY_RATIO, has_numbers};
use crate::raw::RawQuantity;
use crate::study::{Limit, Of, Place, Quantity, Selected};

const EXPECTED: &str = "expected { energy_ratio = 2.0 }, { column = value }, \"first\", \"last\", \"max\", \"min\" or \
    the name of an event";
/// The quantities of all tables.
pub fn quantities(raw: &[RawQuantity], diagnostics: &mut Diagnostics<'_>) -> Vec<Quantity> {
    raw.iter().enumerate().filter_map(|(k, raw)| quantity(raw, k, diagnostics)).collect()
}

fn quantity(raw: &RawQuantity, k: usize, diagnostics: &mut Diagnostics<'_>) -> Option<Quantity> {
    let path = format!("quantity.{k}");
    let name = raw.of.clone()?;
    if !Of::NAMES.iter().any(|(own, _)| *own == name) {
        is_column(&name, &format!("{path}.of"), diagnostics)?;
    }
    let of = Of::named(&name);
    let at = match &raw.at {
        Some(_) if of.is_of_sweeps() => {
            let diagnostic = Diagnostic::error(format!("`{path}.at` has no meaning for \"{name}\""));
            let help = "a value at a frequency is that of a column: of = \"fundamental_m\", at = { frequency_hz = … }";
            diagnostics.put(&format!("{path}.at"), diagnostic.help(help), "expected to be left out");
            return None;
        }
        Some(written) => place(written, &format!("{path}.at"), diagnostics)?,
        None if of.is_of_sweeps() || Of::NAMES.iter().any(|(own, _)| *own == name) => Place::Max,
        None => {
            let diagnostic = Diagnostic::error(format!("`{path}.at` is missing"));
            diagnostics.put(&path, diagnostic, EXPECTED);
            return None;
        }
    };
    let response = Selected { response: raw.response.map(|number| number as usize), level: raw.level };
    let limit = match (raw.at_most, raw.at_least) {
        (Some(_), Some(_)) => {
            let diagnostic = Diagnostic::error(format!("`{path}` has a limit above and one below"));
            let help = "two quantities with different names may be of the same";
            diagnostics.put(&format!("{path}.at_least"), diagnostic.help(help), "expected one of at_most, at_least");
            return None;
        }
        (most, least) => most.map(Limit::AtMost).or(least.map(Limit::AtLeast)),
    };
    Some(Quantity { name: raw.name.clone()?, of, at, response, limit })
}

/// Numerical columns of a branch, and of responses.
fn columns() -> impl Iterator<Item = &'static str> {
    let all = BranchRow::COLUMNS.iter().zip(BranchRow::TEXTS);
    let all = all.chain(ResponseRow::COLUMNS.iter().zip(ResponseRow::TEXTS));
    let names = all.filter(|(_, is_text)| !**is_text).map(|(column, _)| column.name);
    std::iter::once(ENERGY_RATIO).chain(names.filter(|name| has_numbers(name)))
}

fn is_column(name: &str, path: &str, diagnostics: &mut Diagnostics<'_>) -> Option<()> {
    if columns().any(|column| column == name) {
        return Some(());
    }
    let diagnostic = Diagnostic::error(format!("a branch has no column `{name}` with numbers"));
    let (diagnostic, label) = match nearest(name, columns()) {
        Some(column) => (diagnostic, format!("did you mean \"{column}\"?")),
        None => (
            diagnostic.help(format!("columns: {}", columns().collect::<Vec<_>>().join(", "))),
            "expected a column of branch.csv".into(),
        ),
    };
    diagnostics.put(path, diagnostic, label);
    None
}

fn place(raw: &Value, path: &str, diagnostics: &mut Diagnostics<'_>) -> Option<Place> {
    match raw {
        Value::String(text) => named(text, path, diagnostics),
        Value::Object(entries) if entries.len() == 1 => {
            let (name, value) = entries.iter().next()?;
            if name == "event" && value.is_string() {
                return named(value.as_str()?, path, diagnostics);
            }
            is_column(name, &format!("{path}.{name}"), diagnostics)?;
            let Some(value) = value.as_f64() else {
                let diagnostic = Diagnostic::error(format!("`{path}.{name}` is not a number"));
                diagnostics.put(&format!("{path}.{name}"), diagnostic, "expected a number");
                return None;
            };
            Some(Place::Column { name: name.clone(), value })
        }
        _ => {
            diagnostics.put(path, Diagnostic::error(format!("`{path}` is no place on a branch")), EXPECTED);
            None
        }
    }
}

fn named(text: &str, path: &str, diagnostics: &mut Diagnostics<'_>) -> Option<Place> {
    match text {
        "first" => return Some(Place::First),
        "last" => return Some(Place::Last),
        "max" => return Some(Place::Max),
        "min" => return Some(Place::Min),
        _ => {}
    }
    if let Some(event) = Event::from_name(text) {
        return Some(Place::Event(event));
    }
    let diagnostic = Diagnostic::error(format!("`{path}` cannot be \"{text}\""));
    let diagnostic = match nearest(text, Event::ALL.map(Event::name).into_iter().chain(["first", "last", "max", "min"]))
    {
        Some(known) => diagnostic.help(format!("did you mean \"{known}\"?")),
        None => diagnostic.help(format!("events: {}", Event::ALL.map(Event::name).join(", "))),
    };
    diagnostics.put(path, diagnostic, EXPECTED);
    None
}

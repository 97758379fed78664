//! `--set key=value`: one value of a scene replaced from the command line.

use std::borrow::Cow;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use crate::units::is_same_quantity;
use crate::{Diagnostic, Sources};

/// Prefix of the argument in messages.
const LEAD: &str = "--set ";
/// The table of which there may be one, `[response]`, or a list, `[[response]]`.
const LISTED: &str = "response";

/// A part of a dotted path, and its position.
type Segment<'a> = (&'a str, Range<usize>);
/// A key and its value.
type Entry<'a> = (Spanned<Cow<'a, str>>, Item<'a>);
/// A value.
type Item<'a> = Spanned<DeValue<'a>>;

/// Puts the value of `key=value` into the table. The key is a dotted path; items of arrays go by number, from 0.
///
/// # Errors
/// A [`Diagnostic`] that points at the argument if it is not of this form or the path leads nowhere.
pub fn apply<'a>(argument: &'a str, root: &mut DeTable<'a>, sources: &mut Sources) -> Result<(), Diagnostic> {
    let start = sources.add_argument(format!("{LEAD}{argument}")) + LEAD.len();
    let whole = start..start + argument.len();
    let Some((key, text)) = argument.split_once('=') else {
        return Err(form("there is no `=`", whole));
    };
    let path = segments(key, start);
    if let Some((_, range)) = path.iter().find(|(name, _)| name.is_empty()) {
        return Err(form("there is a name missing here", range.clone()));
    }
    let value = read_value(text, start + key.len() + 1)?;
    insert(root, &path, 0, value)
}

fn form(label: &str, range: Range<usize>) -> Diagnostic {
    Diagnostic::error("`--set` needs a key and a value")
        .at(range, label)
        .help("write it like --set method.harmonics=5 or --set contact.0.gap_m=1e-3")
}

fn segments(key: &str, start: usize) -> Vec<Segment<'_>> {
    let mut at = start;
    key.split('.')
        .map(|part| {
            let from = at + (part.len() - part.trim_start().len());
            at += part.len() + 1;
            (part.trim(), from..from + part.trim().len())
        })
        .collect()
}

/// The value as TOML; a bare word is taken as text.
fn read_value(text: &str, start: usize) -> Result<Item<'_>, Diagnostic> {
    let from = start + (text.len() - text.trim_start().len());
    let text = text.trim();
    let whole = from..from + text.len();
    if text.is_empty() {
        return Err(form("there is no value behind `=`", whole.start.saturating_sub(1)..whole.end));
    }
    match DeValue::parse(text) {
        Ok(value) => Ok(shifted(value, from)),
        Err(error) if text.starts_with(['[', '{', '"', '\'']) => {
            Err(Diagnostic::error("the value of `--set` is not TOML").at(whole, error.message()))
        }
        Err(_) => Ok(Spanned::new(whole, DeValue::String(Cow::Borrowed(text)))),
    }
}

/// Puts the value at the path below the table. `depth` parts of the path lead to the table.
fn insert<'a>(table: &mut DeTable<'a>, path: &[Segment<'a>], depth: usize, value: Item<'a>) -> Result<(), Diagnostic> {
    let Some((name, range)) = path.get(depth) else { return Ok(()) };
    let key = Spanned::new(range.clone(), Cow::Borrowed(*name));
    if depth + 1 == path.len() {
        // The same in another unit is replaced too.
        let others = table.keys().map(|other| other.get_ref().to_string());
        let replaced: Vec<String> = others.filter(|other| other == name || is_same_quantity(name, other)).collect();
        replaced.iter().for_each(|other| _ = table.remove(other.as_str()));
        table.insert(key, value);
        return Ok(());
    }
    if !table.contains_key(*name) {
        table.insert(key, Spanned::new(range.clone(), DeValue::Table(DeTable::new())));
    }
    match table.get_mut(*name) {
        Some(next) => insert_into(next, path, depth + 1, value),
        None => Ok(()),
    }
}

fn insert_into<'a>(node: &mut Item<'a>, path: &[Segment<'a>], depth: usize, value: Item<'a>) -> Result<(), Diagnostic> {
    let is_only = |own: &[Segment<'a>]| own.first().is_some_and(|(name, _)| *name == LISTED) && depth == 1;
    match node.get_mut() {
        // The only one of several goes with its number and without.
        DeValue::Table(table) if is_only(path) && path.len() > 2 && path[1].0 == "0" => insert(table, path, 2, value),
        DeValue::Array(items) if is_only(path) && items.len() == 1 && path[1].0.parse::<usize>().is_err() => {
            match items.get_mut(0) {
                Some(item) => insert_into_only(item, path, value),
                None => Ok(()),
            }
        }
        DeValue::Table(table) => insert(table, path, depth, value),
        DeValue::Array(items) => insert_item(items, path, depth, value),
        _ => Err(below_a_single_value(path, depth)),
    }
}

/// Into the only table of a list, which the path leaves out.
fn insert_into_only<'a>(item: &mut Item<'a>, path: &[Segment<'a>], value: Item<'a>) -> Result<(), Diagnostic> {
    match item.get_mut() {
        DeValue::Table(table) => insert(table, path, 1, value),
        _ => Err(below_a_single_value(path, 1)),
    }
}

fn insert_item<'a>(
    items: &mut DeArray<'a>,
    path: &[Segment<'a>],
    depth: usize,
    value: Item<'a>,
) -> Result<(), Diagnostic> {
    let n = items.len();
    let number = path.get(depth).and_then(|(name, _)| name.parse::<usize>().ok());
    match number.and_then(|i| items.get_mut(i)) {
        Some(item) if depth + 1 == path.len() => *item = value,
        Some(item) => return insert_into(item, path, depth + 1, value),
        None => return Err(no_such_item(path, depth, n)),
    }
    Ok(())
}

/// The first parts of the path, as text, and the range of the one after them.
fn split(path: &[Segment], depth: usize) -> (String, Range<usize>) {
    let names: Vec<&str> = path.iter().take(depth).map(|(name, _)| *name).collect();
    (names.join("."), path.get(depth).map_or(0..0, |(_, range)| range.clone()))
}

fn below_a_single_value(path: &[Segment], depth: usize) -> Diagnostic {
    let (above, range) = split(path, depth);
    Diagnostic::error(format!("`{above}` is a single value"))
        .at(range, format!("there is nothing inside `{above}` to set"))
}

fn no_such_item(path: &[Segment], depth: usize, n: usize) -> Diagnostic {
    let (above, range) = split(path, depth);
    let have = match n {
        0 => "it has none".to_owned(),
        1 => "it has one: number 0".to_owned(),
        n => format!("it has {n}, numbered 0 to {}", n - 1),
    };
    let name = path.get(depth).map_or("", |(name, _)| name);
    Diagnostic::error(format!("`{above}` has no item `{name}`"))
        .at(range, format!("expected the number of an item; {have}"))
}

/// The same value, moved along the common axis.
fn shifted(value: Item<'_>, by: usize) -> Item<'_> {
    let range = shift(&value.span(), by);
    let moved = match value.into_inner() {
        DeValue::Table(table) => DeValue::Table(table.into_iter().map(|entry| shifted_entry(entry, by)).collect()),
        DeValue::Array(items) => DeValue::Array(items.into_iter().map(|item| shifted(item, by)).collect()),
        single => single,
    };
    Spanned::new(range, moved)
}

fn shifted_entry<'a>((key, value): Entry<'a>, by: usize) -> Entry<'a> {
    let range = shift(&key.span(), by);
    (Spanned::new(range, key.into_inner()), shifted(value, by))
}

fn shift(range: &Range<usize>, by: usize) -> Range<usize> {
    range.start + by..range.end + by
}

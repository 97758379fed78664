//! `[response]` and `[[response]]`: two spellings of one thing; and what scenes with responses or a motion in time need
//! not say.

use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// Harmonics from which the number of modes follows where a motion in time has no `[method]`.
const HARMONICS_OF: &str = "harmonics = 10";

/// Adds the tables `[method]` and `[continuation]` where a scene of a motion in time has none: it has no use for them.
pub fn of_transient(root: &mut DeTable<'_>) {
    let Some(place) = root.get("transient").map(Spanned::span) else { return };
    if !root.contains_key("continuation") {
        let empty = Spanned::new(place.clone(), DeValue::Table(DeTable::new()));
        root.insert(Spanned::new(place.clone(), "continuation".into()), empty);
    }
    if !root.contains_key("method") {
        let Ok(method) = DeTable::parse(HARMONICS_OF) else { return };
        root.insert(
            Spanned::new(place.clone(), "method".into()),
            Spanned::new(place, DeValue::Table(method.into_inner())),
        );
    }
}

/// Makes a list of a single response, and adds the table `[continuation]` where there is none: responses have limits of
/// their own.
pub fn listed(root: &mut DeTable<'_>) {
    let Some(written) = root.get_mut("response") else { return };
    let place = written.span();
    if written.get_ref().is_table() {
        let mut list = DeArray::new();
        list.push(std::mem::replace(written, Spanned::new(place.clone(), DeValue::Boolean(false))));
        *written = Spanned::new(place.clone(), DeValue::Array(list));
    }
    if !root.contains_key("continuation") {
        let empty = Spanned::new(place.clone(), DeValue::Table(DeTable::new()));
        root.insert(Spanned::new(place, "continuation".into()), empty);
    }
}

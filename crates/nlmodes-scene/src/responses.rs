//! `[response]` and `[[response]]`: two spellings of one thing; and what scenes with responses or a motion in time need
//! not say.

use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// Adds the table `[continuation]` where a scene of a motion in time has none: it has no use for it.
pub fn of_transient(root: &mut DeTable<'_>) {
    let Some(place) = root.get("transient").map(Spanned::span) else { return };
    if !root.contains_key("continuation") {
        let empty = Spanned::new(place.clone(), DeValue::Table(DeTable::new()));
        root.insert(Spanned::new(place, "continuation".into()), empty);
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

//! `[response]` and `[[response]]`: two spellings of one thing.

use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// Makes a list of a single response.
pub fn listed(root: &mut DeTable<'_>) {
    let Some(written) = root.get_mut("response") else { return };
    let place = written.span();
    if written.get_ref().is_table() {
        let mut list = DeArray::new();
        list.push(std::mem::replace(written, Spanned::new(place.clone(), DeValue::Boolean(false))));
        *written = Spanned::new(place, DeValue::Array(list));
    }
}

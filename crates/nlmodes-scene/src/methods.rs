//! A scene with several methods, `[[method]]`: one scene for each, with the same places.

use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use crate::Diagnostic;

const KEY: &str = "method";

/// Most methods of a scene. Each is checked by itself, so that a hostile file with a million headings would take
/// forever.
pub const MAX_METHODS: usize = 100;

/// Number of methods of a scene: that of headings `[[method]]`, or 1.
pub fn count(root: &DeTable<'_>) -> usize {
    match root.get(KEY).map(Spanned::get_ref) {
        Some(DeValue::Array(items)) if are_tables(items) => items.len().min(MAX_METHODS),
        _ => 1,
    }
}

/// Leaves the method `number` of several as the only one.
///
/// # Errors
/// A [`Diagnostic`] if there are too many.
pub fn keep(root: &mut DeTable<'_>, number: usize) -> Result<(), Diagnostic> {
    let Some(tables) = tables(root) else { return Ok(()) };
    let too_many = tables.get(MAX_METHODS).map(|table| {
        Diagnostic::error(format!("the scene has {} methods", tables.len()))
            .at(table.span(), format!("expected at most {MAX_METHODS} headings [[method]]"))
    });
    let kept =
        tables.get_mut(number).map(|table| std::mem::replace(table, Spanned::new(0..0, DeValue::Boolean(false))));
    if let (Some(kept), Some(method)) = (kept, root.get_mut(KEY)) {
        *method = kept;
    }
    too_many.map_or(Ok(()), Err)
}

/// Whether an argument `key=value` is for one of several methods: `method.1.mode=2`.
pub fn is_for_one(argument: &str, root: &mut DeTable<'_>) -> bool {
    let key = argument.split_once('=').map_or(argument, |(key, _)| key);
    let mut parts = key.split('.').map(str::trim);
    let numbered = parts.next() == Some(KEY) && parts.next().is_some_and(|part| part.parse::<usize>().is_ok());
    numbered && tables(root).is_some()
}

/// The methods, if they are a list of tables.
fn tables<'t, 'd>(root: &'t mut DeTable<'d>) -> Option<&'t mut DeArray<'d>> {
    match root.get_mut(KEY)?.get_mut() {
        DeValue::Array(items) if are_tables(items) => Some(items),
        _ => None,
    }
}

fn are_tables(items: &DeArray<'_>) -> bool {
    !items.is_empty() && items.iter().all(|item| item.get_ref().is_table())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count_in(text: &str) -> usize {
        count(DeTable::parse_recoverable(text).0.get_ref())
    }

    const TEXT: &str = "a = '''\n[[method]]\n'''\n[[ method ]] # first\nkind = \"ms-hbm\" # é\n\n[[method]]\nkind \
        = \"hbm\"\n[output]\nb = 2\n";

    #[test]
    fn each_method_has_a_scene_with_the_same_places() {
        assert_eq!(count_in(TEXT), 2);
        for (number, kind) in ["ms-hbm", "hbm"].into_iter().enumerate() {
            let (mut root, errors) = DeTable::parse_recoverable(TEXT);
            assert!(errors.is_empty());
            keep(root.get_mut(), number).unwrap();
            let DeValue::Table(method) = root.get_ref()["method"].get_ref() else { panic!("no table") };
            assert_eq!(&TEXT[method["kind"].span()], format!("\"{kind}\""));
            assert_eq!(method.len(), 1);
            assert_eq!(root.get_ref().len(), 3);
        }
    }

    #[test]
    fn a_scene_with_one_method_is_itself() {
        for text in ["[method]\nkind = \"hbm\"\n", "method = []", "method = [1]", "a = 1"] {
            assert_eq!(count_in(text), 1);
            let (mut root, _) = DeTable::parse_recoverable(text);
            keep(root.get_mut(), 0).unwrap();
            let before = DeTable::parse_recoverable(text).0;
            assert_eq!(format!("{root:?}"), format!("{before:?}"));
        }
    }

    #[test]
    fn a_million_methods_are_too_many() {
        let text = "[[method]]\n".repeat(MAX_METHODS + 1);
        assert_eq!(count_in(&text), MAX_METHODS);
        assert!(keep(DeTable::parse_recoverable(&text).0.get_mut(), 0).is_err());
    }
}

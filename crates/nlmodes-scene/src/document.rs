//! A scene as TOML, with the place of each key.

use std::collections::BTreeMap;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::text::Text;
use crate::units::Spelling;
use crate::{Diagnostic, Sources, methods, responses, set};

/// The texts of a scene, with the place of each key.
#[derive(Debug, Clone)]
pub struct Document {
    sources: Sources,
    places: BTreeMap<String, KeyPlace>,
    spelled: BTreeMap<String, Spelling>,
}

/// Position of a key and its value, on the common axis of the [`Sources`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyPlace {
    /// The key, or its alias.
    pub key: Range<usize>,
    /// The value; of a table, its heading.
    pub value: Range<usize>,
}

impl Document {
    /// Takes the tables of the text and applies the overrides `key=value`. Of several methods, `[[method]]`, the one
    /// with this number is left as the only one, `[method]`. What is wrong goes to `diagnostics`; there is no table if
    /// the text is not TOML.
    pub(crate) fn new<'a>(
        text: &Text<'a>,
        overrides: &'a [String],
        method: usize,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> (Self, Option<Spanned<DeTable<'a>>>) {
        let mut root = text.root.clone();
        diagnostics.extend(crate::syntax::problems(text.text, &text.errors));
        let mut sources = Sources::new(text.name, text.text);
        // `method.1.mode=2` is for one of several methods, `method.mode=2` for all of them.
        let (of_one, of_all): (Vec<_>, Vec<_>) =
            overrides.iter().partition(|argument| methods::is_for_one(argument, root.get_mut()));
        for argument in of_one {
            diagnostics.extend(set::apply(argument, root.get_mut(), &mut sources).err());
        }
        diagnostics.extend(methods::keep(root.get_mut(), method).err());
        for argument in of_all {
            diagnostics.extend(set::apply(argument, root.get_mut(), &mut sources).err());
        }
        responses::listed(root.get_mut());
        let mut places = BTreeMap::new();
        index(root.get_ref(), "", &mut places);
        (Self { sources, places, spelled: BTreeMap::new() }, text.errors.is_empty().then_some(root))
    }

    /// Without a text: of a scene that results were left of.
    pub(crate) fn empty(name: &str) -> Self {
        Self { sources: Sources::new(name, ""), places: BTreeMap::new(), spelled: BTreeMap::new() }
    }

    /// The same, in which keys that are written in other units are found by the names of the schema too.
    pub(crate) fn with_spellings(mut self, spelled: BTreeMap<String, Spelling>) -> Self {
        self.spelled = spelled;
        self
    }

    /// The spelling of a key, or of the list that it is an item of.
    fn spelling<'a>(&'a self, path: &'a str) -> Option<(&'a Spelling, Option<&'a str>)> {
        let whole = self.spelled.get(path).map(|spelling| (spelling, None));
        let item = || path.rsplit_once('.').and_then(|(list, item)| Some((self.spelled.get(list)?, Some(item))));
        whole.or_else(item)
    }

    /// A number that is written at a key, in the unit of the schema.
    pub fn in_schema_unit(&self, path: &str, written: f64) -> f64 {
        self.spelling(path).map_or(written, |(spelling, _)| spelling.factor.apply(written))
    }

    /// A number in the unit of the schema, formatted for a key.
    pub fn in_written_unit(&self, path: &str, value: f64) -> f64 {
        self.spelling(path).map_or(value, |(spelling, _)| spelling.factor.undo(value))
    }

    /// The texts.
    pub fn sources(&self) -> &Sources {
        &self.sources
    }

    /// Position of the key of the path, for instance `contact.0.gap_m`.
    pub fn place(&self, path: &str) -> Option<&KeyPlace> {
        let spelled = || match self.spelling(path)? {
            (spelling, None) => self.places.get(&spelling.key),
            (spelling, Some(item)) => self.places.get(&format!("{}.{item}", spelling.key)),
        };
        self.places.get(path).or_else(spelled)
    }

    /// The paths of all keys that are written, as `contact.0.gap_m`.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.places.keys().map(String::as_str)
    }

    /// The path of the key that a diagnostic is about, as `contact.0.gap_m`: the innermost one around its place.
    pub fn key_of(&self, diagnostic: &Diagnostic) -> Option<&str> {
        let at = diagnostic.place.as_ref()?.range.start;
        let around = |(path, place): (&'_ String, &'_ KeyPlace)| {
            let length =
                [&place.key, &place.value].into_iter().filter(|range| range.contains(&at)).map(|r| r.len()).min();
            length.map(|length| (length, std::cmp::Reverse(path.len())))
        };
        let found = self.places.iter().filter_map(|entry| Some((around(entry)?, entry.0)));
        found.min().map(|(_, path)| path.as_str())
    }

    /// The line of the file that a diagnostic is about, from 1; nothing where it is about an override.
    pub fn line_of(&self, diagnostic: &Diagnostic) -> Option<usize> {
        let (file, range) = (self.sources.file(), &diagnostic.place.as_ref()?.range);
        let (source, range) = self.sources.locate(range);
        let before = file.text.get(..range.start).filter(|_| std::ptr::eq(source, file))?;
        Some(1 + before.bytes().filter(|byte| *byte == b'\n').count())
    }

    /// The value at a path as written.
    pub fn written(&self, path: &str) -> String {
        self.place(path).map_or_else(String::new, |place| self.sources.excerpt(&place.value))
    }

    /// Puts a diagnostic at the value of the key, or at the heading of the nearest table around it that is written.
    pub fn put(&self, diagnostic: Diagnostic, path: &str, label: impl Into<String>) -> Diagnostic {
        let around = std::iter::successors(Some(path), |path| path.rsplit_once('.').map(|(parent, _)| parent));
        match around.filter_map(|path| self.place(path)).next() {
            Some(place) => diagnostic.at(place.value.clone(), label),
            None => diagnostic,
        }
    }

    /// Diagnostics of this document as text.
    pub fn render(&self, diagnostics: &[Diagnostic], colours: bool) -> String {
        crate::render::render(diagnostics, &self.sources, colours)
    }
}

fn index(table: &DeTable<'_>, prefix: &str, places: &mut BTreeMap<String, KeyPlace>) {
    for (key, value) in table {
        index_value(key.span(), value, format!("{prefix}{}", key.get_ref()), places);
    }
}

fn index_value(key: Range<usize>, value: &Spanned<DeValue<'_>>, path: String, places: &mut BTreeMap<String, KeyPlace>) {
    match value.get_ref() {
        DeValue::Table(table) => index(table, &format!("{path}."), places),
        DeValue::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                index_value(item.span(), item, format!("{path}.{i}"), places);
            }
        }
        _ => {}
    }
    places.insert(path, KeyPlace { key, value: value.span() });
}

#[cfg(test)]
mod tests {

    #[test]
    fn problems_have_the_innermost_key_and_the_line_of_the_file() {
        let text = "[structure]\nkind = \"rod\"\n[[contact]]\ngap_inch = 1\n[[contact]]\ngap_m = \"a\"\n";
        let refused = crate::parse("a.toml", text, &["method.harmonics=-1".to_owned()]).unwrap_err();
        let document = refused.document();
        let places: Vec<_> = refused.diagnostics().iter().map(|p| (document.key_of(p), document.line_of(p))).collect();
        for place in [
            (Some("contact.0.gap_inch"), Some(4)),
            (Some("contact.1.gap_m"), Some(6)),
            (Some("method.harmonics"), None),
            (Some("structure"), Some(1)),
        ] {
            assert!(places.contains(&place), "{place:?} in {places:?}");
        }
    }
}

//! A scene as TOML, with the place of each key.

use std::collections::BTreeMap;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::text::Text;
use crate::units::converted;
use crate::{Diagnostic, Sources, methods, responses, set};

/// Most syntax errors that are shown: one slip often makes the rest of the text look wrong too.
const MAX_SYNTAX_ERRORS: usize = 3;

/// The texts of a scene, with the place of each key.
#[derive(Debug, Clone)]
pub struct Document {
    sources: Sources,
    places: BTreeMap<String, KeyPlace>,
}

/// Where a key and its value stand, on the common axis of the [`Sources`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyPlace {
    /// The key, or what stands for it.
    pub key: Range<usize>,
    /// The value; of a table, its heading.
    pub value: Range<usize>,
}

impl Document {
    /// Takes the tables of the text and applies the overrides `key=value`. Of several methods, `[[method]]`, the one with this number
    /// is left as the only one, `[method]`. What is wrong goes to `diagnostics`; there is no table if the text is not TOML.
    pub(crate) fn new<'a>(
        text: &Text<'a>,
        overrides: &'a [String],
        method: usize,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> (Self, Option<Spanned<DeTable<'a>>>) {
        let mut root = text.root.clone();
        diagnostics.extend(syntax_problems(text.text, &text.errors));
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
        (Self { sources, places }, text.errors.is_empty().then_some(root))
    }

    /// Without a text: of a scene that results were left of.
    pub(crate) fn empty(name: &str) -> Self {
        Self { sources: Sources::new(name, ""), places: BTreeMap::new() }
    }

    /// The texts.
    pub fn sources(&self) -> &Sources {
        &self.sources
    }

    /// Where the key of the path stands, as `contact.0.gap_m`.
    pub fn place(&self, path: &str) -> Option<&KeyPlace> {
        self.places.get(path)
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

    /// The value at a path as it is written.
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

/// The first syntax errors, at most one a line.
fn syntax_problems(text: &str, errors: &[toml::de::Error]) -> Vec<Diagnostic> {
    let place = |error: &toml::de::Error| error.span().unwrap_or(text.len()..text.len());
    let line = |error: &toml::de::Error| text.bytes().take(place(error).start).filter(|byte| *byte == b'\n').count();
    let mut shown: Vec<&toml::de::Error> = Vec::new();
    for error in errors {
        if shown.last().is_none_or(|last| line(last) != line(error)) {
            shown.push(error);
        }
    }
    let more = shown.len().saturating_sub(MAX_SYNTAX_ERRORS);
    shown.truncate(MAX_SYNTAX_ERRORS);
    let mut diagnostics: Vec<Diagnostic> =
        shown.iter().map(|error| syntax_problem(text, error.message(), place(error))).collect();
    if more > 0
        && let Some(last) = diagnostics.last_mut()
    {
        last.help.push("the lines that follow cannot be read either; mend these first".into());
    }
    diagnostics
}

fn syntax_problem(text: &str, message: &str, place: Range<usize>) -> Diagnostic {
    if let Some(number) = decimal_comma(text, place.start) {
        return Diagnostic::error("a number is written with a decimal comma")
            .at(place, "expected a decimal point")
            .help(format!("write {number}"));
    }
    if let Some((key, value)) = number_with_unit(text, place.start) {
        return Diagnostic::error(format!("`{key}` is a number with a unit behind it"))
            .at(place, "expected the end of the line")
            .help(format!("write {key} = {value}; the unit is part of the key"));
    }
    let title = match message {
        "duplicate key" => "a key is given twice in the same table",
        _ => "the scene is not valid TOML",
    };
    let diagnostic = Diagnostic::error(title).at(place.clone(), message);
    match message {
        _ if message.contains("must be quoted") => {
            let (key, value) = bare_word(text, place.start).unwrap_or(("kind", "rod"));
            diagnostic.help(format!("texts stand in quotes: {key} = \"{value}\""))
        }
        _ if message.contains("array") => {
            diagnostic.help("a list stands in square brackets: [50.0, 66.5]; is one not closed?")
        }
        _ => diagnostic,
    }
}

/// The key of the line, and the text behind it that stands without quotes.
fn bare_word(text: &str, at: usize) -> Option<(&str, &str)> {
    let start = text.get(..at)?.rfind('\n').map_or(0, |end| end + 1);
    let (key, value) = text.get(start..)?.lines().next()?.split('#').next()?.split_once('=')?;
    let (key, value) = (key.trim(), value.trim());
    (!key.is_empty() && !value.is_empty() && !value.contains(['"', '\\', '[', '{', ','])).then_some((key, value))
}

/// The key of the line, and what to write for its value, where that is a number with a unit behind it.
fn number_with_unit(text: &str, at: usize) -> Option<(&str, String)> {
    let start = text.get(..at)?.rfind('\n').map_or(0, |end| end + 1);
    let line = text.get(start..)?.lines().next()?;
    let (key, value) = line.split('#').next()?.split_once('=')?;
    let key = key.trim();
    Some((key, converted(key, value.trim())?))
}

/// The number around a comma between digits, with a point.
fn decimal_comma(text: &str, at: usize) -> Option<String> {
    let behind = text.get(at..)?.strip_prefix(',')?;
    let is_part = |c: &char| c.is_ascii_digit() || *c == '_';
    let whole: String = text.get(..at)?.chars().rev().take_while(is_part).collect();
    let decimals: String = behind.chars().take_while(is_part).collect();
    let number =
        format!("{}.{decimals}{}", whole.chars().rev().collect::<String>(), exponent(&behind[decimals.len()..]));
    (!whole.is_empty() && !decimals.is_empty()).then_some(number)
}

/// The power of ten with which the text begins, as `e-3`; nothing if there is none.
fn exponent(text: &str) -> &str {
    let Some(power) = text.strip_prefix(['e', 'E']) else { return "" };
    let signed = power.strip_prefix(['+', '-']).unwrap_or(power);
    let digits = signed.chars().take_while(char::is_ascii_digit).count();
    if digits == 0 { "" } else { &text[..text.len() - signed.len() + digits] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decimal_comma_keeps_sign_and_size() {
        let number = |text: &str| decimal_comma(text, text.find(',').unwrap_or(0));
        assert_eq!(number("gap_m = 1,5e-3").as_deref(), Some("1.5e-3"));
        assert_eq!(number("gap_m = 1,0E+2 # m").as_deref(), Some("1.0E+2"));
        assert_eq!(number("gap_m = 20,25").as_deref(), Some("20.25"));
        assert_eq!(number("gap_m = 1,5e").as_deref(), Some("1.5"));
        assert_eq!(number("a = [1, 2]"), None);
    }

    #[test]
    fn problems_have_the_innermost_key_and_the_line_of_the_file() {
        let text = "[structure]\nkind = \"rod\"\n[[contact]]\ngap_mm = 1\n[[contact]]\ngap_m = \"a\"\n";
        let refused = crate::parse("a.toml", text, &["method.harmonics=-1".to_owned()]).unwrap_err();
        let document = refused.document();
        let places: Vec<_> = refused.diagnostics().iter().map(|p| (document.key_of(p), document.line_of(p))).collect();
        for place in [
            (Some("contact.0.gap_mm"), Some(4)),
            (Some("contact.1.gap_m"), Some(6)),
            (Some("method.harmonics"), None),
            (Some("structure"), Some(1)),
            (None, None),
        ] {
            assert!(places.contains(&place), "{place:?} in {places:?}");
        }
    }
}

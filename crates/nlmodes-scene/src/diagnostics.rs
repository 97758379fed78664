//! The diagnostics of one scene, as they are found.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use crate::units::Spelling;
use crate::{Diagnostic, Document, Severity, diagnostic};

/// The diagnostics of one scene, as they are found.
#[derive(Debug)]
pub struct Diagnostics<'a> {
    document: &'a Document,
    diagnostics: Vec<Diagnostic>,
    meant: BTreeSet<String>,
    spelled: BTreeMap<String, Spelling>,
    body: Option<usize>,
}

impl<'a> Diagnostics<'a> {
    /// Begins with what was found before.
    pub fn new(document: &'a Document, diagnostics: Vec<Diagnostic>) -> Self {
        Self { document, diagnostics, meant: BTreeSet::new(), spelled: BTreeMap::new(), body: None }
    }

    /// The texts.
    pub fn document(&self) -> &'a Document {
        self.document
    }

    /// Says which structure of several (from 0) the key `structure` and those below it are about from here on; none
    /// where there is one.
    pub fn about_structure(&mut self, body: Option<usize>) {
        self.body = body;
    }

    /// The structure of several that is being looked at.
    pub fn structure(&self) -> Option<usize> {
        self.body
    }

    /// The path of a key as the file writes it, where that is in another unit than the schema has.
    pub(crate) fn as_written(&self, path: &str) -> String {
        let item = path.rsplit_once('.').and_then(|(list, item)| Some((self.spelled.get(list)?, item)));
        let item = item.map(|(spelling, item)| format!("{}.{item}", spelling.key));
        self.spelled.get(path).map(|spelling| spelling.key.clone()).or(item).unwrap_or_else(|| path.to_owned())
    }

    /// The unit in which a number is written, where that is another one than the schema has.
    fn unit(&self, path: &str) -> Option<&'static str> {
        let list = path.rsplit_once('.').map_or(path, |(list, _)| list);
        self.spelled.get(path).or_else(|| self.spelled.get(list)).map(|spelling| spelling.unit)
    }

    /// Takes note that a key is written in another unit than the schema has; both are paths.
    pub(crate) fn spell(&mut self, path: String, spelling: Spelling) {
        self.spelled.insert(path, spelling);
    }

    /// The texts, in which keys in other units are found by the names that the schema has.
    pub(crate) fn spelled_document(&self) -> Document {
        self.document.clone().with_spellings(self.spelled.clone())
    }

    /// The path of a key in the file.
    fn in_file<'p>(&self, path: &'p str) -> Cow<'p, str> {
        let path = self.of_body(path);
        if self.spelled.is_empty() { path } else { Cow::Owned(self.as_written(&path)) }
    }

    /// The path of a key of the structure that is spoken of.
    fn of_body<'p>(&self, path: &'p str) -> Cow<'p, str> {
        match (self.body, path.strip_prefix("structure")) {
            (Some(body), Some(rest)) if rest.is_empty() || rest.starts_with('.') => {
                Cow::Owned(format!("structure.{body}{rest}"))
            }
            _ => Cow::Borrowed(path),
        }
    }

    /// The text with the paths that it names as they are in the file.
    fn named(&self, text: String) -> String {
        match self.body {
            Some(body) => text.replace("`structure.", &format!("`structure.{body}.")),
            None => text,
        }
    }

    /// Position of the key of the path.
    pub fn place(&self, path: &str) -> Option<&'a crate::KeyPlace> {
        self.document.place(&self.in_file(path))
    }

    /// Adds a diagnostic at its place or nowhere.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// Adds a diagnostic at the value of a key.
    pub fn put(&mut self, path: &str, diagnostic: Diagnostic, label: impl Into<String>) {
        let (own, written) = (self.of_body(path), self.in_file(path));
        let title = self.named(diagnostic.title).replace(&format!("`{own}`"), &format!("`{written}`"));
        let diagnostic = Diagnostic { title, ..diagnostic };
        self.diagnostics.push(self.document.put(diagnostic, &self.in_file(path), label));
    }

    /// Whether the scene writes this key.
    pub fn has(&self, path: &str) -> bool {
        self.document.place(&self.in_file(path)).is_some()
    }

    /// Whether a key at this path was misspelt.
    pub fn is_meant(&self, path: &str) -> bool {
        self.meant.contains(path)
    }

    /// Takes note that an unknown key was probably meant to be this one.
    pub fn mean(&mut self, path: String) {
        self.meant.insert(path);
    }

    /// Says the diagnostics so far in other words.
    pub(crate) fn reword(&mut self, reworded: impl Fn(Diagnostic) -> Diagnostic) {
        self.diagnostics = std::mem::take(&mut self.diagnostics).into_iter().map(reworded).collect();
    }

    /// Number of diagnostics so far.
    pub fn count(&self) -> usize {
        self.diagnostics.len()
    }

    /// The value of a key as the scene writes it.
    pub fn written(&self, path: &str) -> String {
        let number = self.document.written(&self.in_file(path));
        self.unit(&self.of_body(path)).map_or(number.clone(), |unit| format!("{number} {unit}"))
    }

    /// Whether the scene is refused.
    pub fn refuse(&self) -> bool {
        self.diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
    }

    /// Each of them once, in the order of the text, errors before warnings.
    pub fn into_sorted(self) -> Vec<Diagnostic> {
        diagnostic::each_once(self.diagnostics)
    }
}

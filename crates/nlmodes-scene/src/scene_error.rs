//! A scene that is rejected, by its checks or later.

use std::fmt;

use crate::{Diagnostic, Document, Severity};

/// What is wrong with a scene, each thing at its place.
#[derive(Debug, Clone)]
pub struct SceneError {
    /// In a box: results that carry an error stay small.
    content: Box<Content>,
}

#[derive(Debug, Clone)]
struct Content {
    document: Document,
    diagnostics: Vec<Diagnostic>,
    last: Option<String>,
}

impl SceneError {
    /// What a computation finds wrong with the scene in these texts.
    pub(crate) fn new(document: Document, diagnostic: Diagnostic) -> Self {
        Self { content: Box::new(Content { document, diagnostics: vec![diagnostic], last: None }) }
    }

    /// What the checks of a scene found, with a last line that sums it up.
    pub(crate) fn of_checks(document: Document, diagnostics: Vec<Diagnostic>) -> Self {
        let last = format!("{}: nothing was computed or written", count(&document, &diagnostics));
        Self { content: Box::new(Content { document, diagnostics, last: Some(last) }) }
    }

    /// With what else is wrong with the same scene.
    #[must_use]
    pub fn with(mut self, other: Self) -> Self {
        self.content.diagnostics.extend(other.content.diagnostics);
        self
    }

    /// The texts and their errors.
    pub(crate) fn into_parts(self) -> (Document, Vec<Diagnostic>) {
        (self.content.document, self.content.diagnostics)
    }

    /// Followed by a line.
    pub(crate) fn with_last_line(mut self, line: &str) -> Self {
        self.content.last = Some(line.to_owned());
        self
    }

    /// Errors and warnings.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.content.diagnostics
    }

    /// Errors without warnings.
    pub fn errors(&self) -> impl Iterator<Item = &Diagnostic> {
        self.diagnostics().iter().filter(|diagnostic| diagnostic.severity == Severity::Error)
    }

    /// All of it in one line, without places.
    pub fn sentence(&self) -> String {
        self.errors().map(Diagnostic::sentence).collect::<Vec<_>>().join(" | ")
    }

    /// The texts that they are about.
    pub fn document(&self) -> &Document {
        &self.content.document
    }

    /// The same as text, with the lines that it is about.
    pub fn text(&self, colours: bool) -> String {
        let text = self.document().render(self.diagnostics(), colours);
        self.content.last.as_ref().map_or_else(|| text.clone(), |line| format!("{text}\n\n{line}"))
    }
}

/// How many errors there are, in the file and in which `--set`: `2 errors in rod.toml, 1 in --set method.mode=a`.
fn count(document: &Document, diagnostics: &[Diagnostic]) -> String {
    let (sources, mut places) = (document.sources(), Vec::<(String, usize)>::new());
    for error in diagnostics.iter().filter(|diagnostic| diagnostic.severity == Severity::Error) {
        let source = error.place.as_ref().map_or(sources.file(), |place| sources.locate(&place.range).0);
        let is_file = std::ptr::eq(source, sources.file());
        let name = if is_file { &source.name } else { &source.text };
        match places.iter_mut().find(|(known, _)| known == name) {
            Some((_, count)) => *count += 1,
            None => places.push((name.clone(), 1)),
        }
    }
    let first = places.first().map_or(0, |(_, count)| *count);
    let word = if first == 1 { "error " } else { "errors " };
    let places: Vec<String> = places.iter().map(|(name, count)| format!("{count} in {name}")).collect();
    places.join(", ").replacen(' ', &format!(" {word}"), 1)
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(false))
    }
}

impl std::error::Error for SceneError {}

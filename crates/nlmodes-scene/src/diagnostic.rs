//! Something wrong with a scene, and where.

use std::collections::HashSet;
use std::ops::Range;

/// Whether the scene is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// It is refused.
    Error,
    /// It is accepted, but looks wrong.
    Warning,
}

/// Something wrong with a scene, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// Whether the scene is refused.
    pub severity: Severity,
    /// What is wrong, with the full path of the key.
    pub title: String,
    /// Position, with the value found and the expected one; empty if the file could not be read.
    pub place: Option<Mark>,
    /// Other places that have to do with it.
    pub context: Vec<Mark>,
    /// What to do about it.
    pub help: Vec<String>,
}

/// A position in the texts of a scene, and its label.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mark {
    /// Range on the common axis of [`Sources`](crate::Sources).
    pub range: Range<usize>,
    /// Its label.
    pub label: String,
}

impl Diagnostic {
    /// An error, so far without a place.
    pub fn error(title: impl Into<String>) -> Self {
        Self { severity: Severity::Error, title: title.into(), place: None, context: Vec::new(), help: Vec::new() }
    }

    /// A warning, so far without a place.
    pub fn warning(title: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(title) }
    }

    /// Puts it at a place.
    #[must_use]
    pub fn at(mut self, range: Range<usize>, label: impl Into<String>) -> Self {
        self.place = Some(Mark { range, label: label.into() });
        self
    }

    /// Adds another place that has to do with it.
    #[must_use]
    pub fn with(mut self, range: Range<usize>, label: impl Into<String>) -> Self {
        self.context.push(Mark { range, label: label.into() });
        self
    }

    /// Adds what to do about it.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help.push(help.into());
        self
    }
}

impl Diagnostic {
    /// In one line without position: the error, the value found, what to do.
    pub fn sentence(&self) -> String {
        let label = self.place.as_ref().map(|mark| mark.label.as_str()).filter(|label| !label.is_empty());
        let head = [Some(self.title.as_str()), label].into_iter().flatten().collect::<Vec<_>>().join(": ");
        std::iter::once(head.as_str()).chain(self.help.iter().map(String::as_str)).collect::<Vec<_>>().join("; ")
    }
}

/// Each of them once, in the order of the text, errors before warnings.
pub fn each_once(mut diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let mut known = HashSet::new();
    diagnostics.retain(|diagnostic| {
        let place = diagnostic.place.as_ref().map(|mark| (mark.range.clone(), mark.label.clone()));
        known.insert((diagnostic.title.clone(), place))
    });
    diagnostics
        .sort_by_key(|diagnostic| (diagnostic.severity, diagnostic.place.as_ref().map_or(0, |mark| mark.range.start)));
    diagnostics
}

//! What turns out to be wrong with a scene behind its checks.

use std::fmt;

use crate::{Document, Problem};

/// What is wrong with a scene, at the place of a key.
#[derive(Debug, Clone)]
pub struct SceneError {
    /// In a box of its own: results that carry it stay small.
    document: Box<Document>,
    problem: Box<Problem>,
    last: Option<&'static str>,
}

impl SceneError {
    /// Of the scene in these texts.
    pub(crate) fn new(document: Document, problem: Problem) -> Self {
        Self { document: Box::new(document), problem: Box::new(problem), last: None }
    }

    /// With a line behind it.
    pub(crate) fn with_last_line(self, line: &'static str) -> Self {
        Self { last: Some(line), ..self }
    }

    /// What is wrong.
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// The texts that it is about.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// The same as text, with the lines that it is about.
    pub fn text(&self, colours: bool) -> String {
        let text = self.document.render(std::slice::from_ref(&*self.problem), colours);
        self.last.map_or_else(|| text.clone(), |line| format!("{text}\n\n{line}"))
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(false))
    }
}

impl std::error::Error for SceneError {}

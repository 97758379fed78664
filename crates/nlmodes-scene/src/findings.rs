//! The problems of one scene, as they are found.

use std::collections::BTreeSet;

use crate::{Document, Problem, Severity, problem};

/// The problems of one scene, as they are found.
#[derive(Debug)]
pub struct Findings<'a> {
    document: &'a Document,
    problems: Vec<Problem>,
    meant: BTreeSet<String>,
}

impl<'a> Findings<'a> {
    /// Begins with what was found before.
    pub fn new(document: &'a Document, problems: Vec<Problem>) -> Self {
        Self { document, problems, meant: BTreeSet::new() }
    }

    /// The texts.
    pub fn document(&self) -> &'a Document {
        self.document
    }

    /// Adds a problem at its place or nowhere.
    pub fn push(&mut self, problem: Problem) {
        self.problems.push(problem);
    }

    /// Adds a problem at the value of a key.
    pub fn put(&mut self, path: &str, problem: Problem, label: impl Into<String>) {
        self.problems.push(self.document.put(problem, path, label));
    }

    /// Whether the scene writes this key, or one that was probably meant to be it.
    pub fn has(&self, path: &str) -> bool {
        self.document.place(path).is_some() || self.meant.contains(path)
    }

    /// Whether a key at this path was misspelt.
    pub fn is_meant(&self, path: &str) -> bool {
        self.meant.contains(path)
    }

    /// Takes note that an unknown key was probably meant to be this one.
    pub fn mean(&mut self, path: String) {
        self.meant.insert(path);
    }

    /// Says the problems so far in other words.
    pub(crate) fn reword(&mut self, reworded: impl Fn(Problem) -> Problem) {
        self.problems = std::mem::take(&mut self.problems).into_iter().map(reworded).collect();
    }

    /// Number of problems so far.
    pub fn count(&self) -> usize {
        self.problems.len()
    }

    /// Whether an unknown key was probably meant to be this one (the name without its table).
    pub fn has_misspelt(&self, name: &str) -> bool {
        let guess = format!("did you mean `{name}`?");
        self.problems.iter().filter_map(|problem| problem.place.as_ref()).any(|place| place.label == guess)
    }

    /// The value of a key as the scene writes it.
    pub fn written(&self, path: &str) -> String {
        self.document.written(path)
    }

    /// Whether the scene is refused.
    pub fn refuse(&self) -> bool {
        self.problems.iter().any(|problem| problem.severity == Severity::Error)
    }

    /// Each of them once, in the order of the text, errors before warnings.
    pub fn into_sorted(self) -> Vec<Problem> {
        problem::each_once(self.problems)
    }
}

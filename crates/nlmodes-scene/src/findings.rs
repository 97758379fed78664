//! The problems of one scene, as they are found.

use std::borrow::Cow;
use std::collections::BTreeSet;

use crate::{Document, Problem, Severity, problem};

/// The problems of one scene, as they are found.
#[derive(Debug)]
pub struct Findings<'a> {
    document: &'a Document,
    problems: Vec<Problem>,
    meant: BTreeSet<String>,
    body: Option<usize>,
}

impl<'a> Findings<'a> {
    /// Begins with what was found before.
    pub fn new(document: &'a Document, problems: Vec<Problem>) -> Self {
        Self { document, problems, meant: BTreeSet::new(), body: None }
    }

    /// The texts.
    pub fn document(&self) -> &'a Document {
        self.document
    }

    /// Says which structure of several (from 0) the key `structure` and those below it are about from here on; none where there is one.
    pub fn about_structure(&mut self, body: Option<usize>) {
        self.body = body;
    }

    /// The structure of several that is being looked at.
    pub fn structure(&self) -> Option<usize> {
        self.body
    }

    /// The path of a key in the file.
    fn in_file<'p>(&self, path: &'p str) -> Cow<'p, str> {
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

    /// Where the key of the path stands.
    pub fn place(&self, path: &str) -> Option<&'a crate::Place> {
        self.document.place(&self.in_file(path))
    }

    /// Adds a problem at its place or nowhere.
    pub fn push(&mut self, problem: Problem) {
        self.problems.push(problem);
    }

    /// Adds a problem at the value of a key.
    pub fn put(&mut self, path: &str, problem: Problem, label: impl Into<String>) {
        let problem = Problem { title: self.named(problem.title), ..problem };
        self.problems.push(self.document.put(problem, &self.in_file(path), label));
    }

    /// Whether the scene writes this key, or one that was probably meant to be it.
    pub fn has(&self, path: &str) -> bool {
        let path = self.in_file(path);
        self.document.place(&path).is_some() || self.meant.contains(path.as_ref())
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
        self.document.written(&self.in_file(path))
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

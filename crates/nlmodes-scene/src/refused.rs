//! A scene that is refused.

use crate::{Document, Problem, SceneFile, Severity, problem};

/// What is wrong with a scene that is refused.
#[derive(Debug, Clone)]
pub struct Refused {
    document: Document,
    problems: Vec<Problem>,
}

impl Refused {
    /// Of the scene in these texts.
    pub(super) fn new(document: Document, problems: Vec<Problem>) -> Self {
        Self { document, problems }
    }

    /// What is wrong.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// The texts that they are about.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// The same as text, with a last line that sums it up.
    pub fn text(&self, colours: bool) -> String {
        let errors = self.problems.iter().filter(|problem| problem.severity == Severity::Error).count();
        let name = &self.document.sources().file().name;
        let count = if errors == 1 { "1 error".into() } else { format!("{errors} errors") };
        format!(
            "{}\n\n{count} in {name}: nothing was computed or written",
            self.document.render(&self.problems, colours)
        )
    }
}

/// All scenes of a file with several methods, or what is wrong with any of them.
pub(super) fn or_all(read: Vec<Result<SceneFile, Box<Refused>>>) -> Result<Vec<SceneFile>, Box<Refused>> {
    if read.iter().all(Result::is_ok) {
        return Ok(read.into_iter().flatten().collect());
    }
    let mut first: Option<Document> = None;
    let mut problems = Vec::new();
    for scene in read {
        match scene {
            Ok(file) => problems.extend(file.warnings),
            Err(refused) => {
                problems.extend(refused.problems);
                first.get_or_insert(refused.document);
            }
        }
    }
    // All of them share their texts, so that a place in one is the same place in the other.
    match first {
        Some(document) => Err(Box::new(Refused::new(document, problem::each_once(problems)))),
        None => Ok(Vec::new()),
    }
}

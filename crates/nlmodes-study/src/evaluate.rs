//! Single cases on request, for an optimiser or a sampler.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use nlmodes_scene::assemble::Structures;
use serde::Serialize;
use serde_json::{Map, Value};

use crate::case::{Case, Resolved, resolve_set, setting};
use crate::collect::{Row, State};
use crate::error::StudyError;
use crate::run::{Settings, Worker};
use crate::store::Store;
use crate::study::Study;

/// Result of a case.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// How it ended: `complete`, `incomplete` or `failed`.
    pub status: &'static str,
    /// Why it failed or ended early, or which quantity is missing; otherwise empty.
    pub reason: String,
    /// Each quantity of the study; `null` where the case does not have it.
    pub quantities: Map<String, Value>,
    /// Name of its directory; empty if the scene is rejected.
    pub id: String,
}

/// Computes cases of a study on request, whatever its design. Existing cases are not computed again.
#[derive(Debug, Clone)]
pub struct Evaluator {
    study: Study,
    settings: Settings,
    ended: Arc<AtomicBool>,
    structures: Arc<Structures>,
}

impl Evaluator {
    /// For this study, in its directory.
    pub fn new(study: Study, settings: Settings) -> Self {
        let structures = Arc::new(Structures::within(settings.limit()));
        Self { study, settings, ended: Arc::default(), structures }
    }

    /// Ends the case in progress, which continues the next time.
    pub fn end(&self) {
        self.ended.store(true, Ordering::Relaxed);
    }

    /// The case with these values, by the names of variables or by keys of `--set`; `None` if the end was requested.
    ///
    /// # Errors
    /// [`StudyError`] if it cannot be written.
    pub fn evaluate(&self, values: &Map<String, Value>) -> Result<Option<Answer>, StudyError> {
        let set: Vec<String> = values.iter().flat_map(|(name, value)| self.set(name, value)).collect();
        let resolved = match resolve_set(&self.study, set) {
            Ok(parts) => match <[Resolved; 1]>::try_from(parts) {
                Ok([resolved]) => resolved,
                Err(_) => return Ok(Some(self.failed("the scene has several methods or numbers of harmonics"))),
            },
            Err(refused) => return Ok(Some(self.failed(&refused.sentence()))),
        };
        let Self { study, settings, ended, structures } = self;
        if !(Worker { study, settings, ended, structures }).is_there(&resolved)? {
            return Ok(None);
        }
        let id = Ok(resolved.id);
        let case = Case { number: 0, point: 0, part: 0, values: Vec::new(), method: "", harmonics: 0, id };
        Ok(Some(self.answer(&case, Row::read(study, &Store::new(&study.directory), &case, false))))
    }

    /// The `--set` argument for a name and its value.
    fn set(&self, name: &str, value: &Value) -> Vec<String> {
        let variable = self.study.variables.iter().find(|variable| variable.name == name);
        match variable {
            Some(variable) => variable.keys.iter().map(|key| setting(key, value)).collect(),
            None => vec![setting(name, value)],
        }
    }

    fn failed(&self, reason: &str) -> Answer {
        let names = self.study.quantities.iter().map(|quantity| (quantity.name.clone(), Value::Null));
        let (reason, id) = (reason.to_owned(), String::new());
        Answer { status: State::Failed.name(), reason, quantities: names.collect(), id }
    }

    fn answer(&self, case: &Case, row: Row) -> Answer {
        let values = row.values.iter().map(|value| value.map_or(Value::Null, |[value, _]| Value::from(value)));
        let names = self.study.quantities.iter().map(|quantity| quantity.name.clone());
        let id = case.id.clone().unwrap_or_default();
        Answer { status: row.state.name(), reason: row.reason, quantities: names.zip(values).collect(), id }
    }
}

//! Where further cases of a study come from.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use nlmodes_scene::Diagnostic;
use nlmodes_scene::assemble::Structures;
use serde_json::Value;

use super::{Cases, Further};
use crate::case::{Resolved, overrides, resolve_differentiated};
use crate::curve::Curve;
use crate::error::StudyError;
use crate::run::{Done, Settings, Worker};
use crate::store::{Status, Store};
use crate::study::Study;

/// Time between two checks of a case that another process is computing.
const LOOK: Duration = Duration::from_millis(100);

/// Cases that are in the store.
pub struct Stored<'a> {
    /// The study.
    pub study: &'a Study,
    /// Its store.
    pub store: &'a Store,
}

/// Cases that are computed where they are not in the store.
pub struct Computing<'a> {
    /// The study.
    pub study: &'a Study,
    /// How it is computed.
    pub settings: &'a Settings,
    /// Whether the end was requested.
    pub ended: &'a Arc<AtomicBool>,
    /// Data common to cases.
    pub structures: &'a Structures,
}

impl Cases for Stored<'_> {
    fn at(&mut self, values: &[f64]) -> Result<Further, StudyError> {
        Ok(match resolved(self.study, values) {
            Ok(case) => read(self.store, &case.id),
            Err(reason) => Further::Failed(reason),
        })
    }
}

impl Cases for Computing<'_> {
    fn at(&mut self, values: &[f64]) -> Result<Further, StudyError> {
        let case = match resolved(self.study, values) {
            Ok(case) => case,
            Err(reason) => return Ok(Further::Failed(reason)),
        };
        let store = Store::new(&self.study.directory);
        let worker = Worker {
            store: &store,
            settings: self.settings,
            keep: self.study.keep,
            ended: self.ended,
            structures: self.structures,
        };
        while store.record(&case.id).is_none() {
            if self.ended.load(Ordering::Relaxed) {
                return Ok(Further::Missing);
            }
            if worker.compute(case.clone())? == Done::Elsewhere {
                thread::sleep(LOOK);
            }
        }
        Ok(read(&store, &case.id))
    }
}

/// The scene of a case, of which there is one.
fn resolved(study: &Study, values: &[f64]) -> Result<Resolved, String> {
    let keys = study.variables.iter().zip(values);
    let point: Vec<Vec<Value>> = keys.map(|(one, value)| vec![Value::from(*value); one.keys.len()]).collect();
    let parts = resolve_differentiated(study, overrides(study, &point)).map_err(|refused| {
        let all: Vec<String> = refused.diagnostics().iter().map(Diagnostic::sentence).collect();
        all.join(" | ")
    })?;
    let one = <[Resolved; 1]>::try_from(parts);
    one.map(|[resolved]| resolved).map_err(|_| "the scene has several methods or numbers of harmonics".to_owned())
}

fn read(store: &Store, id: &str) -> Further {
    let Some(record) = store.record(id) else { return Further::Missing };
    if record.status == Status::Failed {
        return Further::Failed(record.reason);
    }
    match Curve::read(&store.case(id)) {
        Ok(curve) => Further::Found { id: id.to_owned(), curve: Box::new(curve) },
        Err(error) => Further::Failed(error.to_string()),
    }
}

//! Further cases of a study, computed where they are not in its store.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use nlmodes_scene::assemble::Structures;

use super::{Done, Settings, Worker};
use crate::error::StudyError;
use crate::first_order::{Cases, Further, read, resolved};
use crate::store::Store;
use crate::study::Study;

/// Time between two checks of a case that another process is computing.
const LOOK: Duration = Duration::from_millis(100);

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

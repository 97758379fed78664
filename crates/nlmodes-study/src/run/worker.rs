//! One case, from its scene to its record.

use nlmodes::modal::EndReason;
use std::any::Any;
use std::error::Error;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use nlmodes::branches::Watch;
use nlmodes_run::responses::{ComputedResponse, ResponsesOutcome};
use nlmodes_run::{Event, Observer, Over, RunError, RunOutcome, chain, run_sharing};
use nlmodes_scene::assemble::Structures;
use nlmodes_scene::{SceneFile, memory};

use super::Settings;
use crate::case::Resolved;
use crate::error::StudyError;
use crate::first_order::{Further, read, resolved};
use crate::store::{CaseRecord, Status, Store, branch_sha256};
use crate::study::{Keep, Study};

/// Files that a table does not need.
const HEAVY: [&str; 5] = ["harmonics.npz", "steps.jsonl", "participation.csv", "starts.npz", "histories.npz"];

/// Outcome of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Done {
    /// It was computed.
    Ended(Status),
    /// Another process has completed it meanwhile.
    There(Status),
    /// Another process is computing it.
    Elsewhere,
    /// The end was requested; it continues the next time.
    CutOff,
}

/// Time between two checks of a case that another process is computing.
const LOOK: Duration = Duration::from_millis(100);

/// Computes cases.
pub struct Worker<'a> {
    /// The study.
    pub study: &'a Study,
    /// How it is computed.
    pub settings: &'a Settings,
    /// Whether the end was requested.
    pub ended: &'a Arc<AtomicBool>,
    /// Data common to cases.
    pub structures: &'a Structures,
}

impl Worker<'_> {
    /// What comes of the case with these values of the variables, computed where it is not in the store.
    ///
    /// # Errors
    /// [`StudyError`] if it cannot be written.
    pub fn at(&self, values: &[f64]) -> Result<Further, StudyError> {
        let case = match resolved(self.study, values) {
            Ok(case) => case,
            Err(reason) => return Ok(Further::Failed(reason)),
        };
        Ok(if self.is_there(&case)? { read(&self.store(), &case.id) } else { Further::Missing })
    }

    fn store(&self) -> Store {
        Store::new(&self.study.directory)
    }

    /// Computes a case unless it is in the store; whether it is there then, as it is not where the end was requested.
    ///
    /// # Errors
    /// [`StudyError`] if it cannot be written.
    pub fn is_there(&self, case: &Resolved) -> Result<bool, StudyError> {
        while self.store().record(&case.id).is_none() {
            if self.ended.load(Ordering::Relaxed) {
                return Ok(false);
            }
            if self.compute(case.clone())? == Done::Elsewhere {
                thread::sleep(LOOK);
            }
        }
        Ok(true)
    }

    /// Computes a case, unless another process does.
    ///
    /// # Errors
    /// [`StudyError`] if it cannot be written.
    pub fn compute(&self, case: Resolved) -> Result<Done, StudyError> {
        let Resolved { file, id, set } = case;
        let store = self.store();
        let Some(claim) = store.claim(&id)? else { return Ok(Done::Elsewhere) };
        // Checked under the lock, so no other process can complete it.
        if let Some(record) = store.record(&id) {
            return Ok(Done::There(record.status));
        }
        let began = Instant::now();
        let attempt = || catch_unwind(AssertUnwindSafe(|| self.run(file.clone(), &id)));
        // Failures due to a full disk or lack of memory are reported as such the second time; errors of the scene occur
        // again.
        let ended = attempt().or_else(|_| attempt());
        let (status, reason) = match ended {
            Ok(Ok(Some(ended))) => ended,
            Ok(Ok(None)) => return Ok(Done::CutOff),
            Ok(Err(error)) => failure(error).map_err(|error| self.unwritable(&id, error))?,
            Err(panic) => (Status::Failed, format!("the program failed: {}", message(panic.as_ref()))),
        };
        if self.study.keep == Keep::Tables {
            // A file that cannot be removed only takes space.
            HEAVY.iter().for_each(|name| drop(fs::remove_file(store.case(&id).join(name))));
        }
        let branch_sha256 = branch_sha256(&store.case(&id));
        let (version, seconds) = (env!("CARGO_PKG_VERSION").to_owned(), began.elapsed().as_secs_f64());
        let record = CaseRecord { version, status, reason, set, seconds, branch_sha256 };
        store.finish(&id, &record, claim)?;
        Ok(Done::Ended(status))
    }

    /// How the run of the case ended; `None` if the end was requested.
    fn run(&self, mut file: SceneFile, id: &str) -> Result<Option<(Status, String)>, RunError> {
        file.scene.output_directory = self.store().case(id);
        if !self.settings.drawn {
            (file.scene.files.figures, file.scene.files.page) = (false, false);
        }
        let mut files = [file];
        memory::admit(&mut files, Some(self.settings.limit()))?;
        let mut looker = Looker { ended: Arc::clone(self.ended) };
        let is_ended = || self.ended.load(Ordering::Relaxed);
        if let [file] = &files
            && !file.scene.responses.is_empty()
        {
            let outcome = resumed(|over| nlmodes_run::responses::run(file, over, &mut looker))?;
            return outcome.filter(|found| !(is_ended() && found.is_cut_off)).map(judged_responses).transpose();
        }
        let outcome = resumed(|over| run_sharing(files.to_vec(), over, &mut looker, self.structures))?;
        outcome.filter(|found| !(is_ended() && was_stopped(found))).map(judged).transpose()
    }

    fn unwritable(&self, id: &str, error: RunError) -> StudyError {
        StudyError::Case { directory: self.store().case(id), source: Box::new(error) }
    }
}

/// The outcome of a run that goes on with what is there, or begins anew where that belongs to something else; `None` if
/// it was ended before any point was found.
fn resumed<T>(mut run: impl FnMut(Over) -> Result<T, RunError>) -> Result<Option<T>, RunError> {
    let outcome = match run(Over::Resumed) {
        Err(RunError::Foreign { .. }) => run(Over::Anything),
        outcome => outcome,
    };
    match outcome {
        Err(RunError::Ended) => Ok(None),
        outcome => outcome.map(Some),
    }
}

/// Why a case has no branch, or an error that would affect the next one too.
fn failure(error: RunError) -> Result<(Status, String), RunError> {
    let reason = match error {
        RunError::Scene(said) | RunError::Failed(said) => said.sentence(),
        RunError::Unwritable { .. } | RunError::InUse { .. } | RunError::Link { .. } => return Err(error),
        RunError::Files(failure) if is_of_disk(failure.as_ref()) => return Err(RunError::Files(failure)),
        other => chain(&other),
    };
    Ok((Status::Failed, reason))
}

/// Whether a file could not be written.
fn is_of_disk(error: &(dyn Error + 'static)) -> bool {
    error.is::<std::io::Error>() || error.source().is_some_and(is_of_disk)
}

fn was_stopped(outcome: &RunOutcome) -> bool {
    let ends = || outcome.parts.iter().flat_map(|part| &part.tree.branches).map(|computed| &computed.branch.end);
    outcome.is_cut_off || ends().any(|end| end.has(EndReason::Stopped))
}

/// Whether the branches are complete, and why they ended.
fn judged(outcome: RunOutcome) -> Result<(Status, String), RunError> {
    let mut reasons = Vec::new();
    let mut is_complete = true;
    for part in outcome.parts {
        if let Some(failure) = part.failure {
            return Err(RunError::Files(failure));
        }
        for computed in &part.tree.branches {
            is_complete &= computed.branch.end.complete;
            let end = &computed.branch.end;
            reasons.push(if end.complete { end.names() } else { end.message.clone() });
        }
    }
    reasons.dedup();
    let status = if is_complete { Status::Complete } else { Status::Incomplete };
    Ok((status, reasons.join("; ")))
}

/// Whether the curves of a scene with responses are complete, and why they ended; failed where there is none at all.
fn judged_responses(outcome: ResponsesOutcome) -> Result<(Status, String), RunError> {
    if let Some(failure) = outcome.failure {
        return Err(RunError::Files(failure));
    }
    let reason = |computed: &ComputedResponse| {
        let end = &computed.branch.end;
        let why = if end.complete { end.names() } else { end.message.clone() };
        format!("{}: {why}", computed.branch.label)
    };
    let mut reasons: Vec<String> = outcome.curves.iter().map(reason).collect();
    reasons.dedup();
    let has_points = outcome.curves.iter().any(|computed| !computed.branch.points.is_empty());
    let status = match outcome.curves.iter().all(ComputedResponse::is_complete) {
        true => Status::Complete,
        false if has_points => Status::Incomplete,
        false => Status::Failed,
    };
    Ok((status, reasons.join("; ")))
}

fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("no reason was given")
}

/// Lets a run continue until the study is to end.
struct Looker {
    ended: Arc<AtomicBool>,
}

impl Observer for Looker {
    fn event(&mut self, _: Event<'_>) {}

    fn is_cancelled(&self) -> bool {
        self.ended.load(Ordering::Relaxed)
    }

    fn watch(&self) -> Watch {
        let ended = Arc::clone(&self.ended);
        Watch::until(move || ended.load(Ordering::Relaxed))
    }
}

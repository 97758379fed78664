//! Computation of missing cases, one branch per thread.

mod outcome;
mod settings;
mod worker;

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use nlmodes_scene::assemble::Structures;

use crate::case::{Case, cases, cases_of, resolve};
use crate::design::Points;
use crate::error::StudyError;
use crate::first_order::FirstOrder;
use crate::store::{Status, Store};
use crate::study::Study;
pub use outcome::{StudyObserver, StudyOutcome};
pub use settings::{Settings, Shard};
pub(crate) use worker::{Done, Worker};

/// Time between two checks for a requested end.
const LOOK: Duration = Duration::from_millis(50);

/// Computes the missing cases.
///
/// Each case is a directory `cases/<id>` as a plain run makes it, with `case.json` as its last file. A failed case has
/// its reason; the others continue. A killed process loses nothing: its case continues from the last step.
///
/// # Errors
/// [`StudyError`], if no case can be computed, or the disk is full.
pub fn run(study: &Study, settings: &Settings, observer: &mut dyn StudyObserver) -> Result<StudyOutcome, StudyError> {
    let all = cases_of(study, |point| settings.shard.has(point), settings.jobs());
    let none_of = |cases: &[Case]| cases.iter().all(|case| case.id.is_err());
    if let Some(Case { id: Err(reason), .. }) = all.first().filter(|_| none_of(&all)) {
        let whole = cases(study, settings.jobs());
        if none_of(&whole) {
            return Err(StudyError::NoCase { cases: whole.len(), reason: reason.to_string() });
        }
    }
    let store = Store::new(&study.directory);
    let mut outcome = StudyOutcome::new(&all);
    let waiting = waiting(&all, &store, settings, &mut outcome)?;
    let points = Points::new(study);
    let (ended, structures) = (Arc::default(), Structures::within(settings.limit()));
    let worker = || Worker { study, settings, ended: &ended, structures: &structures };
    let shared = Shared { worker: worker(), points: &points, waiting: &waiting, next: AtomicUsize::new(0) };
    observer.progress(&outcome);
    let began = Instant::now();
    let failure = Mutex::new(None);
    thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        for _ in 0..settings.jobs().min(waiting.len()) {
            let (shared, sender, failure) = (&shared, sender.clone(), &failure);
            scope.spawn(move || work(shared, &sender, failure));
        }
        drop(sender);
        loop {
            match receiver.recv_timeout(LOOK) {
                Ok(done) => {
                    outcome.take(&done);
                    outcome.wall_time = began.elapsed();
                    observer.progress(&outcome);
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            if observer.is_cancelled() {
                ended.store(true, Ordering::Relaxed);
            }
        }
    });
    if let Some(error) = failure.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(error);
    }
    // The cases that follow from gradients, by whoever has the first one.
    if settings.shard.has(0) && !ended.load(Ordering::Relaxed) {
        let first_order = || FirstOrder::of(study, &[], &mut |values| worker().at(values));
        // A case that panics is a row with its reason.
        watched(&ended, observer, first_order).unwrap_or(Ok(None))?;
    }
    outcome.is_cut_off = ended.load(Ordering::Relaxed);
    outcome.wall_time = began.elapsed();
    Ok(outcome)
}

/// Data shared by all workers.
struct Shared<'a> {
    worker: Worker<'a>,
    points: &'a Points<'a>,
    waiting: &'a [&'a Case],
    next: AtomicUsize,
}

/// Does this work, and notes meanwhile whether its end is requested.
///
/// # Errors
/// If it panics.
pub(crate) fn watched<T: Send>(
    ended: &AtomicBool,
    observer: &dyn StudyObserver,
    work: impl FnOnce() -> T + Send,
) -> thread::Result<T> {
    thread::scope(|scope| {
        let computing = scope.spawn(work);
        while !computing.is_finished() {
            if observer.is_cancelled() {
                ended.store(true, Ordering::Relaxed);
            }
            thread::sleep(LOOK);
        }
        computing.join()
    })
}

/// Computes one case after the other until none is left, the end is requested, or the disk is full.
fn work(shared: &Shared<'_>, sender: &mpsc::Sender<Done>, failure: &Mutex<Option<StudyError>>) {
    let _core = nlmodes::linalg::Worker::new();
    let Worker { study, ended, .. } = shared.worker;
    while !ended.load(Ordering::Relaxed) {
        let Some(case) = shared.waiting.get(shared.next.fetch_add(1, Ordering::Relaxed)) else { return };
        let parts = resolve(study, &shared.points.get(case.point));
        // It was valid when its name was computed.
        let Some(resolved) = parts.ok().and_then(|parts| parts.into_iter().nth(case.part)) else { continue };
        match shared.worker.compute(resolved) {
            Ok(done) => {
                // There is no receiver if the study ends.
                let _ = sender.send(done);
            }
            Err(error) => {
                ended.store(true, Ordering::Relaxed);
                failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
            }
        }
    }
}

/// Cases of this shard that are not done, each scene once.
fn waiting<'a>(
    all: &'a [Case],
    store: &Store,
    settings: &Settings,
    outcome: &mut StudyOutcome,
) -> Result<Vec<&'a Case>, StudyError> {
    let mut known = BTreeSet::new();
    let mut waiting = Vec::new();
    for case in all {
        let Ok(id) = &case.id else { continue };
        if !known.insert(id) {
            outcome.repeated += 1;
            continue;
        }
        match store.record(id) {
            Some(record) if record.status == Status::Failed && settings.retry => {
                store.forget(id)?;
                waiting.push(case);
            }
            Some(record) => outcome.there(record.status),
            None => waiting.push(case),
        }
    }
    Ok(waiting)
}

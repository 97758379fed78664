//! The steps of a branch on disk, from which a run continues.

use std::cell::Cell;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::rc::Rc;

use nlmodes::report::ReportError;
use nlmodes_continuation::{Correction, RunLog, StepRecord, StopReason};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::claim::{Claim, identity};
use crate::files::STEPS;
use crate::{Event, Observer, RunError};
use nlmodes_scene::scene::Scene;

/// Changes with what a line means.
const FORMAT: u32 = 1;

/// Largest difference of a coordinate up to which the start of a run is the one that is known: the rest is rounding.
const SAME: f64 = 1e-9;

/// A line of the file after the first one.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Line {
    /// A run of the continuation begins here.
    Run(Correction),
    /// It took a step.
    Step(Box<StepRecord>),
}

/// A run that is in the file.
struct Known {
    /// Where its first line begins.
    offset: u64,
    start: Correction,
    /// Start of the line of each step, without those at which the run was ended and later continued.
    offsets: Vec<u64>,
    steps: Vec<StepRecord>,
}

/// `steps.jsonl`: one line per step, written when the step is taken.
///
/// Lines after an incomplete or invalid one are ignored.
pub struct Journal {
    path: PathBuf,
    header: Value,
    claim: Claim,
    known: Vec<Known>,
    /// Runs that have begun.
    begun: usize,
    file: Option<File>,
    /// Length of the file as far as it counts.
    length: u64,
    /// Whether points are new, not repeated from the file.
    pub computing: Rc<Cell<bool>>,
    /// Why a step could not be written.
    pub failure: Option<ReportError>,
}

impl Journal {
    /// The steps of an earlier run of the same scene, if it is continued; otherwise none.
    fn open(scene: &Scene, claim: &Claim) -> Result<Self, ReportError> {
        let path = scene.output_directory.join(STEPS);
        let mut journal = Self {
            header: header(scene),
            claim: claim.clone(),
            known: Vec::new(),
            begun: 0,
            file: None,
            length: 0,
            computing: Rc::new(Cell::new(true)),
            failure: None,
            path,
        };
        if claim.resumes() && journal.path.is_file() {
            let bytes = fs::read(&journal.path).map_err(journal.io())?;
            journal.read(&bytes);
            journal.computing.set(journal.known.is_empty());
        }
        Ok(journal)
    }

    /// The same for a run that begins; that there is nothing to continue goes to the observer.
    ///
    /// # Errors
    /// [`RunError::Unwritable`].
    pub fn begun(scene: &Scene, claim: &Claim, observer: &mut dyn Observer) -> Result<Self, RunError> {
        let directory = &scene.output_directory;
        let unwritable = |source| RunError::Unwritable { directory: directory.clone(), source, kept: true };
        let journal = Self::open(scene, claim).map_err(unwritable)?;
        if claim.resumes() && journal.known.iter().all(|run| run.steps.is_empty()) {
            observer.event(Event::NothingToResume { directory });
        }
        Ok(journal)
    }

    fn read(&mut self, bytes: &[u8]) {
        let mut offset = 0;
        for line in bytes.split_inclusive(|byte| *byte == b'\n') {
            let Some(text) = line.strip_suffix(b"\n") else { return };
            if offset == 0 {
                if serde_json::from_slice::<Value>(text).ok().as_ref() != Some(&self.header) {
                    return;
                }
            } else {
                match serde_json::from_slice(text) {
                    Ok(Line::Run(start)) => {
                        self.known.push(Known { offset, start, offsets: Vec::new(), steps: Vec::new() })
                    }
                    Ok(Line::Step(step)) => {
                        let Some(run) = self.known.last_mut() else { return };
                        // It was ended there, and has continued since.
                        if run.steps.pop_if(|last| last.stop.as_ref().is_some_and(StopReason::is_asked_for)).is_some() {
                            run.offsets.pop();
                        }
                        if run.steps.last().is_some_and(|last| last.stop.is_some()) {
                            return;
                        }
                        run.offsets.push(offset);
                        run.steps.push(*step);
                    }
                    Err(_) => return,
                }
            }
            offset += line.len() as u64;
            self.length = offset;
        }
    }

    /// Anything after the runs that have begun does not belong to this computation.
    fn forget_the_rest(&mut self) {
        if let Some(next) = self.known.get(self.begun) {
            self.forget_behind(next.offset);
        }
    }

    /// The file counts up to there.
    fn forget_behind(&mut self, length: u64) {
        self.length = length;
        self.known.truncate(self.begun);
        self.file = None;
    }

    fn append(&mut self, line: &Line) -> Result<(), ReportError> {
        let mut text =
            serde_json::to_vec(line).map_err(|source| ReportError::Json { path: self.path.clone(), source })?;
        text.push(b'\n');
        if self.file.is_none() {
            self.claim.take()?;
            self.file = Some(self.prepare().map_err(self.io())?);
        }
        let (length, Some(file)) = (self.length, &mut self.file) else { return Ok(()) };
        let written = file.write_all(&text);
        if written.is_err() {
            // The next run finds whole lines only.
            let _ = file.set_len(length);
        }
        written.map_err(self.io())?;
        self.length += text.len() as u64;
        Ok(())
    }

    /// Opens the file after its valid part.
    fn prepare(&mut self) -> io::Result<File> {
        if let Some(directory) = self.path.parent() {
            fs::create_dir_all(directory)?;
        }
        let mut file = OpenOptions::new().create(true).truncate(false).write(true).open(&self.path)?;
        file.try_lock().map_err(io::Error::from)?;
        file.set_len(self.length)?;
        file.seek(SeekFrom::Start(self.length))?;
        if self.length == 0 {
            let text = format!("{}\n", self.header);
            file.write_all(text.as_bytes())?;
            self.length = text.len() as u64;
        }
        Ok(file)
    }

    fn io(&self) -> impl FnOnce(io::Error) -> ReportError + use<> {
        let path = self.path.clone();
        move |source| ReportError::Io { path, source }
    }
}

impl RunLog for Journal {
    fn begin(&mut self, start: &Correction) -> Vec<StepRecord> {
        if self.failure.is_some() {
            return Vec::new();
        }
        if let Some(run) = self.known.get_mut(self.begun).filter(|run| is_same(&run.start, start)) {
            self.begun += 1;
            return std::mem::take(&mut run.steps);
        }
        self.forget_the_rest();
        self.failure = self.append(&Line::Run(start.clone())).err();
        // So that the numbers of this run are those of the file.
        let offset = self.length;
        self.known.push(Known { offset, start: start.clone(), offsets: Vec::new(), steps: Vec::new() });
        self.begun += 1;
        Vec::new()
    }

    fn computing(&mut self, repeated: usize) -> ControlFlow<()> {
        let run = self.begun.checked_sub(1).and_then(|run| self.known.get(run));
        match run.and_then(|run| run.offsets.get(repeated)) {
            // Steps that are none of this run.
            Some(offset) => self.forget_behind(*offset),
            None => self.forget_the_rest(),
        }
        self.computing.set(true);
        ControlFlow::Continue(())
    }

    fn record(&mut self, step: &StepRecord) -> ControlFlow<()> {
        if self.failure.is_none() {
            self.failure = self.append(&Line::Step(Box::new(step.clone()))).err();
        }
        if self.failure.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// The first line: what the steps are of.
fn header(scene: &Scene) -> Value {
    let mut scene = identity(serde_json::to_value(scene).unwrap_or_default());
    // More points may be requested when a run is continued.
    if let Some(continuation) = scene.get_mut("continuation").and_then(Value::as_object_mut) {
        continuation.remove("max_points");
    }
    json!({ "program": "nlmodes-cli", "version": env!("CARGO_PKG_VERSION"), "format": FORMAT, "scene": scene })
}

fn is_same(known: &Correction, start: &Correction) -> bool {
    known.z.len() == start.z.len()
        && known.z.iter().zip(&start.z).all(|(a, b)| (a - b).abs() <= SAME * b.abs().max(1.0))
}

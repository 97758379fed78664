//! What `--resume` reads back, without going on from there: for `fuzz/`.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

use nlmodes::branches::{BranchProgress, BranchSettings, BranchStart, compute_tree_with_log};
use nlmodes::modal::{EndReason, ModalPoint};
use nlmodes::model::MasslessContactModel;
use nlmodes::report::ReportError;
use nlmodes_continuation::{Correction, RunLog, StepRecord};
use serde_json::Value;

use crate::chain;
use crate::claim::{Claim, Over, foreign, identity};
use crate::files::{RUN, STEPS};
use crate::journal::{Journal, header};
use crate::settings::{branch_settings, models, starts};
use nlmodes_scene::Scene;

/// A scene whose interrupted runs are read.
pub struct Interrupted {
    scene: Scene,
    scenes: Value,
    model: MasslessContactModel,
}

/// What an interrupted run left.
pub struct Left {
    /// `run.json`.
    pub run: Vec<u8>,
    /// `steps.jsonl`.
    pub steps: Vec<u8>,
}

impl Interrupted {
    /// The scene of this text, with its results in `directory`.
    ///
    /// # Errors
    /// The message.
    pub fn new(text: &str, directory: &Path) -> Result<Self, String> {
        let files = nlmodes_scene::parse_each_method("scene.toml", text, &[]).map_err(|refused| refused.text(false))?;
        let mut file = files.into_iter().next().ok_or("no scene")?;
        file.scene.output_directory = directory.to_path_buf();
        let model = models(&file).map_err(|_| "no structure")?.massless;
        let scenes = Value::Array(vec![identity(serde_json::to_value(&file.scene).unwrap_or_default())]);
        Ok(Self { scene: file.scene, scenes, model })
    }

    /// The first line of its `steps.jsonl`.
    pub fn header(&self) -> String {
        header(&self.scene).to_string()
    }

    /// What a run leaves that is cut off behind so many points.
    ///
    /// # Errors
    /// The message.
    pub fn compute(&self, points: usize) -> Result<Left, String> {
        let directory = &self.scene.output_directory;
        let claim = Claim::unchecked(directory, "scene.toml", &self.scenes, Over::Anything);
        let mut journal = self.journal(&claim)?;
        let mut count = 0;
        self.each_way(&mut journal, &mut |_| {
            count += 1;
            if count < points { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        })?;
        if let Some(failure) = journal.failure {
            return Err(chain(&failure));
        }
        let read = |name: &str| fs::read(directory.join(name)).map_err(|error| error.to_string());
        Ok(Left { run: read(RUN)?, steps: read(STEPS)? })
    }

    /// Reads `run.json` and `steps.jsonl` of its directory and repeats the steps, as a run that goes on does, up to the
    /// first one that is not known; writes nothing. The points of all that were repeated.
    ///
    /// # Errors
    /// The message.
    pub fn read(&self) -> Result<Vec<ModalPoint>, String> {
        let directory = &self.scene.output_directory;
        if let Some(why) = foreign(directory, &self.scenes, Over::Resumed, None) {
            return Err(why);
        }
        let claim = Claim::unchecked(directory, "scene.toml", &self.scenes, Over::Resumed);
        let mut journal = self.journal(&claim)?;
        if journal.known_steps() == 0 {
            return Ok(Vec::new());
        }
        let mut points = Vec::new();
        self.each_way(&mut Known(&mut journal), &mut |point| {
            points.push(point.clone());
            ControlFlow::Continue(())
        })?;
        Ok(points)
    }

    fn journal(&self, claim: &Claim) -> Result<Journal, String> {
        Journal::open(&self.scene, claim).map_err(|failure: ReportError| chain(&failure))
    }

    /// The branch from its start, and where both ways are asked for, the other one.
    fn each_way(
        &self,
        log: &mut dyn RunLog,
        each: &mut dyn FnMut(&ModalPoint) -> ControlFlow<()>,
    ) -> Result<(), String> {
        let (first, other) = starts(self.scene.continuation.start());
        let ways: [Option<BranchStart>; 2] = [Some(first), other];
        let mut ended = false;
        for start in ways.into_iter().flatten() {
            if ended {
                break;
            }
            let settings = BranchSettings { start, ..branch_settings(&self.scene) };
            let observe = |progress: BranchProgress| match progress {
                BranchProgress::Found { point, .. } => each(point),
                _ => ControlFlow::Continue(()),
            };
            let tree = compute_tree_with_log(self.model.clone(), &settings, log, observe);
            let tree = tree.map_err(|error| chain(&error))?;
            ended = tree.branches.iter().any(|computed| computed.branch.end.has(EndReason::Stopped));
        }
        Ok(())
    }
}

/// Repeats what a journal knows, and ends where it would have to be written.
struct Known<'j>(&'j mut Journal);

impl RunLog for Known<'_> {
    fn begin(&mut self, start: &Correction) -> Vec<StepRecord> {
        if self.0.knows(start) { self.0.begin(start) } else { Vec::new() }
    }

    fn computing(&mut self, repeated: usize) -> ControlFlow<()> {
        let _ = self.0.computing(repeated);
        ControlFlow::Break(())
    }

    fn record(&mut self, _: &StepRecord) -> ControlFlow<()> {
        ControlFlow::Break(())
    }
}

//! `nlmodes-cli experiment extract`: measured records into modal points.

use nlmodes_run::chain;
use nlmodes_run::records::{decay_in_words, extract, in_words};
use nlmodes_scene::{RecordScene, SceneFile};

use crate::Status;
use crate::observer::TerminalObserver;
use crate::options::RunOptions;
use crate::terminal::{print, refuse_run};

/// Extracts from all records, and reports the result of each.
pub fn run(file: &SceneFile<RecordScene>, options: RunOptions) -> Status {
    let outcomes = match extract(file, options.over(), &mut TerminalObserver::new(options)) {
        Ok(outcomes) => outcomes,
        Err(error) => return refuse_run(&error),
    };
    for outcome in &outcomes {
        if let (Err(error), None) = (&outcome.result, &outcome.decay) {
            say!("warning: {}: no modal point: {}", outcome.name(), chain(error));
        }
    }
    if !options.quiet {
        let found = outcomes.iter().filter_map(|outcome| outcome.result.as_ref().ok()).map(in_words);
        let mut lines: Vec<String> = found.collect();
        let decays =
            outcomes.iter().filter_map(|outcome| Some(decay_in_words(&outcome.record, outcome.decay.as_ref()?)));
        lines.extend(decays);
        lines.push(format!("Results in {}", file.scene.output_directory.display()));
        print(&lines.join("\n"));
    }
    if outcomes.iter().all(|outcome| outcome.result.is_ok() || outcome.decay.is_some()) {
        Status::Done
    } else {
        Status::EndedEarly
    }
}

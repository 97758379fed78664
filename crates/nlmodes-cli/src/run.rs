//! `nlmodes-cli run`: what a scene describes, computed and written.

use nlmodes_run::responses::one_method;
use nlmodes_run::{Failure, chain};
use nlmodes_scene::scene::TestScene;
use nlmodes_scene::{AnyScene, SceneFile};

use crate::observer::TerminalObserver;
use crate::options::RunOptions;
use crate::terminal::{print, refuse_run};
use crate::{Status, interrupt, told};

/// Computes what the scene describes.
pub fn run(scene: AnyScene, options: RunOptions) -> Status {
    interrupt::install();
    match scene {
        AnyScene::Structure(files) if files.iter().any(|file| file.scene.transient.is_some()) => {
            one_method(&files).map_or_else(|error| refuse_run(&error), |file| transient(file, options))
        }
        AnyScene::Structure(files) if files.iter().any(|file| !file.scene.responses.is_empty()) => {
            one_method(&files).map_or_else(|error| refuse_run(&error), |file| responses(file, options))
        }
        AnyScene::Structure(files) => branches(files, options),
        AnyScene::Test(file) => test(&file, options),
        // `load_to_run` refuses these with the command that takes them.
        AnyScene::Records(_) => Status::Wrong,
    }
}

/// The branches of a scene with one method, or several that differ in it.
fn branches(files: Vec<SceneFile>, options: RunOptions) -> Status {
    let mut watch = TerminalObserver::new(options);
    match nlmodes_run::run(files, options.over(), &mut watch) {
        Ok(outcome) => {
            failed(outcome.failure.as_ref());
            watch.compared(&outcome.compared);
            if outcome.is_complete() { watch.status } else { Status::EndedEarly }
        }
        Err(error) => refuse_run(&error),
    }
}

/// Most levels that are reported one by one.
const LEVELS: usize = 12;

fn responses(file: &SceneFile, options: RunOptions) -> Status {
    let outcome = match nlmodes_run::responses::run(file, options.over(), &mut TerminalObserver::new(options)) {
        Ok(outcome) => outcome,
        Err(error) => return refuse_run(&error),
    };
    failed(outcome.failure.as_ref());
    if outcome.is_cut_off {
        let missing = match outcome.not_begun {
            0 => "",
            1 => "; one curve was not begun",
            _ => "; some curves were not begun",
        };
        say!("what was computed until then is written, stability of the last curve left out{missing}");
    }
    if !options.quiet {
        outcome.levels.iter().take(LEVELS).for_each(|level| _ = print(&level.text(outcome.level_unit)));
        if outcome.levels.len() > LEVELS {
            print(&format!("and {} more levels, in summary.json", outcome.levels.len() - LEVELS));
        }
        print(outcome.certificate.text("").trim_end());
    }
    _ = told::written(&file.scene.output_directory, file.scene.files.page, options.quiet);
    if outcome.is_complete() { Status::Done } else { Status::EndedEarly }
}

fn transient(file: &SceneFile, options: RunOptions) -> Status {
    let outcome = match nlmodes_run::transient::run(file, options.over(), &mut TerminalObserver::new(options)) {
        Ok(outcome) => outcome,
        Err(error) => return refuse_run(&error),
    };
    failed(outcome.failure.as_ref());
    if let Some(ended) = &outcome.ended {
        say!("{ended}; what was computed until then is written");
    }
    if !options.quiet {
        print(&outcome.lines.join("\n"));
    }
    _ = told::written(&file.scene.output_directory, file.scene.files.page, options.quiet);
    if outcome.is_complete() { Status::Done } else { Status::EndedEarly }
}

fn test(file: &SceneFile<TestScene>, options: RunOptions) -> Status {
    let outcome = match nlmodes_run::virtual_test::run(file, options.over(), &mut TerminalObserver::new(options)) {
        Ok(outcome) => outcome,
        Err(error) => return refuse_run(&error),
    };
    outcome.wrong.iter().for_each(|reason| say!("warning: {reason}"));
    _ = told::written(&file.scene.output_directory, true, options.quiet);
    if outcome.wrong.is_empty() { Status::Done } else { Status::EndedEarly }
}

fn failed(failure: Option<&Failure>) {
    if let Some(error) = failure {
        say!("error: {}", chain(error.as_ref()));
    }
}

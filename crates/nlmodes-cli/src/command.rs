//! From the command line to what it asks for.

use std::path::PathBuf;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, Parser};
use nlmodes_run::updating::updated;
use nlmodes_run::{chain, no_contact};
use nlmodes_scene::scene::TestScene;
use nlmodes_scene::{self as scenes, AnyScene, SceneError, SceneFile, memory, nearest};

use crate::arguments::{Command, CommandLine, Experiment, SceneArguments};
use crate::observer::TerminalObserver;
use crate::options::RunOptions;
use crate::terminal::{print, refuse, refuse_run, wants_colours};
use crate::{Status, check, compare, explore, extract, figures, interrupt, lcp, modes, new, study, told, verify};

/// Takes the command line apart and does what it says. Wrong calls end here with status 2.
pub fn run() -> Status {
    match CommandLine::try_parse().unwrap_or_else(|error| said_better(error).exit()).command {
        Command::Run { scene, out, options } => {
            let limit = scene.memory_limit;
            with(scenes::load_to_run(&scene.path, &scene.overrides), |scene| run_any(scene, out, limit, options))
        }
        Command::New(arguments) => new::write(&arguments),
        Command::Compare { scene, compare } => with_scene(&scene, |file| {
            if file.scene.n_contact_tables() == 0 {
                return refuse(&no_contact(&file));
            }
            with_parameters(file, |file| compare::run(file, &compare))
        }),
        Command::Lcp(arguments) => lcp::run(&arguments),
        Command::Study(command) => study::run(&command),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Modes { scene } => with_scene(&scene, |file| with_parameters(file, modes::run)),
        Command::Experiment(Experiment::Extract { scene, out, force, quiet }) => {
            extract_records(&scene, out, force, quiet)
        }
        Command::Check { scene: SceneArguments { path, overrides, memory_limit } } => {
            with(scenes::load_any(&path, &overrides), |scene| check_any(scene, memory_limit))
        }
        Command::Schema => print(&format!("{:#}", scenes::whole_schema())),
        Command::Explore(arguments) => explore::run(&arguments),
        Command::Figures(arguments) => figures::run(&arguments),
        Command::Columns { markdown: true } => print(nlmodes::report::columns::markdown().trim_end()),
        Command::Columns { markdown: false } => print(nlmodes::report::columns::text().trim_end()),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut CommandLine::command(), "nlmodes-cli", &mut script);
            print(String::from_utf8_lossy(&script).trim_end())
        }
    }
}

/// A command that does not exist is told the one that was meant only where that is a slip of the finger: clap's own guesses go further.
fn said_better(mut error: clap::Error) -> clap::Error {
    if error.kind() == ErrorKind::InvalidSubcommand {
        let typed = match error.get(ContextKind::InvalidSubcommand) {
            Some(ContextValue::String(typed)) => typed.clone(),
            _ => String::new(),
        };
        let command = CommandLine::command();
        let meant = nearest(&typed, command.get_subcommands().map(clap::Command::get_name));
        let meant = ContextValue::Strings(meant.map(str::to_owned).into_iter().collect());
        error.remove(ContextKind::SuggestedSubcommand);
        if meant != ContextValue::Strings(Vec::new()) {
            error.insert(ContextKind::SuggestedSubcommand, meant);
        }
    }
    error
}

/// Says what a scene would compute.
fn check_any(scene: AnyScene, limit: Option<memory::Limit>) -> Status {
    match scene {
        AnyScene::Structure(mut files) => {
            if let Err(said) = memory::admit(&mut files, limit) {
                return refuse(&said);
            }
            say_warnings(&files);
            each(files, |file| {
                if file.scene.n_contact_tables() == 0 {
                    return refuse(&no_contact(&file));
                }
                let checked = updated(file.clone()).and_then(|updated| {
                    let warning = nlmodes_run::mass::warning_of(&updated)?;
                    warning.iter().for_each(|text| say!("warning: {text}\n"));
                    nlmodes_run::check(&updated).map(|open| (warning, open))
                });
                match checked {
                    Ok((warning, open)) => print(&check::summary(&file.scene, open.as_ref(), warning.is_some())),
                    Err(error) => refuse_run(&error),
                }
            })
        }
        AnyScene::Records(file) => with_warnings(*file, |file| match nlmodes_run::records::files_are_there(&file) {
            Ok(()) => print(&check::records::summary(&file.scene)),
            Err(error) => refuse_run(&error),
        }),
        AnyScene::Test(file) => match memory::admit_test(&file, limit) {
            Ok(()) => with_warnings(*file, |file| match nlmodes_run::virtual_test::check(&file) {
                Ok(()) => print(&check::test::summary(&file.scene)),
                Err(error) => refuse_run(&error),
            }),
            Err(said) => refuse(&said),
        },
    }
}

/// Computes what the scene describes.
fn run_any(scene: AnyScene, out: Option<PathBuf>, limit: Option<memory::Limit>, options: RunOptions) -> Status {
    interrupt::install();
    match scene {
        AnyScene::Structure(mut files) => match memory::admit(&mut files, limit) {
            Ok(()) => run_structure(files, out, options),
            Err(said) => refuse(&said),
        },
        AnyScene::Test(file) => with_warnings(*file, |mut file| {
            if let Some(out) = out {
                file.scene.output_directory = out;
            }
            match memory::admit_test(&file, limit) {
                Ok(()) => run_test(&file, options),
                Err(said) => refuse(&said),
            }
        }),
        // `load_to_run` refuses these with the command that takes them.
        AnyScene::Records(_) => Status::Wrong,
    }
}

/// Runs a scene with one method, or several that differ in it.
fn run_structure(mut files: Vec<SceneFile>, out: Option<PathBuf>, options: RunOptions) -> Status {
    say_warnings(&files);
    if let Some(out) = &out {
        files.iter_mut().for_each(|file| file.scene.output_directory.clone_from(out));
    }
    if files.iter().any(|file| !file.scene.responses.is_empty()) {
        return match files.as_slice() {
            [file] => run_responses(file, options),
            several => refuse(&several[1].error_at(
                "method",
                "responses are computed with one method",
                "expected one table [method]",
                &[],
            )),
        };
    }
    let mut watch = TerminalObserver::new(options);
    match nlmodes_run::run(files, options.over(), &mut watch) {
        Ok(outcome) => {
            if let Some(error) = &outcome.failure {
                say!("error: {}", chain(error.as_ref()));
            }
            watch.compared(&outcome.compared);
            if outcome.is_complete() { watch.status } else { Status::EndedEarly }
        }
        Err(error) => refuse_run(&error),
    }
}

/// Runs the responses of a scene.
fn run_responses(file: &SceneFile, options: RunOptions) -> Status {
    let outcome = match nlmodes_run::responses::run(file, options.over(), &mut TerminalObserver::new(options)) {
        Ok(outcome) => outcome,
        Err(error) => return refuse_run(&error),
    };
    if let Some(error) = &outcome.failure {
        say!("error: {}", chain(error.as_ref()));
    }
    if outcome.is_cut_off {
        let missing = match outcome.not_begun {
            0 => "",
            1 => "; one curve was not begun",
            _ => "; some curves were not begun",
        };
        say!("what was computed until then is written, stability of the last curve left out{missing}");
    }
    if !options.quiet {
        print(&format!("Results in {}", file.scene.output_directory.display()));
    }
    if options.certify && !options.quiet {
        print(told::certificate("", &outcome.certificate).trim_end());
    }
    if outcome.is_complete() { Status::Done } else { Status::EndedEarly }
}

/// Runs a virtual test.
fn run_test(file: &SceneFile<TestScene>, options: RunOptions) -> Status {
    let outcome = match nlmodes_run::virtual_test::run(file, options.over(), &mut TerminalObserver::new(options)) {
        Ok(outcome) => outcome,
        Err(error) => return refuse_run(&error),
    };
    outcome.wrong.iter().for_each(|reason| say!("warning: {reason}"));
    if !options.quiet {
        print(&format!("Results in {}", file.scene.output_directory.display()));
    }
    if outcome.wrong.is_empty() { Status::Done } else { Status::EndedEarly }
}

/// Reads the scene of a structure, says what is wrong or looks wrong with it, and goes on if nothing stands in the way.
///
/// A scene with several methods is gone through for each of them.
fn with_scene(arguments: &SceneArguments, mut then: impl FnMut(SceneFile) -> Status) -> Status {
    let loaded = scenes::load_each_method(&arguments.path, &arguments.overrides);
    with(loaded, |mut files| {
        if let Err(said) = memory::admit(&mut files, arguments.memory_limit) {
            return refuse(&said);
        }
        say_warnings(&files);
        each(files, &mut then)
    })
}

/// One scene after the other, each below the name of its method where there are several, up to the first that cannot be done.
fn each(files: Vec<SceneFile>, mut then: impl FnMut(SceneFile) -> Status) -> Status {
    let count = files.len();
    for (k, file) in files.into_iter().enumerate() {
        let named = modes::say_method(&file.scene, k, count);
        let status = if named == Status::Done { then(file) } else { named };
        if status != Status::Done {
            return status;
        }
    }
    Status::Done
}

/// Extracts modal points from the records of a scene.
fn extract_records(arguments: &SceneArguments, out: Option<PathBuf>, force: bool, quiet: bool) -> Status {
    with(scenes::load_records(&arguments.path, &arguments.overrides), |file| {
        with_warnings(file, |mut file| {
            if let Some(out) = out {
                file.scene.output_directory = out;
            }
            match memory::admit_records(&file, arguments.memory_limit) {
                Ok(()) => extract::run(&file, RunOptions { force, quiet, ..RunOptions::default() }),
                Err(said) => refuse(&said),
            }
        })
    })
}

/// Says what is wrong with the scene, or goes on.
fn with<T>(loaded: Result<T, SceneError>, then: impl FnOnce(T) -> Status) -> Status {
    match loaded {
        Ok(scene) => then(scene),
        Err(error) => refuse(&error),
    }
}

/// Updates the parameters that the scene asks for, says so, and goes on.
fn with_parameters(file: SceneFile, then: impl FnOnce(&SceneFile) -> Status) -> Status {
    let file = match updated(file) {
        Ok(file) => file,
        Err(error) => return refuse_run(&error),
    };
    let said = file.scene.updating.as_ref().and_then(modes::updated);
    match said.map_or(Status::Done, |text| print(&format!("{text}\n"))) {
        Status::Done => then(&file),
        status => status,
    }
}

/// Says what looks wrong with the scenes of one file, each thing once.
fn say_warnings(files: &[SceneFile]) {
    let warnings = scenes::warnings_text(files, wants_colours());
    if !warnings.is_empty() {
        say!("{warnings}\n");
    }
}

/// Says what looks wrong with the scene, and goes on.
fn with_warnings<S>(file: SceneFile<S>, then: impl FnOnce(SceneFile<S>) -> Status) -> Status {
    if !file.warnings.is_empty() {
        say!("{}\n", file.warnings_text(wants_colours()));
    }
    then(file)
}

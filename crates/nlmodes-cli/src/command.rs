//! Dispatch of the command line.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, Parser};
use nlmodes_run::updating::{in_words, updated};
use nlmodes_run::{RunError, no_contact};
use nlmodes_scene::outline::Outline;
use nlmodes_scene::{self as scenes, AnyScene, SceneError, SceneFile, memory, nearest};

#[cfg(not(all(feature = "explore", feature = "print")))]
use crate::absent;
use crate::arguments::{Command, CommandLine, Experiment, SceneArguments, SchemaOf};
#[cfg(feature = "explore")]
use crate::explore;
#[cfg(feature = "print")]
use crate::figures;
use crate::observer::TerminalObserver;
use crate::options::RunOptions;
use crate::terminal::{print, refuse, refuse_run, wants_colours};
use crate::{Status, at, compare, design, extract, follow, lcp, modes, new, program, run, settle, study, verify};

/// Parses the arguments of the process and executes the command. Wrong calls end the process with status 2.
pub fn run() -> Status {
    run_with(std::env::args_os().collect())
}

/// As [`run`], with these arguments, of which the first one is the name of the program.
pub fn run_with(arguments: Vec<OsString>) -> Status {
    program::called_by(&arguments);
    let parsed = CommandLine::try_parse_from(&arguments);
    match parsed.unwrap_or_else(|error| said_better(error, &arguments).exit()).command {
        Command::Run { scene, out, options } => {
            with(&scene, out, scenes::load_to_run, |scene| run::run(scene, options))
        }
        Command::New(arguments) => new::write(&arguments),
        Command::Compare { scene, compare } => with_structure(&scene, |file| match file.scene.n_contact_tables() {
            0 => refuse(&no_contact(&file)),
            _ => with_parameters(file, |file| compare::run(file, &compare)),
        }),
        Command::Lcp(arguments) => lcp::run(&arguments),
        Command::Study(command) => study::run(&command),
        Command::At(arguments) => at::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Settle(arguments) => settle::run(&arguments),
        Command::Follow(arguments) => follow::run(&arguments),
        Command::Modes { mut scene, count } => {
            scene.overrides.extend(count.map(|count| format!("reduction.modes={count}")));
            with_structure(&scene, |file| with_parameters(file, modes::run))
        }
        Command::Experiment(Experiment::Extract { scene, out, force, quiet }) => {
            let options = RunOptions { force, quiet, ..RunOptions::default() };
            with(&scene, out, scenes::load_records, |scene| match scene {
                AnyScene::Records(file) => extract::run(&file, options),
                _ => Status::Wrong,
            })
        }
        Command::Experiment(Experiment::Design { scene, out, quiet }) => {
            let options = RunOptions { quiet, ..RunOptions::default() };
            with(&scene, out, scenes::load_to_run, |scene| design::run(scene, options))
        }
        Command::Check { scene } => with(&scene, None, scenes::load_any, check),
        Command::Schema { of: SchemaOf::Scene } => print(&format!("{:#}", scenes::whole_schema())),
        Command::Schema { of: SchemaOf::Study } => print(&format!("{:#}", nlmodes_study::schema())),
        #[cfg(feature = "explore")]
        Command::Explore(arguments) => explore::run(&arguments),
        #[cfg(not(feature = "explore"))]
        Command::Explore(_) => absent::refuse("explore", "explore"),
        #[cfg(feature = "print")]
        Command::Figures(arguments) => figures::run(&arguments),
        #[cfg(not(feature = "print"))]
        Command::Figures(_) => absent::refuse("figures", "print"),
        Command::Columns { markdown: true } => print(nlmodes::report::columns::markdown().trim_end()),
        Command::Columns { markdown: false } => print(nlmodes::report::columns::text().trim_end()),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut CommandLine::command(), "nlmodes-cli", &mut script);
            print(String::from_utf8_lossy(&script).trim_end())
        }
    }
}

/// For a scene in place of a command, `run` is suggested; for an unknown command a similar one only if it is a likely
/// typing error: clap's own guesses go further. An unknown option is not a value either; `at` lists the quantities that
/// it accepts.
fn said_better(mut error: clap::Error, arguments: &[OsString]) -> clap::Error {
    if error.kind() == ErrorKind::InvalidSubcommand {
        let typed = match error.get(ContextKind::InvalidSubcommand) {
            Some(ContextValue::String(typed)) => typed.clone(),
            _ => String::new(),
        };
        let command = CommandLine::command();
        let own = arguments.get(1).and_then(|own| command.find_subcommand(own)).unwrap_or(&command);
        let meant = nearest(&typed, own.get_subcommands().map(clap::Command::get_name));
        let meant = ContextValue::Strings(meant.map(str::to_owned).into_iter().collect());
        error.remove(ContextKind::SuggestedSubcommand);
        if Path::new(&typed).extension().is_some_and(|ending| ending == "toml") {
            let text = format!("a scene follows a command: nlmodes-cli run {typed}");
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![text.into()]));
            return error;
        }
        if meant != ContextValue::Strings(Vec::new()) {
            error.insert(ContextKind::SuggestedSubcommand, meant);
        }
    }
    if error.kind() == ErrorKind::UnknownArgument {
        error.remove(ContextKind::Suggested);
        let is_at = arguments.get(1).is_some_and(|command| command == "at");
        if is_at && error.get(ContextKind::SuggestedArg).is_none() {
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![at::PLACES.into()]));
        }
    }
    error
}

/// Reads a scene, prints errors, warnings and memory limits, and continues if there is no error; its results go to
/// `out`.
fn with(
    arguments: &SceneArguments,
    out: Option<PathBuf>,
    load: impl FnOnce(&Path, &[String]) -> Result<AnyScene, SceneError>,
    then: impl FnOnce(AnyScene) -> Status,
) -> Status {
    let loaded = load(&arguments.path, &arguments.overrides);
    let admitted = loaded.and_then(|mut scene| memory::admit_any(&mut scene, arguments.memory_limit).map(|()| scene));
    match admitted {
        Ok(mut scene) => {
            let warnings = scene.warnings_text(wants_colours());
            if !warnings.is_empty() {
                say!("{warnings}\n");
            }
            out.iter().for_each(|out| scene.set_output_directory(out));
            then(scene)
        }
        Err(error) => refuse(&error),
    }
}

/// The same for the scene of a structure; one with several methods is processed for each of them.
fn with_structure(arguments: &SceneArguments, then: impl FnMut(SceneFile) -> Status) -> Status {
    with(arguments, None, scenes::load_structure, |scene| match scene {
        AnyScene::Structure(files) => each(files, then),
        _ => Status::Wrong,
    })
}

/// One scene after the other, with the name of the method as heading if there are several, up to the first that fails.
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

/// Updates the parameters given in the scene, reports it, and continues.
fn with_parameters(file: SceneFile, then: impl FnOnce(&SceneFile) -> Status) -> Status {
    let file = match updated(file) {
        Ok(file) => file,
        Err(error) => return refuse_run(&error),
    };
    let said = file.scene.updating.as_ref().and_then(in_words);
    match said.map_or(Status::Done, |text| print(&format!("{text}\n"))) {
        Status::Done => then(&file),
        status => status,
    }
}

/// Prints what a scene would compute.
fn check(scene: AnyScene) -> Status {
    let say = |checked: Result<Outline, RunError>| match checked {
        Ok(outline) => print(&outline.to_string()),
        Err(error) => refuse_run(&error),
    };
    // A warning of one method does not apply to another: each has its own observer.
    let observer = || TerminalObserver::new(RunOptions::default());
    match scene {
        AnyScene::Structure(files) => each(files, |file| say(nlmodes_run::check(&file, &mut observer()))),
        AnyScene::Records(file) => say(nlmodes_run::check_records(&file, &mut observer())),
        AnyScene::Test(file) => say(nlmodes_run::check_test(&file, &mut observer())),
    }
}

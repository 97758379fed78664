//! The command line.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::{Args, CommandFactory, Parser, Subcommand};
use clap_complete::Shell;
use serde_json::Value;

use crate::claim::{Claim, Over, identity};
use crate::config::{self, AnyScene, Refused, SceneFile, memory, wants_colours};
use crate::options::RunOptions;
use crate::{
    Status, check, compare, experiment, interrupt, lcp, links, modes, new, run as study, updating, verify, virtual_test,
};

/// Nonlinear modes of structures with one-sided contact
///
/// A scene, a TOML file, describes a rod or beam, its stops, and what is to be computed. From it come the branch of a nonlinear mode
/// (frequency, shape and contact force over energy), a virtual test of it, or the same from measured records: as tables, figures and a page.
#[derive(Debug, Parser)]
#[command(name = "nlmodes-cli", version, arg_required_else_help = true, after_help = EXAMPLES)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

const EXAMPLES: &str = "\
First steps:
  nlmodes-cli new rod my_rod.toml             write a scene with comments
  nlmodes-cli check my_rod.toml               is it sound, and what would be computed?
  nlmodes-cli run my_rod.toml                 compute it; open results/my_rod/report.html in a browser
  nlmodes-cli run my_rod.toml --set method.harmonics=5 --out results/my_rod_5
  nlmodes-cli run my_rod.toml --resume        go on after Ctrl-C, a power cut or a full disk

Exit status:
  0  done
  1  the computation ended early: what was found is written, and why it ended is said
  2  the scene or the call is wrong: nothing is written";

const SET_HELP: &str = "\
Replaces a value of the scene, or adds one. The key is a dotted path; stops go by number, from 0. May be given several times.";

#[derive(Debug, Subcommand)]
enum Command {
    /// Compute the branch, or run the virtual test, that a scene describes, and write its tables and figures
    #[command(after_help = "\
Examples:
  nlmodes-cli run configs/rod.toml                               results go to the directory that the scene names
  nlmodes-cli run configs/beam.toml --set contact.0.gap_m=0.5e-3 --out results/half-gap
  nlmodes-cli run configs/rod.toml --set 'method.harmonics=[1,2,3]' --out results/harmonics
  nlmodes-cli run configs/rod.toml --resume                      go on where a run was interrupted

Every point is on disk when it is found. Ctrl-C ends the step in progress and writes summary and figures; a second one ends at once.
A directory with the results of another scene is left as it is, unless `--force` is given.")]
    Run {
        #[command(flatten)]
        scene: SceneArguments,
        /// Directory of the result files, instead of the one that the scene names
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        #[command(flatten)]
        options: RunOptions,
    },
    /// Write a scene with comments, to begin with
    #[command(after_help = "\
Examples:
  nlmodes-cli new rod                        writes rod.toml
  nlmodes-cli new virtual-test my_test.toml

A file that is there already is left as it is.")]
    New(new::Arguments),
    /// Print the linear modes, with and without mass at the contacts
    #[command(after_help = "Example:\n  nlmodes-cli modes configs/beam.toml --set structure.elements=40")]
    Modes {
        #[command(flatten)]
        scene: SceneArguments,
    },
    /// Compute the branch of a scene with several contact solvers, and compare time, iterations, violation and result
    #[command(after_help = "\
Example:
  nlmodes-cli compare configs/beam_ten_stops.toml --contact-solver active-set,lemke")]
    Compare {
        #[command(flatten)]
        scene: SceneArguments,
        #[command(flatten)]
        compare: compare::Arguments,
    },
    /// Solve contact problems 0 ≤ A λ + b ⊥ λ ≥ 0 of a NumPy archive
    #[command(after_help = "\
Example:
  python -c 'import numpy as n; n.savez(\"problem.npz\", A=n.array([[2., 1.], [1., 2.]]), b=n.array([[-1., 1.], [-1., -1.]]))'
  nlmodes-cli lcp problem.npz --contact-solver lemke --out solution.npz

Exit status 1 where a sample has no solution, 2 where the archive holds no contact problem.")]
    Lcp(lcp::Arguments),
    /// Measured records
    #[command(subcommand)]
    Experiment(Experiment),
    /// Start the full structure from a computed point, and say by how much it fails to return after a period
    #[command(after_help = "\
Example:
  nlmodes-cli run configs/rod.toml
  nlmodes-cli verify results/rod --point 100

Exit status 1 where the motion cannot be integrated, 2 where the directory holds no such point.")]
    Verify(verify::Arguments),
    /// Read and check a scene, and say what would be computed; computes no more than linear modes, writes nothing
    #[command(after_help = "Example:\n  nlmodes-cli check configs/rod.toml --set method.switching=sampled")]
    Check {
        #[command(flatten)]
        scene: SceneArguments,
    },
    /// Print the JSON schema of a scene: every key with its meaning, unit, limits and default
    #[command(after_help = "Example:\n  nlmodes-cli schema > scene.schema.json")]
    Schema,
    /// Print completions of this command line for a shell
    #[command(after_help = "\
Examples:
  nlmodes-cli completions bash > ~/.local/share/bash-completion/completions/nlmodes-cli
  nlmodes-cli completions zsh > ~/.zfunc/_nlmodes-cli            with ~/.zfunc in $fpath
  nlmodes-cli completions fish > ~/.config/fish/completions/nlmodes-cli.fish

They work in the next shell that is opened.")]
    Completions {
        /// The shell
        shell: Shell,
    },
}

#[derive(Debug, Subcommand)]
enum Experiment {
    /// Turn measured records into points of a nonlinear mode: a table, figures, and what a careful experimenter wants to be told
    #[command(after_help = "\
Example:
  nlmodes-cli experiment extract configs/measured_record.toml --out results/measured

Exit status 1 where a record gives no point, with the reason in the table; 2 where a file cannot be read, and nothing is written.")]
    Extract {
        #[command(flatten)]
        scene: SceneArguments,
        /// Directory of the result files, instead of the one that the scene names
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Overwrite the results of another scene
        #[arg(long)]
        force: bool,
        /// Warnings and errors only
        #[arg(long, short)]
        quiet: bool,
    },
}

#[derive(Debug, Args)]
struct SceneArguments {
    /// The scene, a TOML file
    #[arg(value_name = "SCENE")]
    path: PathBuf,
    #[arg(long = "set", value_name = "KEY=VALUE", help = SET_HELP, allow_hyphen_values = true)]
    overrides: Vec<String>,
    /// Most memory that the scene may take, as 8GiB; default: three quarters of the machine's
    #[arg(long, value_name = "SIZE")]
    memory_limit: Option<memory::Limit>,
}

/// Takes the command line apart and does what it says. Wrong calls end here with status 2.
pub fn run() -> Status {
    match CommandLine::parse().command {
        Command::Run { scene, out, options } => {
            let limit = scene.memory_limit;
            with(config::load_to_run(&scene.path, &scene.overrides), |scene| run_any(scene, out, limit, options))
        }
        Command::New(arguments) => new::write(&arguments),
        Command::Compare { scene, compare } => with_scene(&scene, |file| {
            if file.scene.contacts.is_empty() {
                return no_contact(&file);
            }
            with_parameters(file, false, |file| compare::run(file, &compare))
        }),
        Command::Lcp(arguments) => lcp::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Modes { scene } => with_scene(&scene, |file| with_parameters(file, false, modes::modes)),
        Command::Experiment(Experiment::Extract { scene, out, force, quiet }) => extract(&scene, out, force, quiet),
        Command::Check { scene: SceneArguments { path, overrides, memory_limit } } => {
            with(config::load_any(&path, &overrides), |scene| match scene {
                AnyScene::Structure(mut files) => {
                    if let Err(said) = memory::admit(&mut files, memory_limit) {
                        return refuse(&said);
                    }
                    say_warnings(&files);
                    each(files, |file| {
                        if file.scene.contacts.is_empty() {
                            return no_contact(&file);
                        }
                        match with_parameters(file.clone(), true, study::check) {
                            Status::Done => print(&check::summary(&file.scene)),
                            status => status,
                        }
                    })
                }
                AnyScene::Records(file) => with_warnings(*file, |file| print(&experiment::summary(&file.scene))),
                AnyScene::Test(file) => match memory::admit_test(&file, memory_limit) {
                    Ok(()) => with_warnings(*file, |file| match virtual_test::check(&file) {
                        Status::Done => print(&virtual_test::summary(&file.scene)),
                        status => status,
                    }),
                    Err(said) => refuse(&said),
                },
            })
        }
        Command::Schema => print(&format!("{:#}", config::whole_schema())),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut CommandLine::command(), "nlmodes-cli", &mut script);
            print(String::from_utf8_lossy(&script).trim_end())
        }
    }
}

/// Computes what the scene describes.
fn run_any(scene: AnyScene, out: Option<PathBuf>, limit: Option<memory::Limit>, options: RunOptions) -> Status {
    interrupt::install();
    match scene {
        AnyScene::Structure(mut files) => match memory::admit(&mut files, limit) {
            Ok(()) => run_each(files, out, options),
            Err(said) => refuse(&said),
        },
        AnyScene::Test(file) => with_warnings(*file, |mut file| {
            if let Some(out) = out {
                file.scene.output_directory = out;
            }
            let admitted = memory::admit_test(&file, limit).and_then(|()| links::refuse(&file.scene.output_directory));
            match admitted {
                Ok(()) => virtual_test::run(&file, options),
                Err(said) => refuse(&said),
            }
        }),
        // `load_to_run` refuses these with the command that takes them.
        AnyScene::Records(_) => Status::Wrong,
    }
}

/// Reads the scene of a structure, says what is wrong or looks wrong with it, and goes on if nothing stands in the way.
///
/// A scene with several methods is gone through for each of them.
fn with_scene(arguments: &SceneArguments, mut then: impl FnMut(SceneFile) -> Status) -> Status {
    let loaded = config::load_each_method(&arguments.path, &arguments.overrides);
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
        let named = say_method(&file, k, count);
        let status = if named == Status::Done { then(file) } else { named };
        if status != Status::Done {
            return status;
        }
    }
    Status::Done
}

/// Says of which of several methods the lines that follow are.
fn say_method(file: &SceneFile, number: usize, count: usize) -> Status {
    if count < 2 {
        return Status::Done;
    }
    let space = if number > 0 { "\n" } else { "" };
    print(&format!("{space}[[method]] {} of {count}: {}", number + 1, file.scene.method.kind.name()))
}

/// Runs a scene with one method, or several that differ in it.
fn run_each(mut files: Vec<SceneFile>, out: Option<PathBuf>, options: RunOptions) -> Status {
    say_warnings(&files);
    for file in &mut files {
        if let Some(out) = &out {
            file.scene.output_directory.clone_from(out);
        }
        if file.scene.contacts.is_empty() {
            return no_contact(file);
        }
        if let Err(said) = links::refuse(&file.scene.output_directory) {
            return refuse(&said);
        }
    }
    let claim = match claim(&files, options) {
        Ok(claim) => claim,
        Err(status) => return status,
    };
    let mut updated = Vec::new();
    let count = files.len();
    for (k, file) in files.into_iter().enumerate() {
        if file.scene.updating.is_some() && !options.quiet {
            say_method(&file, k, count);
        }
        let status = with_parameters(file, options.quiet, |file| {
            updated.push(file.clone());
            Status::Done
        });
        if status != Status::Done {
            return status;
        }
    }
    study::run(&updated, &claim, options)
}

/// The output directory of scenes that differ in their method only.
fn claim(files: &[SceneFile], options: RunOptions) -> Result<Claim, Status> {
    let Some(first) = files.first() else { return Err(Status::Wrong) };
    let scene = |file: &SceneFile| identity(serde_json::to_value(&file.scene).unwrap_or_default());
    let scenes = Value::Array(files.iter().map(scene).collect());
    Claim::new(&first.scene.output_directory, &first.document, scenes, Over::of(options))
}

/// The same for a scene of measured records.
fn extract(arguments: &SceneArguments, out: Option<PathBuf>, force: bool, quiet: bool) -> Status {
    with(config::load_records(&arguments.path, &arguments.overrides), |file| {
        with_warnings(file, |mut file| {
            if let Some(out) = out {
                file.scene.output_directory = out;
            }
            let limit = arguments.memory_limit;
            let admitted =
                memory::admit_records(&file, limit).and_then(|()| links::refuse(&file.scene.output_directory));
            match admitted {
                Ok(()) => experiment::extract(&file, RunOptions { force, quiet, ..RunOptions::default() }),
                Err(said) => refuse(&said),
            }
        })
    })
}

/// Says what is wrong with the scene, or goes on.
fn with<T>(loaded: Result<T, Box<Refused>>, then: impl FnOnce(T) -> Status) -> Status {
    match loaded {
        Ok(scene) => then(scene),
        Err(refused) => {
            say!("{}", refused.text(wants_colours()));
            Status::Wrong
        }
    }
}

/// Updates the parameters that the scene asks for, says so, and goes on.
fn with_parameters(file: SceneFile, quiet: bool, then: impl FnOnce(&SceneFile) -> Status) -> Status {
    match updating::updated(file) {
        Ok(file) => {
            let said = file.scene.updating.as_ref().and_then(updating::said).filter(|_| !quiet);
            match said.map_or(Status::Done, |text| print(&format!("{text}\n"))) {
                Status::Done => then(&file),
                status => status,
            }
        }
        Err(status) => status,
    }
}

/// Says what looks wrong with the scenes of one file, each thing once.
fn say_warnings(files: &[SceneFile]) {
    let warnings = config::warnings_text(files);
    if !warnings.is_empty() {
        say!("{warnings}\n");
    }
}

/// Says what looks wrong with the scene, and goes on.
fn with_warnings<S>(file: SceneFile<S>, then: impl FnOnce(SceneFile<S>) -> Status) -> Status {
    if !file.warnings.is_empty() {
        say!("{}\n", file.warnings_text());
    }
    then(file)
}

/// Says what stands in the way of a sound scene.
fn refuse(said: &str) -> Status {
    say!("{said}");
    Status::Wrong
}

fn no_contact(file: &SceneFile) -> Status {
    let help = ["a stop stands under a heading [[contact]]; `nlmodes-cli modes` computes the linear modes without one"];
    say!("{}", file.error_at("contact", "without a stop there is no nonlinear mode to compute", "", &help));
    Status::Wrong
}

/// Prints a line or several to standard output. A reader that has gone away, as in `| head`, is no error.
pub(crate) fn print(text: &str) -> Status {
    match writeln!(io::stdout(), "{text}") {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            say!("error: cannot write to standard output: {error}");
            Status::EndedEarly
        }
        _ => Status::Done,
    }
}

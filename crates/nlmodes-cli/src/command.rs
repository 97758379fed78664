//! The command line.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use crate::config::{self, AnyScene, Refused, SceneFile, wants_colours};
use crate::{
    Status, check, compare, experiment, lcp, links, memory, modes, run as study, updating, verify, virtual_test,
};

/// Nonlinear modes of structures with one-sided contact
#[derive(Debug, Parser)]
#[command(name = "nlmodes-cli", version, arg_required_else_help = true, after_help = EXAMPLES)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

const EXAMPLES: &str = "\
Examples:
  nlmodes-cli check configs/rod.toml                             is the scene sound, and what would be computed?
  nlmodes-cli run configs/rod.toml                               compute it; results go to results/rod
  nlmodes-cli run configs/rod.toml --set method.harmonics=5 --out results/rod5

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
Example:
  nlmodes-cli run configs/beam.toml --set contact.0.gap_m=0.5e-3 --out results/half-gap")]
    Run {
        #[command(flatten)]
        scene: SceneArguments,
        /// Directory of the result files, instead of the one that the scene names
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// No progress; warnings and errors only
        #[arg(long, short)]
        quiet: bool,
    },
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
    /// Read and check a scene, and say what would be computed; computes and writes nothing
    #[command(after_help = "Example:\n  nlmodes-cli check configs/rod.toml --set method.switching=sampled")]
    Check {
        #[command(flatten)]
        scene: SceneArguments,
    },
    /// Print the JSON schema of a scene: every key with its meaning, unit, limits and default
    #[command(after_help = "Example:\n  nlmodes-cli schema > scene.schema.json")]
    Schema,
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
        Command::Run { scene, out, quiet } => {
            let limit = scene.memory_limit;
            with(config::load_to_run(&scene.path, &scene.overrides), |scene| run_any(scene, out, limit, quiet))
        }
        Command::Compare { scene, compare } => with_scene(&scene, |file| {
            if file.scene.contacts.is_empty() {
                return no_contact(&file);
            }
            with_parameters(file, false, |file| compare::run(file, &compare))
        }),
        Command::Lcp(arguments) => lcp::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Modes { scene } => with_scene(&scene, |file| with_parameters(file, false, modes::modes)),
        Command::Experiment(Experiment::Extract { scene, out, quiet }) => extract(&scene, out, quiet),
        Command::Check { scene: SceneArguments { path, overrides, memory_limit } } => {
            with(config::load_any(&path, &overrides), |scene| match scene {
                AnyScene::Structure(mut files) => {
                    if let Err(said) = memory::admit(&mut files, memory_limit) {
                        return refuse(&said);
                    }
                    say_warnings(&files);
                    each(files, |file| print(&check::summary(&file.scene)))
                }
                AnyScene::Records(file) => with_warnings(*file, |file| print(&experiment::summary(&file.scene))),
                AnyScene::Test(file) => match memory::admit_test(&file, memory_limit) {
                    Ok(()) => with_warnings(*file, |file| print(&virtual_test::summary(&file.scene))),
                    Err(said) => refuse(&said),
                },
            })
        }
        Command::Schema => print(&format!("{:#}", config::whole_schema())),
    }
}

/// Computes what the scene describes.
fn run_any(scene: AnyScene, out: Option<PathBuf>, limit: Option<memory::Limit>, quiet: bool) -> Status {
    match scene {
        AnyScene::Structure(mut files) => match memory::admit(&mut files, limit) {
            Ok(()) => run_each(files, out, quiet),
            Err(said) => refuse(&said),
        },
        AnyScene::Test(file) => with_warnings(*file, |mut file| {
            if let Some(out) = out {
                file.scene.output_directory = out;
            }
            let admitted = memory::admit_test(&file, limit).and_then(|()| links::refuse(&file.scene.output_directory));
            match admitted {
                Ok(()) => virtual_test::run(&file, quiet),
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

/// One scene after the other, up to the first that cannot be done.
fn each(files: Vec<SceneFile>, then: impl FnMut(SceneFile) -> Status) -> Status {
    files.into_iter().map(then).find(|status| *status != Status::Done).unwrap_or(Status::Done)
}

/// Runs a scene with one method, or several that differ in it.
fn run_each(mut files: Vec<SceneFile>, out: Option<PathBuf>, quiet: bool) -> Status {
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
    let mut updated = Vec::new();
    for file in files {
        let status = with_parameters(file, quiet, |file| {
            updated.push(file.clone());
            Status::Done
        });
        if status != Status::Done {
            return status;
        }
    }
    study::run(&updated, quiet)
}

/// The same for a scene of measured records.
fn extract(arguments: &SceneArguments, out: Option<PathBuf>, quiet: bool) -> Status {
    with(config::load_records(&arguments.path, &arguments.overrides), |file| {
        with_warnings(file, |mut file| {
            if let Some(out) = out {
                file.scene.output_directory = out;
            }
            let limit = arguments.memory_limit;
            let admitted =
                memory::admit_records(&file, limit).and_then(|()| links::refuse(&file.scene.output_directory));
            match admitted {
                Ok(()) => experiment::extract(&file, quiet),
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

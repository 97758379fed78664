//! The commands and options of the program, with their help.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;
use nlmodes_scene::memory;

#[cfg(not(all(feature = "explore", feature = "print")))]
use crate::absent;
#[cfg(feature = "explore")]
use crate::explore;
#[cfg(feature = "print")]
use crate::figures;
use crate::options::RunOptions;
use crate::{at, compare, follow, lcp, new, settle, study, verify};

/// Nonlinear modes of structures with one-sided contact
///
/// A scene, a TOML file, describes a structure, its stops, and the computation. The results are the branch of a
/// nonlinear mode (frequency, shape and contact force over energy), responses, a virtual test, or modes from measured
/// records, as tables, figures and a page.
#[derive(Debug, Parser)]
#[command(name = "nlmodes-cli", version, arg_required_else_help = true, after_help = EXAMPLES)]
pub struct CommandLine {
    #[command(subcommand)]
    pub command: Command,
}

const EXAMPLES: &str = "\
First steps:
  nlmodes-cli new rod my_rod.toml             write a scene with comments
  nlmodes-cli check my_rod.toml               is it valid, and what would be computed?
  nlmodes-cli run my_rod.toml                 compute it; open results/my_rod/report.html in a browser
  nlmodes-cli run my_rod.toml --set method.harmonics=5 --out results/my_rod_5
  nlmodes-cli run my_rod.toml --resume        continue after Ctrl-C, a power cut or a full disk

Exit status:
  0  done
  1  the computation ended early: what was found is written, and the reason is given
  2  the scene or the call is wrong: nothing is written";

const SET_HELP: &str = "\
Replaces a value of the scene, or adds one. The key is a dotted path; stops go by number, from 0. May be given \
several times.";

// The command. No doc comments here: they would appear in the help.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Compute the branch or run the virtual test of a scene, and write tables and figures
    #[command(after_help = "\
Examples:
  nlmodes-cli run configs/rod.toml                               results go to the folder named in the scene
  nlmodes-cli run configs/beam.toml --set contact.0.gap_m=0.5e-3 --out results/half-gap
  nlmodes-cli run configs/rod.toml --set 'method.harmonics=[1,2,3]' --out results/harmonics
  nlmodes-cli run configs/rod.toml --resume                      continue an interrupted run

Every point is on disk when it is found, in branch.csv or, of responses, in steps.jsonl. Ctrl-C ends the computation \
    where it is and writes summary and figures; a second one ends at once.
A directory with the results of another scene is left alone, unless `--force` is given.")]
    Run {
        #[command(flatten)]
        scene: SceneArguments,
        /// Directory of the result files, instead of the one given in the scene
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        #[command(flatten)]
        options: RunOptions,
    },
    /// Write a commented scene to start from
    #[command(after_help = "\
Examples:
  nlmodes-cli new rod                        writes rod.toml
  nlmodes-cli new virtual-test my_test.toml

An existing file is left alone.")]
    New(new::Arguments),
    /// Print the linear modes, with and without mass at the contacts
    #[command(after_help = "Example:\n  nlmodes-cli modes configs/beam.toml --set structure.elements=40")]
    Modes {
        #[command(flatten)]
        scene: SceneArguments,
        /// Number of free-interface modes, in place of `reduction.modes`
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
        count: Option<u32>,
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
  python -c 'import numpy as n; n.savez(\"problem.npz\", A=n.array([[2., 1.], [1., 2.]]), b=n.array([[-1., 1.], [-1., \
      -1.]]))'
  nlmodes-cli lcp problem.npz --contact-solver lemke --out solution.npz

Exit status 1 where a sample has no solution, 2 where the archive holds no contact problem.")]
    Lcp(lcp::Arguments),
    /// Compute a quantity over parameters: thousands of branches, their table, scatter and sensitivities
    #[command(subcommand)]
    Study(study::Command),
    /// Measured records
    #[command(subcommand)]
    Experiment(Experiment),
    /// Print the results at a frequency or an energy: each motion, with the quantities of every stop
    #[command(after_help = "\
Examples:
  nlmodes-cli at results/beam_two_stops --frequency-hz 50
  nlmodes-cli at results/rod --energy-j 1e9 --json

A branch may pass a frequency several times, each time with another motion: all of them are printed.

Exit status 1 where none passes it, which `answer` says of each in JSON; 2 where there are no results or a table is \
    damaged.")]
    At(at::Arguments),
    /// Integrate the full structure from a computed point, and print by how much it fails to return after a period
    #[command(after_help = "\
Example:
  nlmodes-cli run configs/rod.toml
  nlmodes-cli verify results/rod --point 100

Exit status 1 where the motion cannot be integrated, 2 where the directory holds no such point.")]
    Verify(verify::Arguments),
    /// Say what the motion of a forced response becomes once it is disturbed: periodic, two lines, irregular, or
    /// another
    #[command(after_help = "\
Example:
  nlmodes-cli run configs/beam_responses.toml
  nlmodes-cli settle results/beam_responses --point 60

The motion is disturbed along the vector of its largest multiplier and integrated exactly. What it becomes is also \
    written in settled.json beside the results.

Exit status 1 where the motion cannot be integrated, 2 where the directory holds no such point.")]
    Settle(settle::Arguments),
    /// Follow a fold, a first touch, a phase resonance, or a mode at an energy over a parameter: the jump frequency
    /// over a gap
    #[command(after_help = "\
Examples:
  nlmodes-cli follow response.toml --over contact.0.gap_m --from 0.8e-3 --to 1.2e-3 --level 15
  nlmodes-cli follow response.toml --of touch --over contact.0.gap_m --from 0.8e-3 --to 1.2e-3 --level 15
  nlmodes-cli follow configs/rod.toml --of mode --energy-j 1e9 --over contact.0.gap_m --from 0.3 --to 0.8

The parameters are those of [[sensitivity]]. Each fold of the response is followed both ways from the value of the \
    scene, also through values where it turns back.

Exit status 1 where a curve ends before the window does, 2 where the scene has no such motion.")]
    Follow(follow::Arguments),
    /// Read and check a scene, and print what would be computed; computes only linear modes and writes nothing
    #[command(after_help = "Example:\n  nlmodes-cli check configs/rod.toml --set method.switching=sampled")]
    Check {
        #[command(flatten)]
        scene: SceneArguments,
    },
    /// Print the JSON schema of a scene: every key with its meaning, unit, limits and default
    #[command(after_help = "\
Examples:
  nlmodes-cli schema > nlmodes.schema.json
  nlmodes-cli schema study > study.schema.json

Editors with TOML schemas (taplo, Even Better TOML) read it from a first line `#:schema nlmodes.schema.json`.")]
    Schema {
        /// The kind of file
        #[arg(value_enum, default_value_t = SchemaOf::Scene)]
        of: SchemaOf,
    },
    /// Change a scene with sliders in a browser, with its branch recomputed as they move
    #[command(after_help = "\
Examples:
  nlmodes-cli explore configs/beam_two_stops.toml
  nlmodes-cli explore configs/rod.toml --set method.harmonics=1

The page can be opened on this machine only, by whoever has its address. Only what you save is written, beside the \
    scene. Ctrl-C ends.")]
    #[cfg(feature = "explore")]
    Explore(explore::Arguments),
    /// Not in this build: a page with sliders, on which the branch is computed anew while one drags
    #[cfg(not(feature = "explore"))]
    Explore(absent::Arguments),
    /// Convert the figures of results to PDF or PNG, for papers and slides
    #[command(after_help = "\
Examples:
  nlmodes-cli figures results/beam                                       a PDF beside each SVG
  nlmodes-cli figures results/beam/frequency_energy.svg --format png --dots-per-inch 600
  nlmodes-cli figures results/beam --width-mm 90 --no-titles             drawn anew for one column

The width of those that a run writes, and their titles, are output.figure_width_mm and output.figure_titles of the \
    scene.")]
    #[cfg(feature = "print")]
    Figures(figures::Arguments),
    /// Not in this build: convert the figures of results to PDF or PNG
    #[cfg(not(feature = "print"))]
    Figures(absent::Arguments),
    /// Print the meaning of every results file, its columns and arrays, with units and signs
    #[command(after_help = "Example:\n  nlmodes-cli columns | less")]
    Columns {
        /// As Markdown
        #[arg(long)]
        markdown: bool,
    },
    /// Print shell completions
    #[command(after_help = "\
Examples:
  nlmodes-cli completions bash > ~/.local/share/bash-completion/completions/nlmodes-cli
  nlmodes-cli completions zsh > ~/.zfunc/_nlmodes-cli            with ~/.zfunc in $fpath
  nlmodes-cli completions fish > ~/.config/fish/completions/nlmodes-cli.fish

They take effect in the next shell.")]
    Completions {
        /// The shell
        shell: Shell,
    },
}

// Files that have a schema.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub enum SchemaOf {
    /// A scene of any kind
    Scene,
    /// A study
    Study,
}

// Commands for records.
#[derive(Debug, Subcommand)]
pub enum Experiment {
    /// Extract points of a nonlinear mode from measured records: a table, figures, and findings on the quality of the
    /// records
    #[command(after_help = "\
Example:
  nlmodes-cli experiment extract configs/measured_record.toml --out results/measured

Exit status 1 where a record gives no point, with the reason in the table; 2 where a file cannot be read, and nothing \
    is written.")]
    Extract {
        #[command(flatten)]
        scene: SceneArguments,
        /// Directory of the result files, instead of the one given in the scene
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Overwrite the results of another scene
        #[arg(long)]
        force: bool,
        /// Warnings and errors only
        #[arg(long, short)]
        quiet: bool,
    },
    /// Plan a test: drive point, levels, frequencies and sensor ranges to expect, and which levels phase control holds;
    /// writes design.json
    #[command(after_help = "\
Examples:
  nlmodes-cli experiment design configs/virtual_test.toml --out results/plan
  nlmodes-cli experiment design my_beam.toml --set damping.ratio=0.005

The scene describes a virtual test, or a rod or beam with one stop and [damping]: then an ideal force and levels about \
    that of grazing are assumed. Each level is simulated with structure, stop, exciter and loop.

Exit status 1 where a level is not held, with what does not settle.")]
    Design {
        #[command(flatten)]
        scene: SceneArguments,
        /// Directory of design.json, instead of the one given in the scene
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// No progress
        #[arg(long, short)]
        quiet: bool,
    },
}

// A scene and the changed values.
#[derive(Debug, Args)]
pub struct SceneArguments {
    /// The scene, a TOML file
    #[arg(value_name = "SCENE")]
    pub path: PathBuf,
    #[arg(long = "set", value_name = "KEY=VALUE", help = SET_HELP, allow_hyphen_values = true)]
    pub overrides: Vec<String>,
    /// Maximum memory for the scene, for instance 8GiB; default: three quarters of the machine's
    #[arg(long, value_name = "SIZE")]
    pub memory_limit: Option<memory::Limit>,
}

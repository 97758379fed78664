//! `nlmodes-cli study`: thousands of branches and their statistics.

mod collect;
mod fit;
mod run;
mod serve;
mod slurm;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use nlmodes_study::{Settings, Study, StudyError};

use crate::Status;
use crate::terminal::{print, refuse, wants_colours};

/// Commands for studies.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Compute the missing cases, one branch per core, then table and page
    #[command(after_help = "\
Examples:
  nlmodes-cli study run configs/gap_study.toml
  nlmodes-cli study run configs/gap_study.toml --shard 0/8     every eighth case: on eight machines 0/8 to 7/8

Existing cases are not computed again, and interrupted ones are continued: after Ctrl-C, a killed process or a full \
    disk, the same call continues.
A case that fails is a row of the table with its reason.")]
    Run(run::Arguments),
    /// Print how many cases are complete, failed and missing
    Status(Place),
    /// Write table (CSV, Parquet), statistics and page of the existing cases
    #[command(after_help = "\
Example:
  nlmodes-cli study collect configs/gap_study.toml

Exit status 1 where cases are missing or damaged: the table says which.")]
    Collect(collect::Arguments),
    /// Fit the variables to measured points of a curve, with their covariance
    #[command(after_help = "\
Example:
  nlmodes-cli study fit configs/studies/fit_backbone.toml

The table [fit] names the file with the points; the variables begin at the values of the scene. Each trial is a case \
    with gradients; what is there is not computed again.
Exit status 1 where no values are found.")]
    Fit(fit::Arguments),
    /// Write a study as an array job of a Slurm cluster, each task a share of many cases
    #[command(after_help = "\
Example:
  nlmodes-cli study slurm configs/gap_study.toml --shards 8 --jobs 4
  sbatch gap_study.sbatch
  nlmodes-cli study collect configs/gap_study.toml        at any time, of what is there

The script has the line for GNU parallel and that for HyperQueue too.")]
    Slurm(slurm::Arguments),
    /// Compute cases requested by another program: a line of JSON in, a line out
    #[command(after_help = "\
Example:
  echo '{\"id\": 1, \"set\": {\"gap_m\": 1e-3}}' | nlmodes-cli study serve configs/gap_study.toml
  {\"id\":1,\"status\":\"complete\",\"reason\":\"\",\"quantities\":{\"f_2\":46.1},\"case\":\"b0af6d14a3c51e02\"}

Names are those of the study's variables, or keys that `--set` takes. Answers come in the order in which they are \
    done. What is there is not computed again.")]
    Serve(serve::Arguments),
}

/// The study and its directory.
#[derive(Debug, Args)]
pub struct Place {
    /// The study, a TOML file
    #[arg(value_name = "STUDY")]
    path: PathBuf,
    /// Directory of the study, instead of the one given in it
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Place {
    /// Reads and checks the study, prints its errors, or continues.
    fn with(&self, then: impl FnOnce(&Study) -> Status) -> Status {
        match Study::load(&self.path) {
            Ok(mut file) => {
                if !file.warnings.is_empty() {
                    say!("{}\n", file.warnings_text(wants_colours()));
                }
                if let Some(out) = &self.out {
                    file.scene.directory.clone_from(out);
                }
                then(&file.scene)
            }
            Err(refused) => refuse(&refused),
        }
    }
}

/// Executes the command.
pub fn run(command: &Command) -> Status {
    match command {
        Command::Run(arguments) => run::run(arguments),
        Command::Status(place) => place.with(status),
        Command::Collect(arguments) => collect::run(arguments),
        Command::Fit(arguments) => fit::run(arguments),
        Command::Slurm(arguments) => slurm::write(arguments),
        Command::Serve(arguments) => serve::serve(arguments),
    }
}

/// Prints the number of cases in each state. Exit status 1 if some are missing.
fn status(study: &Study) -> Status {
    let counts = nlmodes_study::status(study, Settings::default().jobs());
    let printed = print(&format!("{}\n{counts}", study.title));
    if counts.missing > 0 { Status::EndedEarly } else { printed }
}

/// Why a study cannot continue.
fn refused(error: &StudyError) -> Status {
    say!("error: {}", nlmodes_run::chain(error));
    match error {
        StudyError::NoCase { .. } => Status::Wrong,
        _ => {
            say!("what was computed until then stays; the same call goes on from there");
            Status::EndedEarly
        }
    }
}

/// Paths for messages.
fn shown(directory: &Path, name: &str) -> String {
    directory.join(name).display().to_string()
}

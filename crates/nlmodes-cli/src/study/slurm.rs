//! `nlmodes-cli study slurm`.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use nlmodes_study::slurm::{ArrayJob, TRIED, job_name, needs, try_some};

use super::{Place, refused};
use crate::Status;
use crate::terminal::print;

/// Command-line arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    place: Place,
    /// Tasks of the array, each with a share of the cases; clusters favour a few long ones
    #[arg(long, value_name = "N", default_value = "8")]
    shards: NonZeroUsize,
    /// Cores per task
    #[arg(long, value_name = "N", default_value = "1")]
    jobs: NonZeroUsize,
    /// Cluster partition
    #[arg(long, value_name = "NAME")]
    partition: Option<String>,
    /// Script file; default: the name of the study with .sbatch, in the current directory
    #[arg(long, value_name = "FILE")]
    script: Option<PathBuf>,
}

/// Writes the script, and prints the requested resources.
pub fn write(arguments: &Arguments) -> Status {
    arguments.place.with(|study| {
        let (shards, jobs) = (arguments.shards.get(), arguments.jobs.get());
        let mut found = needs(study, shards, jobs);
        if found.time.is_none() && found.missing > 0 {
            say!("{TRIED} cases are computed to know how long one takes");
            if let Err(error) = try_some(study, found.missing) {
                return refused(&error);
            }
            found = needs(study, shards, jobs);
        }
        let name = job_name(&arguments.place.path);
        let job = ArrayJob {
            study: arguments.place.path.display().to_string(),
            out: arguments.place.out.as_ref().map(|out| out.display().to_string()),
            program: crate::program::path().display().to_string(),
            name: name.clone(),
            shards,
            jobs,
            partition: arguments.partition.clone(),
            time: found.time.unwrap_or(Duration::from_secs(3600)),
            memory: found.memory,
        };
        let path = arguments.script.clone().unwrap_or_else(|| PathBuf::from(format!("{name}.sbatch")));
        if let Err(error) = std::fs::write(&path, job.script()) {
            say!("error: {}: {error}", path.display());
            return Status::Wrong;
        }
        let path = path.display();
        print(&format!("{} cases to compute in {job}\nScript in {path}: sbatch {path}", found.missing))
    })
}

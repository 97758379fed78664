//! A study as an array job: each task is a shard of many cases.

use std::fmt;
use std::num::NonZeroUsize;
use std::path::Path;
use std::time::Duration;

use nlmodes_run::Silent;

use nlmodes_scene::memory;

use crate::case::{cases, resolve};
use crate::design::Points;
use crate::error::StudyError;
use crate::run::{Settings, Shard, run};
use crate::store::Store;
use crate::study::Study;
use crate::told::duration;

/// Safety factor on the mean time of the existing cases.
const SPARE_TIME: f64 = 2.0;
/// Shortest requested time, s.
const SHORTEST: f64 = 600.0;
/// Number of cases computed to estimate the time per case.
pub const TRIED: usize = 2;
/// Maximum number of case times considered.
const MOST_LOOKED_AT: usize = 1000;

/// Resources of an array job.
#[derive(Debug, Clone, PartialEq)]
pub struct ArrayJob {
    /// Path of the study's file in the call of the program.
    pub study: String,
    /// Directory of the study, if it is not the one in the file.
    pub out: Option<String>,
    /// Path of the program.
    pub program: String,
    /// Name of the job.
    pub name: String,
    /// Tasks of the array.
    pub shards: usize,
    /// Cores of each task.
    pub jobs: usize,
    /// Partition; `None` for the cluster's default.
    pub partition: Option<String>,
    /// Time of each task.
    pub time: Duration,
    /// Memory of each task, bytes.
    pub memory: f64,
}

/// Time and memory that a task needs, by estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Needs {
    /// Time of a task; `None` if there is no case from which to estimate it.
    pub time: Option<Duration>,
    /// Memory of a task, bytes.
    pub memory: f64,
    /// Number of missing cases.
    pub missing: usize,
}

/// Resources of a task for this many shards and cores: time from the existing cases, memory from the estimate of the
/// first scene.
pub fn needs(study: &Study, shards: usize, jobs: usize) -> Needs {
    let store = Store::new(&study.directory);
    let all = cases(study, jobs);
    let records = all.iter().filter_map(|case| store.record(case.id.as_ref().ok()?));
    let seconds: Vec<f64> = records.take(MOST_LOOKED_AT).map(|record| record.seconds).collect();
    let missing = all.iter().filter_map(|case| case.id.as_ref().ok()).filter(|id| store.record(id).is_none()).count();
    let each = (missing as f64 / (shards * jobs) as f64).ceil();
    let mean = seconds.iter().sum::<f64>() / seconds.len().max(1) as f64;
    let longest = seconds.iter().copied().fold(0.0, f64::max);
    let time =
        (!seconds.is_empty()).then(|| Duration::from_secs_f64((SPARE_TIME * (each * mean + longest)).max(SHORTEST)));
    let first = resolve(study, &Points::new(study).get(0)).ok();
    let of_case = first.and_then(|parts| parts.iter().map(|part| memory::estimate(&part.file)).reduce(f64::max));
    Needs { time, memory: jobs as f64 * of_case.unwrap_or(0.0), missing }
}

/// Computes [`TRIED`] of the missing cases, spread over the study, for the time estimate of [`needs`].
///
/// # Errors
/// [`StudyError`] if they cannot be written, or no case is a valid scene.
pub fn try_some(study: &Study, missing: usize) -> Result<(), StudyError> {
    let of = (missing / TRIED).max(1);
    let shard = Shard::new(of / 2, of).unwrap_or_default();
    let settings = Settings { jobs: NonZeroUsize::new(1), shard, ..Settings::default() };
    run(study, &settings, &mut Silent).map(drop)
}

/// Description of the requested resources.
impl fmt::Display for ArrayJob {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (time, memory) = (duration(self.time), megabytes(self.memory));
        write!(f, "{} tasks of {} cores, {time} and {memory} MiB each", self.shards, self.jobs)
    }
}

impl ArrayJob {
    /// The script for `sbatch`.
    ///
    /// A task that is signalled to end (its time runs out, its node is preempted) keeps its results and requeues
    /// itself; after the loss of a node Slurm requeues it.
    pub fn script(&self) -> String {
        let Self { name, shards, jobs, .. } = self;
        let last = shards - 1;
        let partition = self.partition.as_ref().map_or_else(String::new, |p| format!("#SBATCH --partition={p}\n"));
        let [memory, time] = [megabytes(self.memory), clock(self.time)];
        let [own, parallel, queue] =
            ["${SLURM_ARRAY_TASK_ID}", "{}", "${HQ_TASK_ID}"].map(|task| self.call(&format!("{task}/{shards}")));
        format!(
            r#"#!/bin/bash
# Array job of a study: each task computes the cases of its shard that are not there yet. Submit it again, as a whole or
# in part (sbatch --array=3,5), for what is missing; then:  {program} study collect {study}{out}
#SBATCH --job-name={name}
#SBATCH --array=0-{last}
#SBATCH --cpus-per-task={jobs}
#SBATCH --mem={memory}M
#SBATCH --time={time}
{partition}#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:TERM@60
#SBATCH --output=%x_%A_%a.log
#
# The same without Slurm, by GNU parallel or by HyperQueue:
#   parallel -j 1 {parallel} ::: $(seq 0 {last})
#   hq submit --array 0-{last} --cpus {jobs} bash -c '{queue}'

cd "${{SLURM_SUBMIT_DIR:-.}}" || exit 2
{own} &
child=$!
again() {{
    kill -TERM "$child" 2>/dev/null
    wait "$child"
    scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}"
    exit 0
}}
trap again TERM
wait "$child"
"#,
            program = quoted(&self.program),
            study = quoted(&self.study),
            out = self.out(),
        )
    }

    fn out(&self) -> String {
        self.out.as_ref().map_or_else(String::new, |out| format!(" --out {}", quoted(out)))
    }

    /// The call of a shard.
    fn call(&self, shard: &str) -> String {
        let out = self.out();
        let (program, study) = (quoted(&self.program), quoted(&self.study));
        format!("{program} study run {study}{out} --quiet --jobs {} --shard {shard}", self.jobs)
    }
}

/// A name quoted for a shell.
fn quoted(name: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+".contains(c);
    if !name.is_empty() && name.chars().all(plain) {
        name.to_owned()
    } else {
        format!("'{}'", name.replace('\'', r"'\''"))
    }
}

fn megabytes(bytes: f64) -> String {
    format!("{:.0}", (bytes / 1048576.0).ceil().max(256.0))
}

fn clock(time: Duration) -> String {
    let minutes = time.as_secs().div_ceil(60);
    format!("{}-{:02}:{:02}:00", minutes / 1440, minutes / 60 % 24, minutes % 60)
}

/// Name of a job from that of a file.
pub fn job_name(study: &Path) -> String {
    let stem = study.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    stem.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' || c == '_' { c } else { '_' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_script_asks_for_what_is_needed_and_keeps_its_shards_when_some_are_submitted_again() {
        let job = ArrayJob {
            study: "my gaps.toml".into(),
            out: None,
            program: "nlmodes-cli".into(),
            name: job_name(Path::new("dir/my gaps.toml")),
            shards: 8,
            jobs: 4,
            partition: Some("short".into()),
            time: Duration::from_secs(3601),
            memory: 3e9,
        };
        let script = job.script();
        for line in [
            "#SBATCH --job-name=my_gaps",
            "#SBATCH --array=0-7",
            "#SBATCH --cpus-per-task=4",
            "#SBATCH --mem=2862M",
            "#SBATCH --time=0-01:01:00",
            "#SBATCH --partition=short",
            "nlmodes-cli study run 'my gaps.toml' --quiet --jobs 4 --shard ${SLURM_ARRAY_TASK_ID}/8 &",
            "#   parallel -j 1 nlmodes-cli study run 'my gaps.toml' --quiet --jobs 4 --shard {}/8 ::: $(seq 0 7)",
        ] {
            assert!(script.lines().any(|found| found == line), "{line}\n{script}");
        }
    }
}

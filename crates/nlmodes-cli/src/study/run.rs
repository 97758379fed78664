//! `nlmodes-cli study run`.

use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

use clap::Args;
use indicatif::ProgressBar;
use nlmodes_scene::memory;
use nlmodes_study::{Settings, Shard, Study, StudyObserver, StudyOutcome};

use super::{Place, collect, refused};
use crate::progress::bar;
use crate::terminal::{moves, print};
use crate::{Status, interrupt};

/// Time between two plain lines.
const PLAIN_INTERVAL: Duration = Duration::from_secs(5);

/// Command-line arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    place: Place,
    /// Number of cases at a time [default: number of cores]
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
    /// Only every n-th point of the design, beginning with point i from 0: the shards of several machines, 0/n to
    /// (n−1)/n; without table and page
    #[arg(long, value_name = "I/N", default_value = "0/1")]
    shard: Shard,
    /// Accepted for similarity with `run`: a study always continues where it was interrupted
    #[arg(long = "resume")]
    _resume: bool,
    /// Compute failed cases again
    #[arg(long)]
    retry_failed: bool,
    /// Also draw figures and page of each case
    #[arg(long)]
    figures: bool,
    /// Maximum memory of all cases computed at the same time, for instance 8GiB; default: three quarters of the
    /// machine's
    #[arg(long, value_name = "SIZE")]
    memory_limit: Option<memory::Limit>,
    /// No progress; warnings and errors only
    #[arg(long, short)]
    quiet: bool,
}

/// Computes the missing cases, then table and page.
pub fn run(arguments: &Arguments) -> Status {
    arguments.place.with(|study| {
        interrupt::install();
        interrupt::something_found();
        let settings = Settings {
            jobs: arguments.jobs,
            shard: arguments.shard,
            retry: arguments.retry_failed,
            drawn: arguments.figures,
            memory_limit: arguments.memory_limit,
        };
        let mut watch = Watch::new(arguments.quiet);
        let outcome = nlmodes_study::run(study, &settings, &mut watch);
        watch.finish();
        match outcome {
            Ok(outcome) => told(study, arguments, &settings, &outcome),
            Err(error) => refused(&error),
        }
    })
}

fn told(study: &Study, arguments: &Arguments, settings: &Settings, outcome: &StudyOutcome) -> Status {
    if !arguments.quiet {
        say!("{outcome}");
    }
    let status = if outcome.is_done() { Status::Done } else { Status::EndedEarly };
    if outcome.is_cut_off {
        say!("the same call goes on where this one ended");
        return status;
    }
    if outcome.elsewhere > 0 {
        say!("{} cases are being computed by another process", outcome.elsewhere);
    }
    if !arguments.shard.is_all() {
        let place = study.directory.display();
        return match arguments.quiet {
            true => status,
            false => print(&format!(
                "Cases in {place}/cases; `nlmodes-cli study collect` makes table and page of all shards"
            )),
        };
    }
    match collect::write(study, settings.jobs(), arguments.quiet) {
        Status::Done => status,
        early => early,
    }
}

/// An updated line on a terminal, plain lines elsewhere.
pub(super) struct Watch {
    bar: Option<ProgressBar>,
    plain: bool,
    last: Option<Instant>,
}

impl Watch {
    pub(super) fn new(quiet: bool) -> Self {
        let terminal = moves();
        Self { bar: (!quiet && terminal).then(|| bar("[{bar:20}] {msg}", 1)), plain: !quiet && !terminal, last: None }
    }

    fn finish(&self) {
        self.bar.iter().for_each(ProgressBar::finish_and_clear);
    }
}

impl StudyObserver for Watch {
    fn progress(&mut self, outcome: &StudyOutcome) {
        if let Some(bar) = &self.bar {
            bar.set_length(outcome.to_compute() as u64);
            bar.set_position((outcome.there + outcome.computed) as u64);
            bar.set_message(outcome.progress());
        } else if self.plain && self.last.is_none_or(|last| last.elapsed() >= PLAIN_INTERVAL) {
            self.last = Some(Instant::now());
            say!("{}", outcome.progress());
        }
    }

    fn is_cancelled(&self) -> bool {
        interrupt::requested()
    }
}

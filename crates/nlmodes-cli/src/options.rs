//! Options of a run.

use clap::Args;
use nlmodes_run::Over;

/// Options of a run.
#[derive(Debug, Clone, Copy, Default, Args)]
pub struct RunOptions {
    /// Continue an interrupted run of this scene; start from the beginning if there is none
    #[arg(long, conflicts_with = "force")]
    pub resume: bool,
    /// Overwrite the results of another scene
    #[arg(long)]
    pub force: bool,
    /// Run all checks of the numbers: more harmonics, more modes, exact motions at a few points
    #[arg(long)]
    pub certify: bool,
    /// No progress; warnings and errors only
    #[arg(long, short)]
    pub quiet: bool,
    /// A line for every point
    #[arg(long, short, conflicts_with = "quiet")]
    pub verbose: bool,
}

impl RunOptions {
    /// What may be overwritten.
    pub fn over(self) -> Over {
        match (self.resume, self.force) {
            (true, _) => Over::Resumed,
            (_, true) => Over::Anything,
            _ => Over::Same,
        }
    }
}

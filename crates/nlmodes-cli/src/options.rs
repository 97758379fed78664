//! How a run goes about it.

use clap::Args;
use nlmodes_run::Over;

/// How a run goes about it.
#[derive(Debug, Clone, Copy, Default, Args)]
pub struct RunOptions {
    /// Go on where an interrupted run of this scene ended; from the beginning where there was none
    #[arg(long, conflicts_with = "force")]
    pub resume: bool,
    /// Overwrite the results of another scene
    #[arg(long)]
    pub force: bool,
    /// Look at all that says how far the numbers can be trusted: more harmonics, more modes, exact motions at a few
    /// points
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

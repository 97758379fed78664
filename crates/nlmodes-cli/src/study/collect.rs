//! `nlmodes-cli study collect`.

use clap::Args;
use nlmodes_scene::number;
use nlmodes_study::{Collected, Settings, Statistics, Study};

use super::{Place, run::refused, shown, status};
use crate::Status;
use crate::terminal::print;

/// What stands on the command line.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    place: Place,
    /// Errors only
    #[arg(long, short)]
    quiet: bool,
}

/// Writes table, statistics and page of what there is.
pub fn run(arguments: &Arguments) -> Status {
    arguments.place.with(|study| write(study, Settings::default().jobs(), arguments.quiet))
}

/// The same for a study that is read.
pub fn write(study: &Study, threads: usize, quiet: bool) -> Status {
    let collected = Collected::new(study, threads);
    if let Err(error) = collected.write(study) {
        return refused(&error);
    }
    let counts = collected.counts;
    if counts.missing + counts.damaged > 0 {
        say!("warning: {} of {} cases are missing, {} are damaged", counts.missing, counts.cases, counts.damaged);
    }
    if !quiet {
        let mut text = status::text(&counts);
        collected.statistics.iter().for_each(|statistics| text += &format!("\n\n{}", told(statistics)));
        let place = |name| shown(&study.directory, name);
        text += &format!("\n\nTable in {} and study.parquet, page in {}", place("study.csv"), place("report.html"));
        if print(&text) != Status::Done {
            return Status::EndedEarly;
        }
    }
    if counts.missing + counts.damaged > 0 { Status::EndedEarly } else { Status::Done }
}

/// Spread and sensitivity of a quantity.
fn told(statistics: &Statistics) -> String {
    let name = &statistics.quantity;
    let Some(spread) = &statistics.spread else { return format!("{name}: no case has it") };
    let mut text = format!(
        "{name}: mean {} ± {:.1e}, standard deviation {:.3e}, {} to {}",
        number(spread.mean),
        spread.mean_error,
        spread.std,
        number(spread.min),
        number(spread.max)
    );
    let quantiles = spread.quantiles.iter().map(|[share, value]| format!("{} %: {}", 100.0 * share, number(*value)));
    text += &format!("\n  quantiles {}", quantiles.collect::<Vec<_>>().join(", "));
    for found in &statistics.rank_correlations {
        let [low, high] = found.measure.interval;
        text +=
            &format!("\n  rank correlation with {}: {:.3} ({low:.3} to {high:.3})", found.variable, found.measure.rho);
    }
    for found in &statistics.sobol_indices {
        let index = found.measure;
        text += &format!(
            "\n  Sobol' index of {}: {:.4} ± {:.4} by itself, {:.4} ± {:.4} in total",
            found.variable, index.first, index.first_error, index.total, index.total_error
        );
    }
    if statistics.without > 0 {
        text += &format!("\n  {} cases do not have it", statistics.without);
    }
    text
}

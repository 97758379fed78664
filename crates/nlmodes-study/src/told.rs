//! Messages about studies.

mod first_order;
mod fit;

use std::fmt::{Display, Formatter, Result};
use std::time::Duration;

use nlmodes_scene::number;

use crate::collect::Counts;
use crate::run::StudyOutcome;
use crate::statistics::{Expansion, Statistics};

/// A line for each state.
impl Display for Counts {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let further = [("ended early", self.incomplete), ("failed", self.failed), ("damaged", self.damaged)];
        let mut rows = vec![("cases", self.cases), ("complete", self.complete)];
        rows.extend(further.into_iter().filter(|(_, n)| *n > 0));
        rows.iter().try_for_each(|(name, n)| writeln!(f, "  {name:<12}{n:>10}"))?;
        write!(f, "  {:<12}{:>10}", "missing", self.missing)
    }
}

/// Scatter and sensitivity of the quantity, one line each.
impl Display for Statistics {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let name = &self.quantity;
        let Some(spread) = &self.spread else { return write!(f, "{name}: no case has it") };
        if spread.count < 2 {
            return write!(f, "{name}: {} in its only case", number(spread.mean));
        }
        let [mean, min, max] = [spread.mean, spread.min, spread.max].map(number);
        let (error, std) = (spread.mean_error, spread.std);
        write!(f, "{name}: mean {mean} ± {error:.1e}, standard deviation {std:.3e}, {min} to {max}")?;
        let quantiles = spread.quantiles.iter();
        let quantiles = quantiles.map(|[share, value]| format!("{} %: {}", 100.0 * share, number(*value)));
        write!(f, "\n  quantiles {}", quantiles.collect::<Vec<_>>().join(", "))?;
        if let Some(said) = self.independence() {
            write!(f, "\n  {said}")?;
        }
        for found in &self.rank_correlations {
            let ([low, high], rho) = (found.measure.interval, found.measure.rho);
            write!(f, "\n  rank correlation with {}: {rho:.3} ({low:.3} to {high:.3})", found.variable)?;
        }
        self.expansion.iter().try_for_each(|own| write!(f, "\n  {own}"))?;
        for found in &self.sobol_indices {
            let index = found.measure;
            let itself = format!("{:.4} ± {:.1e} by itself", index.first, index.first_error);
            let total = format!("{:.4} ± {:.1e} in total", index.total, index.total_error);
            write!(f, "\n  Sobol' index of {}: {itself}, {total}", found.variable)?;
        }
        match self.without {
            0 => Ok(()),
            without => write!(f, "\n  {without} cases do not have it"),
        }
    }
}

/// What the indices are from.
impl Display for Expansion {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { degree, cases, with_gradients, mean, std, left_out, .. } = self;
        write!(f, "polynomials of degree {degree} by {cases} cases, {with_gradients} with gradients: ")?;
        write!(f, "mean {}, standard deviation {std:.3e}; ", number(*mean))?;
        write!(f, "leave-one-out error {left_out:.2e} of the variance")
    }
}

impl Statistics {
    /// What is to be reported of variables on which the quantity does not depend.
    pub fn independence(&self) -> Option<String> {
        match (self.does_not_vary, self.does_not_depend_on.as_slice()) {
            (true, _) => Some(
                "over these ranges it does not depend on the variables: its spread is below the error of the \
                 computation (an energy \
                 ratio moves with the gap; { energy_j = … } holds the energy itself)"
                    .to_owned(),
            ),
            (false, []) => None,
            (false, names) => {
                let names = names.join(", ");
                Some(format!("it does not depend on {names}: over the range less than 1/1000 of its spread"))
            }
        }
    }
}

/// What was computed, and the outcome, in one line.
impl Display for StudyOutcome {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let seconds = self.wall_time.as_secs_f64();
        write!(f, "{} of {} cases computed in {seconds:.1} s", self.computed, self.cases)?;
        let further = [
            (self.there, "were there"),
            (self.incomplete, "ended early"),
            (self.failed, "failed"),
            (self.refused, "are no sound scenes"),
            (self.repeated, "have the scene of another one"),
        ];
        further.iter().filter(|(n, _)| *n > 0).try_for_each(|(n, what)| write!(f, ", {n} {what}"))
    }
}

impl StudyOutcome {
    /// Progress, rate and estimated end while it is computed, in one line.
    pub fn progress(&self) -> String {
        let failed = if self.failed > 0 { format!(", {} failed", self.failed) } else { String::new() };
        let rest = self.rate().zip(self.rest());
        let rest = rest.map(|(rate, rest)| format!(", {rate:.1} a second, {} left", duration(rest)));
        let (done, all) = (self.there + self.computed, self.to_compute());
        format!("{done} of {all} cases{failed}{}", rest.unwrap_or_default())
    }
}

/// A duration in readable form.
pub fn duration(time: Duration) -> String {
    let seconds = time.as_secs();
    match seconds {
        0..120 => format!("{seconds} s"),
        120..7200 => format!("{} min", seconds / 60),
        _ => format!("{:.1} h", seconds as f64 / 3600.0),
    }
}

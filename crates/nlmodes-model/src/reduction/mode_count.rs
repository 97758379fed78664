use nlmodes_linalg::{Modes, Openness, Pencil};

use crate::reduction::ReductionError;

/// Which of the lowest modes are retained.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ModeCount {
    /// So many, or all where there are fewer.
    Lowest(usize),
    /// Those with angular frequencies up to this one, rad/s; at least one.
    UpTo(f64),
    /// Those with frequencies up to a multiple of that of a mode, and at least some.
    Beyond {
        /// Number of the mode, from 1; rigid-body motions count.
        mode: usize,
        /// The multiple.
        factor: f64,
        /// So many at least, or all where there are fewer.
        least: usize,
    },
}

/// First guess for the number of modes below a frequency.
const FIRST_GUESS: usize = 16;

impl ModeCount {
    /// The modes of the pencil that are retained, and what its digits leave open of them. Those that strain nothing as
    /// far as these tell have λ = 0; with a count that is not said, as many others are there beside them.
    pub(crate) fn select(self, pencil: &Pencil, dofs: usize) -> Result<(Modes, Openness), ReductionError> {
        let lowest = |count| {
            let mut modes = pencil.lowest(count).map_err(ReductionError::during("open modes"))?;
            let openness = pencil.openness(&modes);
            modes.eigenvalues[..openness.strainless].fill(0.0);
            Ok((modes, openness))
        };
        match self {
            Self::Lowest(count) => lowest(count),
            Self::UpTo(omega) if !(omega.is_finite() && omega > 0.0) => Err(ReductionError::FrequencyLimit { omega }),
            Self::UpTo(omega) => up_to(lowest, dofs, FIRST_GUESS, 1, |_| omega * omega),
            Self::Beyond { factor, .. } if !(factor.is_finite() && factor > 0.0) => {
                Err(ReductionError::FrequencyLimit { omega: factor })
            }
            Self::Beyond { mode, factor, least } => {
                let (mode, guess) = (mode.max(1), FIRST_GUESS.max(2 * mode).max(least + 1));
                up_to(lowest, dofs, guess, least.max(1), |found| {
                    factor * factor * found.get(mode - 1).copied().unwrap_or(f64::INFINITY)
                })
            }
        }
    }
}

/// The modes whose eigenvalues are not beyond a limit, which may depend on the lowest ones.
fn up_to(
    lowest: impl Fn(usize) -> Result<(Modes, Openness), ReductionError>,
    dofs: usize,
    guess: usize,
    least: usize,
    limit: impl Fn(&[f64]) -> f64,
) -> Result<(Modes, Openness), ReductionError> {
    let mut wanted = guess.min(dofs);
    loop {
        let (modes, openness) = lowest(wanted)?;
        let (found, limit) = (modes.eigenvalues.len(), limit(&modes.eigenvalues));
        let below = modes.eigenvalues.iter().take_while(|λ| **λ <= limit).count();
        let kept = below.max(least).max(2 * openness.strainless);
        if (below < found && kept <= found) || found < wanted || wanted == dofs {
            let kept = kept.min(found);
            return Ok((first(modes, kept), openness.of_lowest(kept)));
        }
        wanted = (2 * wanted).min(dofs);
    }
}

/// The first `count` of the modes.
fn first(mut modes: Modes, count: usize) -> Modes {
    modes.eigenvalues.truncate(count);
    modes.vectors = modes.vectors.subcols(0, count).to_owned();
    modes
}

use nlmodes_linalg::{Modes, Pencil};

use crate::ReductionError;

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
    /// The modes of the pencil that are retained.
    pub(crate) fn select(self, pencil: &Pencil, dofs: usize) -> Result<Modes, ReductionError> {
        let lowest = |count| pencil.lowest(count).map_err(ReductionError::during("open modes"));
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
    lowest: impl Fn(usize) -> Result<Modes, ReductionError>,
    dofs: usize,
    guess: usize,
    least: usize,
    limit: impl Fn(&[f64]) -> f64,
) -> Result<Modes, ReductionError> {
    let mut wanted = guess.min(dofs);
    loop {
        let modes = lowest(wanted)?;
        let (found, limit) = (modes.eigenvalues.len(), limit(&modes.eigenvalues));
        let below = modes.eigenvalues.iter().take_while(|λ| **λ <= limit).count();
        if below < found || found < wanted || wanted == dofs {
            return Ok(first(modes, below.max(least)));
        }
        wanted = (2 * wanted).min(dofs);
    }
}

/// The first `count` of the modes.
fn first(mut modes: Modes, count: usize) -> Modes {
    let count = count.min(modes.eigenvalues.len());
    modes.eigenvalues.truncate(count);
    modes.vectors = modes.vectors.subcols(0, count).to_owned();
    modes
}

use nlmodes_linalg::{Modes, Pencil};

use crate::ReductionError;

/// Which of the lowest modes are retained.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ModeCount {
    /// So many, or all where there are fewer.
    Lowest(usize),
    /// Those with angular frequencies up to this one, rad/s; at least one.
    UpTo(f64),
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
            Self::UpTo(omega) => {
                let mut wanted = FIRST_GUESS.min(dofs);
                loop {
                    let modes = lowest(wanted)?;
                    let below = modes.eigenvalues.iter().take_while(|λ| **λ <= omega * omega).count();
                    if below < modes.eigenvalues.len() || modes.eigenvalues.len() < wanted || wanted == dofs {
                        return Ok(first(modes, below.max(1)));
                    }
                    wanted = (2 * wanted).min(dofs);
                }
            }
        }
    }
}

/// The first `count` of the modes.
fn first(mut modes: Modes, count: usize) -> Modes {
    let count = count.min(modes.eigenvalues.len());
    modes.eigenvalues.truncate(count);
    modes.vectors = modes.vectors.subcols(0, count).to_owned();
    modes
}

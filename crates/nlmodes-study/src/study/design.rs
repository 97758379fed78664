//! Which cases a study has; their points are made in `crate::design`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which cases are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum DesignKind {
    /// All combinations of values
    Grid,
    /// Values side by side, or the rows of a CSV
    List,
    /// Points of a Sobol' sequence, scrambled by the seed
    Sobol,
    /// Each of as many equally likely strata as there are points is met once, in each variable
    LatinHypercube,
    /// Independent random points
    Random,
}

impl DesignKind {
    /// Its name in a study file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Grid => "grid",
            Self::List => "list",
            Self::Sobol => "sobol",
            Self::LatinHypercube => "latin-hypercube",
            Self::Random => "random",
        }
    }

    /// Whether points are drawn from distributions.
    pub fn is_sampled(self) -> bool {
        matches!(self, Self::Sobol | Self::LatinHypercube | Self::Random)
    }
}

/// Which cases are computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// Of which kind.
    pub kind: DesignKind,
    /// Number of points that are drawn; for Sobol' indices, of base points. 0 for grid and list.
    pub samples: usize,
    /// From which random numbers follow.
    pub seed: u64,
    /// Whether each base point has the further ones from which Sobol' indices follow.
    pub sobol_indices: bool,
}

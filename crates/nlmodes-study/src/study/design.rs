//! The cases of a study; their points are computed in `crate::design`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The cases to compute.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum DesignKind {
    /// All combinations of values
    #[default]
    Grid,
    /// Values row by row, or the rows of a CSV
    List,
    /// Points of a Sobol' sequence, scrambled by the seed
    Sobol,
    /// Each of as many equally likely strata as there are points is sampled once, in each variable
    LatinHypercube,
    /// Independent random points
    Random,
    /// The variables at their means alone, with gradients, and what follows from these
    FirstOrder,
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
            Self::FirstOrder => "first-order",
        }
    }

    /// Whether points are drawn from distributions.
    pub fn is_sampled(self) -> bool {
        matches!(self, Self::Sobol | Self::LatinHypercube | Self::Random)
    }

    /// Whether variables may have distributions.
    pub fn takes_distributions(self) -> bool {
        self.is_sampled() || self == Self::FirstOrder
    }
}

/// The cases to compute.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Design {
    /// The kind.
    pub kind: DesignKind,
    /// Number of points that are drawn; for Sobol' indices, of base points. 0 for grid and list.
    pub samples: usize,
    /// Random seed.
    pub seed: u64,
    /// Whether each base point has the additional ones for Sobol' indices.
    pub sobol_indices: bool,
    /// Whether the indices come from an expansion that is fitted to the points and their gradients.
    pub expansion: bool,
    /// Whether spread and worst corners are computed from gradients, too.
    pub first_order: bool,
    /// Where a distribution has no limits, the box of tolerances ends this many standard deviations from the mean.
    pub box_deviations: f64,
}

impl Design {
    /// Whether its cases are differentiated by the variables.
    pub fn is_differentiated(&self) -> bool {
        self.kind == DesignKind::FirstOrder || self.expansion
    }
}

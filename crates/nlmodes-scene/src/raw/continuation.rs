use schemars::JsonSchema;
use serde::Deserialize;

use crate::scene::{AtBranchPoint, FrequencyDirection, InternalResonance};

/// Points of a branch where the scene does not say.
pub const DEFAULT_MAX_POINTS: u32 = 5000;

/// Branches where all arms are followed and the scene does not say how many.
pub const DEFAULT_MAX_BRANCHES: u32 = 20;

/// How far the branch is followed: to a limit of energy, of frequency, or whichever comes first.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawContinuation {
    /// Averaged kinetic energy at which the branch ends, over that at grazing
    #[schemars(extend("exclusiveMinimum" = 1.0))]
    pub max_energy_ratio: Option<f64>,
    /// Frequency window [lowest, highest]; the branch ends where it leaves it
    #[schemars(extend("unit" = "Hz"), inner(range(min = 0.0)))]
    pub frequency_hz: Option<[f64; 2]>,
    /// Most points of the branch
    #[schemars(range(min = 2, max = 1_000_000), extend("default" = DEFAULT_MAX_POINTS))]
    pub max_points: Option<u32>,
    /// Frequency on the backbone at which to start, instead of at grazing
    #[schemars(extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub start_frequency_hz: Option<f64>,
    /// Averaged kinetic energy on the backbone at which to start, over that at grazing
    #[schemars(extend("exclusiveMinimum" = 1.0))]
    pub start_energy_ratio: Option<f64>,
    /// Which way the branch leaves `start_frequency_hz` or `start_energy_ratio`
    #[schemars(extend("default" = "up"))]
    pub direction: Option<FrequencyDirection>,
    /// Which arm is followed at a branch point
    #[schemars(extend("default" = "stay"))]
    pub at_branch_point: Option<AtBranchPoint>,
    /// Most branches with `at_branch_point = "all"`
    #[schemars(range(min = 1, max = 1000), extend("default" = DEFAULT_MAX_BRANCHES))]
    pub max_branches: Option<u32>,
    /// What is done where an internal resonance leads the branch away from the backbone
    #[schemars(extend("default" = "follow"))]
    pub internal_resonance: Option<InternalResonance>,
}

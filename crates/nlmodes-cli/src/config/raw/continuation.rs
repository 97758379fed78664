use schemars::JsonSchema;
use serde::Deserialize;

use crate::config::scene::FrequencyDirection;

/// Points of a branch where the scene does not say.
pub const DEFAULT_MAX_POINTS: u32 = 5000;

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
    /// Which way the branch leaves `start_frequency_hz`
    #[schemars(extend("default" = "up"))]
    pub direction: Option<FrequencyDirection>,
}

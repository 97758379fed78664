use schemars::JsonSchema;
use serde::Deserialize;

use crate::scene::ReductionKind;

/// Most modes that a scene may retain.
pub const MAX_MODES: u32 = 10_000;

/// How the structure is reduced.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawReduction {
    /// Modes with open contacts and the static flexibility of all others, which moves no mass, or modes with held
    /// contacts, whose nodes lose their mass; default: "open-modes" for matrices, "held-modes" for rods and beams
    pub kind: Option<ReductionKind>,
    /// Number of open modes that are retained; default: those up to four times the highest harmonic
    #[schemars(range(min = 1, max = MAX_MODES))]
    pub modes: Option<u32>,
    /// Frequency up to which open modes are retained, instead of `modes`
    #[schemars(extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub up_to_hz: Option<f64>,
}

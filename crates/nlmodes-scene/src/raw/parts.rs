use schemars::JsonSchema;
use serde::Deserialize;

use super::{RawMaterial, RawSection};
use crate::scene::SpringDirection;

/// A spring between a node and the ground.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(extend("oneRequired" = ["stiffness_n_m", "stiffness_nm"]))]
pub struct RawSpring {
    /// Position along the axis, measured from the start; the mesh gets a node there
    #[schemars(extend("unit" = "m", "minimum" = 0.0))]
    pub at_m: f64,
    /// Direction in which it acts; "rotation" is a rotational spring
    pub direction: SpringDirection,
    /// Stiffness of a spring along or across the axis
    #[schemars(extend("unit" = "N/m", "exclusiveMinimum" = 0.0))]
    pub stiffness_n_m: Option<f64>,
    /// Stiffness of a rotational spring
    #[schemars(extend("unit" = "N·m", "exclusiveMinimum" = 0.0))]
    pub stiffness_nm: Option<f64>,
    /// Number of the structure to which it belongs; default: the one under whose heading it is
    #[schemars(range(min = 1))]
    pub structure: Option<u32>,
}

/// A part of a rod or beam, from where the one before ends, or the start.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawSegment {
    /// Position at which it ends; the mesh gets a node there
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
    pub to_m: f64,
    /// Its material; default: that of the structure
    pub material: Option<RawMaterial>,
    /// Its cross section; default: that of the structure
    pub section: Option<RawSection>,
    /// Mass per length in addition to that of its section; default: that of the structure
    #[schemars(extend("unit" = "kg/m", "minimum" = 0.0))]
    pub added_mass_kg_m: Option<f64>,
}

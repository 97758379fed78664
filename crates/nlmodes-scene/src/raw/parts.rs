use schemars::JsonSchema;
use serde::Deserialize;

use crate::scene::SpringDirection;

/// A point mass at a node.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawMassPoint {
    /// Position along the axis, measured from the start; must be a node of the mesh
    #[schemars(required, extend("unit" = "m", "minimum" = 0.0))]
    pub at_m: Option<f64>,
    /// Mass
    #[schemars(required, extend("unit" = "kg", "exclusiveMinimum" = 0.0))]
    pub mass_kg: Option<f64>,
    /// Moment of inertia about the bending axis of a beam
    #[schemars(extend("unit" = "kg·m²", "minimum" = 0.0, "default" = 0.0))]
    pub inertia_kg_m2: Option<f64>,
}

/// A spring between a node and the ground.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneRequired" = ["stiffness_n_m", "stiffness_nm"]))]
pub struct RawSpring {
    /// Position along the axis, measured from the start; must be a node of the mesh
    #[schemars(required, extend("unit" = "m", "minimum" = 0.0))]
    pub at_m: Option<f64>,
    /// Direction of the motion that it holds back; a rotational spring is "rotation"
    #[schemars(required)]
    pub direction: Option<SpringDirection>,
    /// Stiffness of a spring along or across the axis
    #[schemars(extend("unit" = "N/m", "exclusiveMinimum" = 0.0))]
    pub stiffness_n_m: Option<f64>,
    /// Stiffness of a rotational spring
    #[schemars(extend("unit" = "N·m", "exclusiveMinimum" = 0.0))]
    pub stiffness_nm: Option<f64>,
}

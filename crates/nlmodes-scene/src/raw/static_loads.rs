use schemars::JsonSchema;
use serde::Deserialize;

use super::matrices::name_or_numbers;
use super::response::word_or_vector;
use super::{NameOrNumbers, RawDirection, RawPlace};
use crate::scene::Side;

/// Weight: the whole mass, that of contact nodes included, in a uniform field.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawGravity {
    /// Acceleration
    #[serde(default = "standard_gravity")]
    #[schemars(extend("unit" = "m/s^2", "minimum" = 0.0, "default" = 9.81))]
    pub acceleration_m_s2: f64,
    /// Direction in which it pulls: "axial" or "transverse", by default along a rod and across a beam; for a structure
    /// from files, three numbers
    #[serde(default)]
    #[schemars(schema_with = "word_or_vector")]
    pub direction: Option<RawDirection>,
    /// Side toward which it pulls a rod or beam
    #[schemars(extend("default" = "positive"))]
    pub side: Option<Side>,
}

fn standard_gravity() -> f64 {
    9.81
}

/// A constant force.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(extend("oneRequired" = ["at_m", "node", "nodes", "row"]))]
pub struct RawStaticForce {
    /// Where and in which direction it acts
    #[serde(flatten)]
    pub place: RawPlace,
    /// Nodes that share the force equally: a node set of the mesh, or a list of nodes
    #[serde(default)]
    #[schemars(schema_with = "name_or_numbers")]
    pub nodes: Option<NameOrNumbers>,
    /// The force in this direction; negative values act against it
    #[schemars(extend("unit" = "N"))]
    pub force_n: f64,
}

/// Heat: a rod or beam that is warmer by the same everywhere, or the forces of a finite-element program.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawThermal {
    /// Coefficient of linear expansion
    #[schemars(extend("unit" = "1/K", "minimum" = 0.0))]
    pub expansion_1_k: Option<f64>,
    /// Rise in temperature since the gaps were measured
    #[schemars(extend("unit" = "K"))]
    pub temperature_k: Option<f64>,
    /// For a structure from files: table of thermal forces node,component,force_n, relative to the scene
    #[schemars(length(min = 1))]
    pub forces: Option<String>,
}

/// Displacements of the structure under its static loads with the contacts open, from a static step of a finite-element
/// program.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawStaticDisplacement {
    /// Table node,component,displacement_m, relative to the scene; nodes that are not listed do not move
    #[schemars(length(min = 1))]
    pub file: String,
}

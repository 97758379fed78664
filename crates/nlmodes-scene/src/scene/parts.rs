use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Section, SpringDirection};

/// A point mass at a node of a rod or beam.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MassPoint {
    /// Number of the node, 0 at the start.
    #[serde(default)]
    #[schemars(skip)]
    pub node: usize,
    /// Position along the axis, measured from the start; the mesh gets a node there
    #[serde(rename = "at_m")]
    #[schemars(extend("unit" = "m", "minimum" = 0.0))]
    pub at: f64,
    /// Mass
    #[serde(rename = "mass_kg")]
    #[schemars(extend("unit" = "kg", "exclusiveMinimum" = 0.0))]
    pub mass: f64,
    /// Moment of inertia about the bending axis of a beam
    #[serde(rename = "inertia_kg_m2", default)]
    #[schemars(extend("unit" = "kg·m²", "minimum" = 0.0))]
    pub inertia: f64,
    /// Number of the structure to which it belongs; default: the one under whose heading it is
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1))]
    pub structure: Option<usize>,
}

/// A spring between a node of a rod or beam and the ground.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GroundSpring {
    /// Number of the node, 0 at the start.
    pub node: usize,
    /// What it holds back.
    pub direction: SpringDirection,
    /// Stiffness, N/m, or N·m for a rotation.
    pub stiffness: f64,
}

/// A part of a rod or beam with its own section and material.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Segment {
    /// Number of the node at which it ends.
    pub to_node: usize,
    /// Position of that node, m.
    pub to: f64,
    /// Young's modulus, Pa.
    pub youngs_modulus: f64,
    /// Density, kg/m³.
    pub density: f64,
    /// Cross section.
    pub section: Section,
    /// Mass per length beside that of the section, kg/m.
    pub added_mass: f64,
}

/// Elements that are shorter beside some nodes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Refined {
    /// Nodes of the mesh before it was refined.
    pub beside: Vec<usize>,
    /// How many times shorter.
    pub factor: f64,
}

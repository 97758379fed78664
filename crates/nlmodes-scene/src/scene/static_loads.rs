//! Loads that do not change in time, and what they move.

use std::path::PathBuf;

use nlmodes_io::ContactNodes;
use serde::{Deserialize, Serialize};

use super::{BaseDirection, Place};

/// Static loads of a structure: weight, constant forces, heat, and displacements that are known from elsewhere.
///
/// On the linear structure each of them moves the places of its contacts, and so the gaps: nothing else of the motion
/// changes.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct StaticLoads {
    /// Gravity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity: Option<Gravity>,
    /// Constant forces.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub forces: Vec<StaticForce>,
    /// A uniform rise in temperature, or thermal forces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thermal: Option<Thermal>,
    /// Table of the displacement under loads that a finite-element program knows, contacts open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement: Option<PathBuf>,
}

impl StaticLoads {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The key of the first of them.
    pub fn first_key(&self) -> &'static str {
        match self {
            Self { gravity: Some(_), .. } => "gravity",
            Self { thermal: Some(_), .. } => "thermal",
            Self { displacement: Some(_), .. } => "static_displacement",
            _ => "static_force",
        }
    }
}

/// Gravity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Gravity {
    /// Acceleration along the direction, m/s²; negative on the negative side.
    pub acceleration: f64,
    /// The direction.
    pub direction: BaseDirection,
}

/// A constant force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StaticForce {
    /// Where it acts.
    pub at: ForcePlace,
    /// The force along the direction of the place, N.
    pub force: f64,
}

/// Where a constant force acts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ForcePlace {
    /// One place.
    One(Place),
    /// Nodes of a structure from files that share it equally.
    Nodes {
        /// The nodes.
        nodes: ContactNodes,
        /// Direction, a unit vector.
        direction: [f64; 3],
    },
}

/// A uniform rise in temperature, or thermal forces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Thermal {
    /// Uniform in rods and beams: the strain `α ΔT` of a body that is free to expand.
    Strain {
        /// Coefficient of linear expansion, 1/K.
        expansion: f64,
        /// Temperature above that of the drawing, K.
        temperature: f64,
    },
    /// Table of the forces of a structure from files.
    Forces(PathBuf),
}

use serde::{Deserialize, Serialize};

use super::SpringDirection;

/// A point mass at a node of a rod or beam.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MassPoint {
    /// Number of the node, 0 at the start.
    pub node: usize,
    /// Mass, kg.
    pub mass: f64,
    /// Moment of inertia about the bending axis, kg·m².
    pub inertia: f64,
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

use std::fmt;

use nlmodes_model::{DofKind, Side};

/// Direction in which a stop is touched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Along the axis.
    Axial,
    /// Across the axis, in the direction of the deflection.
    Transverse,
}

impl Direction {
    /// Lower-case name, as it stands in scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Axial => "axial",
            Self::Transverse => "transverse",
        }
    }

    /// The displacement that touches the stop.
    pub fn kind(self) -> DofKind {
        match self {
            Self::Axial => DofKind::Axial,
            Self::Transverse => DofKind::Deflection,
        }
    }
}

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A rigid one-sided stop in front of a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Position of the node along the axis, m.
    pub position: f64,
    /// Direction in which it is touched.
    pub direction: Direction,
    /// Side on which it stands.
    pub side: Side,
    /// Clearance at rest `g₀`, m; zero touches, negative presses.
    pub gap: f64,
}

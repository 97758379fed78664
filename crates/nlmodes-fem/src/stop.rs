use std::fmt;

use nlmodes_model::{ContactLaw, DofKind, Side};

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

/// A one-sided stop in front of a node, rigid or on a spring.
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
    /// Rigid, or with a contact stiffness.
    pub law: ContactLaw,
}

impl Stop {
    /// A rigid stop.
    pub fn rigid(position: f64, direction: Direction, side: Side, gap: f64) -> Self {
        Self { position, direction, side, gap, law: ContactLaw::Rigid }
    }

    /// The same stop on a spring of `stiffness`, N/m.
    pub fn on_spring(self, stiffness: f64) -> Self {
        Self { law: ContactLaw::Elastic { stiffness }, ..self }
    }
}

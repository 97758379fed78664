use std::fmt;

use nlmodes_model::{ContactLaw, DofKind, Side};

/// Direction of contact with a stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Along the axis.
    Axial,
    /// Across the axis, in the direction of the deflection.
    Transverse,
}

impl Direction {
    /// Lower-case name, as used in scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Axial => "axial",
            Self::Transverse => "transverse",
        }
    }

    /// The displacement toward the stop.
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

/// A one-sided stop at a node, rigid or elastic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Position of the node along the axis, m.
    pub position: f64,
    /// Direction of contact.
    pub direction: Direction,
    /// Side of the stop.
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

    /// The same stop with the contact stiffness `stiffness`, N/m.
    pub fn on_spring(self, stiffness: f64) -> Self {
        Self { law: ContactLaw::Elastic { stiffness }, ..self }
    }
}

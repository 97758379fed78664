use std::fmt;

use nlmodes_model::DofKind;

/// Support of an end of the structure.
///
/// | support | fixed in a rod | fixed in a beam |
/// | --- | --- | --- |
/// | clamped | axial | axial, deflection, rotation |
/// | pinned | axial | axial, deflection |
/// | sliding | nothing | axial, rotation |
/// | free | nothing | nothing |
///
/// A sliding end moves in a guide without friction. For a beam the guide is perpendicular to the axis, so that the end
/// cannot rotate but is free to deflect; for a rod it is along the axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum Support {
    /// Cannot move.
    Clamped,
    /// Cannot be displaced, but can rotate.
    Pinned,
    /// Guided: a beam end deflects without rotation, a rod end moves along the axis.
    Sliding,
    /// Not supported.
    #[default]
    Free,
}

impl Support {
    /// Lower-case name, as used in scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Clamped => "clamped",
            Self::Pinned => "pinned",
            Self::Sliding => "sliding",
            Self::Free => "free",
        }
    }

    /// Degrees of freedom fixed in a beam.
    pub(crate) fn holds_of_beam(self) -> &'static [DofKind] {
        match self {
            Self::Clamped => &[DofKind::Axial, DofKind::Deflection, DofKind::Rotation],
            Self::Pinned => &[DofKind::Axial, DofKind::Deflection],
            Self::Sliding => &[DofKind::Axial, DofKind::Rotation],
            Self::Free => &[],
        }
    }

    /// Degrees of freedom fixed in a rod.
    pub(crate) fn holds_of_rod(self) -> &'static [DofKind] {
        match self {
            Self::Clamped | Self::Pinned => &[DofKind::Axial],
            Self::Sliding | Self::Free => &[],
        }
    }
}

impl fmt::Display for Support {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

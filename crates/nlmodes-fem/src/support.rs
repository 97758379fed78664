use std::fmt;

use nlmodes_model::DofKind;

/// What holds an end of the structure.
///
/// | support | rod holds | beam holds |
/// | --- | --- | --- |
/// | clamped | axial | axial, deflection, rotation |
/// | pinned | axial | axial, deflection |
/// | sliding | nothing | axial, rotation |
/// | free | nothing | nothing |
///
/// A sliding end moves in a guide without friction. The guide of a beam stands across its axis, so that the end keeps
/// its direction and is free to deflect; the guide of a rod runs along it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum Support {
    /// Cannot move.
    Clamped,
    /// Cannot be displaced, but turns.
    Pinned,
    /// Guided: a beam end deflects without turning, a rod end moves along the axis.
    Sliding,
    /// Not held.
    #[default]
    Free,
}

impl Support {
    /// Lower-case name, as it stands in scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Clamped => "clamped",
            Self::Pinned => "pinned",
            Self::Sliding => "sliding",
            Self::Free => "free",
        }
    }

    /// What it holds of a beam.
    pub(crate) fn holds_of_beam(self) -> &'static [DofKind] {
        match self {
            Self::Clamped => &[DofKind::Axial, DofKind::Deflection, DofKind::Rotation],
            Self::Pinned => &[DofKind::Axial, DofKind::Deflection],
            Self::Sliding => &[DofKind::Axial, DofKind::Rotation],
            Self::Free => &[],
        }
    }

    /// What it holds of a rod.
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

use nlmodes_io::{ContactChoice, FeFiles};
use serde::{Deserialize, Serialize};

use super::{ReductionKind, Structure};

/// How the structure is reduced.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reduction {
    /// By open or by held modes.
    pub kind: ReductionKind,
    /// Number of open modes that are retained; where neither this nor a frequency is given, the highest harmonic
    /// decides.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modes: Option<usize>,
    /// Frequency up to which open modes are retained, Hz.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub up_to_hz: Option<f64>,
}

/// A structure from the files of a finite-element program.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Matrices {
    /// The files, with paths from where the program is started.
    pub files: FeFiles,
    /// What stands under `[[contact]]`, in the order of the file.
    pub contacts: Vec<ContactChoice>,
    /// Whether the scene says nothing of the units of the files, so that they are taken for m-kg-s.
    #[serde(skip)]
    pub units_are_assumed: bool,
}

/// What a scene computes with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum SceneStructure {
    /// A straight rod or beam.
    Straight(Structure),
    /// Matrices from files.
    Matrices(Matrices),
    /// Several rods and beams.
    Several(Vec<Structure>),
}

impl SceneStructure {
    /// The rod or beam, if it is one.
    pub fn straight(&self) -> Option<&Structure> {
        match self {
            Self::Straight(structure) => Some(structure),
            Self::Matrices(_) | Self::Several(_) => None,
        }
    }

    /// The rod or beam to be changed, if it is one.
    pub fn straight_mut(&mut self) -> Option<&mut Structure> {
        match self {
            Self::Straight(structure) => Some(structure),
            Self::Matrices(_) | Self::Several(_) => None,
        }
    }

    /// The files, if it is from files.
    pub fn matrices(&self) -> Option<&Matrices> {
        match self {
            Self::Straight(_) | Self::Several(_) => None,
            Self::Matrices(matrices) => Some(matrices),
        }
    }

    /// All rods and beams.
    pub fn bodies(&self) -> &[Structure] {
        match self {
            Self::Straight(structure) => std::slice::from_ref(structure),
            Self::Several(structures) => structures,
            Self::Matrices(_) => &[],
        }
    }
}

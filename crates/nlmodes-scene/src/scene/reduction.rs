use nlmodes_io::{ContactChoice, FeFiles};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{LawContact, ReducedModel, ReductionKind, Structure};

/// Most modes that a scene may retain.
const MAX_MODES: u32 = 10_000;

/// How the structure is reduced.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct Reduction {
    /// Modes with open contacts and the static flexibility of all others, which moves no mass, or modes with held
    /// contacts, whose nodes lose their mass; default: "open-modes", but "held-modes" for a rod or beam whose scene has
    /// `method.mass_redistribution` or `method.held_modes`, or is for hbm
    pub kind: Option<ReductionKind>,
    /// Number of free-interface modes that are kept; default: those up to four times the highest harmonic
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = MAX_MODES))]
    pub modes: Option<usize>,
    /// Frequency up to which free-interface modes are kept, instead of `modes`
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub up_to_hz: Option<f64>,
}

/// A structure from the files of a finite-element program.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Matrices {
    /// The files, with paths from where the program is started.
    pub files: FeFiles,
    /// The tables `[[contact]]`, in the order of the file.
    pub contacts: Vec<ContactChoice>,
    /// Those whose stops have a law of force, which stand behind the others.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub law_contacts: Vec<LawContact<ContactChoice>>,
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
    /// Modes and flexibility that another program computed.
    Reduced(ReducedModel),
}

impl SceneStructure {
    /// The rod or beam, if it is one.
    pub fn straight(&self) -> Option<&Structure> {
        match self {
            Self::Straight(structure) => Some(structure),
            Self::Matrices(_) | Self::Several(_) | Self::Reduced(_) => None,
        }
    }

    /// The rod or beam to be changed, if it is one.
    pub fn straight_mut(&mut self) -> Option<&mut Structure> {
        match self {
            Self::Straight(structure) => Some(structure),
            Self::Matrices(_) | Self::Several(_) | Self::Reduced(_) => None,
        }
    }

    /// The files, if it is from files.
    pub fn matrices(&self) -> Option<&Matrices> {
        match self {
            Self::Straight(_) | Self::Several(_) | Self::Reduced(_) => None,
            Self::Matrices(matrices) => Some(matrices),
        }
    }

    /// What another program computed, if the structure was reduced elsewhere.
    pub fn reduced(&self) -> Option<&ReducedModel> {
        match self {
            Self::Straight(_) | Self::Several(_) | Self::Matrices(_) => None,
            Self::Reduced(model) => Some(model),
        }
    }

    /// All rods and beams.
    pub fn bodies(&self) -> &[Structure] {
        match self {
            Self::Straight(structure) => std::slice::from_ref(structure),
            Self::Several(structures) => structures,
            Self::Matrices(_) | Self::Reduced(_) => &[],
        }
    }
}

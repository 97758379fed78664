use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;

use super::{RawAnalysis, RawStopLaw};
use crate::scene::{Numbers, ReducedKind, Side};

/// Most rows of a structure that was reduced elsewhere.
pub const MAX_ROWS: u32 = 10_000;

/// A scene of nlmodes: a structure that another program reduced to modes and the flexibility of some displacements, its
/// contacts, and how its nonlinear mode is to be computed.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(title = "nlmodes scene of a reduced model")]
pub struct RawReducedScene {
    /// The structure: what another program computed of it
    pub structure: RawReduced,
    /// One-sided contacts of its rows, any number, each under its own heading `[[contact]]`
    pub contact: Option<Vec<RawRowContact>>,
    /// Everything else
    #[serde(flatten)]
    pub analysis: RawAnalysis,
}

/// Modes and flexibility of a structure.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(extend("oneRequired" = ["flexibility_m_n", "residual_flexibility_m_n"]))]
pub struct RawReduced {
    /// Material of the structure
    #[serde(rename = "kind")]
    pub _kind: ReducedKind,
    /// Frequencies of the modes with open contacts, ascending, 0 for each rigid-body motion: a list, or a file .npz
    /// ("modes.npz#frequencies"), .npy, .csv or .txt, relative to the scene
    #[schemars(schema_with = "frequencies")]
    pub frequencies_hz: Numbers,
    /// Displacements of contacts and of places where forces act (the rows) in the mass-normalised modes, 1/√kg: rows ×
    /// modes or modes × rows, as a file or a list of lists
    #[schemars(schema_with = "rows")]
    pub contact_rows: Numbers,
    /// Static displacements of the rows under unit forces along them, including the share of the modes: rows × rows,
    /// symmetric
    #[serde(default)]
    #[schemars(schema_with = "flexibility")]
    pub flexibility_m_n: Option<Numbers>,
    /// The same without the share of the modes, instead of `flexibility_m_n`; floating structures have only this one
    #[serde(default)]
    #[schemars(schema_with = "flexibility")]
    pub residual_flexibility_m_n: Option<Numbers>,
    /// A mesh and the displacements of its nodes, for pictures of the motion
    #[serde(default)]
    pub picture: Option<RawPicture>,
    /// Units of the files, SI or as mm-t-s; numbers of the scene and frequencies are in those of their keys
    #[schemars(length(min = 1), extend("default" = "m-kg-s"))]
    pub units: Option<String>,
}

/// The displacements of the nodes of a mesh in the same modes.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawPicture {
    /// Displacements of nodes in the modes of the structure, 1/√kg: a line for each displacement or for each mode, as
    /// `contact_rows`
    #[schemars(schema_with = "rows")]
    pub rows: Numbers,
    /// Their static displacements under unit forces along `contact_rows`, displacements × rows, with the share of the
    /// modes where that of the structure has it; left out, pictures show the modes alone
    #[serde(default)]
    #[schemars(schema_with = "flexibility")]
    pub flexibility_m_n: Option<Numbers>,
    /// Node and direction of each displacement (.dof, .mapping, or .csv with row,node,component[,x,y,z]), relative to
    /// the scene; what is not listed is drawn at rest
    #[schemars(length(min = 1))]
    pub dofs: String,
    /// Coordinates and elements (.inp, .msh), relative to the scene
    #[schemars(length(min = 1))]
    pub mesh: String,
}

/// A stop before a row of the structure; of two bodies that touch each other the row is their approach.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawRowContact {
    /// Number of the row of `contact_rows`, from 1
    #[schemars(range(min = 1, max = MAX_ROWS))]
    pub row: u32,
    /// Sign of the displacements of the row that the stop limits
    #[schemars(extend("default" = "positive"))]
    pub side: Option<Side>,
    /// Clearance at rest; at 0 the stop just touches, and a negative gap preloads it
    #[schemars(extend("unit" = "m"))]
    pub gap_m: f64,
    /// How it yields and dissipates
    #[serde(flatten)]
    pub stop: RawStopLaw,
}

fn frequencies(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": ["string", "array"],
        "minLength": 1,
        "minItems": 1,
        "items": { "type": "number", "minimum": 0.0 },
        "unit": "Hz",
        "expected": "frequencies in square brackets, each 0 or more, or a file as \"modes.npz#frequencies\"",
    })
}

fn rows(_: &mut SchemaGenerator) -> Schema {
    table("lists of numbers in square brackets, or a file as \"modes.npz#rows\"", "1/√kg")
}

fn flexibility(_: &mut SchemaGenerator) -> Schema {
    table("lists of numbers in square brackets, or a file as \"modes.npz#flexibility\"", "m/N")
}

fn table(expected: &str, unit: &str) -> Schema {
    json_schema!({
        "type": ["string", "array"],
        "minLength": 1,
        "minItems": 1,
        "items": { "type": "array", "minItems": 1, "items": { "type": "number" } },
        "unit": unit,
        "expected": expected,
    })
}

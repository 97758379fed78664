use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;

use super::MAX_BODIES;
use super::reduced::MAX_ROWS;
use crate::scene::{Direction, Response, StopOfBase};

/// Damping of the structure with its contacts open: one of `ratio`, `ratios`, `rayleigh`, and dashpots beside it or
/// alone. Of several structures each has this one where it has none of its own.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawDamping {
    /// Of the modes
    #[serde(flatten)]
    pub modes: RawModeDamping,
    /// Dashpots to the ground, each under its own heading `[[damping.dashpot]]`
    pub dashpot: Option<Vec<RawDashpot>>,
}

/// Damping of one structure of several, with its contacts open: one of these.
#[derive(Debug, Default, Deserialize, JsonSchema)]
pub struct RawModeDamping {
    /// Damping ratio of all modes
    #[schemars(range(min = 0.0), extend("exclusiveMaximum" = 1.0))]
    pub ratio: Option<f64>,
    /// Damping ratios by mode; the last one is repeated
    #[schemars(length(min = 1, max = 1000), inner(range(min = 0.0, max = 0.99)))]
    pub ratios: Option<Vec<f64>>,
    /// Damping proportional to mass and stiffness
    pub rayleigh: Option<RawRayleigh>,
}

/// `C = mass M + stiffness K`.
#[derive(Debug, Default, Deserialize, JsonSchema)]
pub struct RawRayleigh {
    /// Factor of the mass matrix
    #[schemars(range(min = 0.0), extend("unit" = "1/s", "default" = 0.0))]
    pub mass_1_s: Option<f64>,
    /// Factor of the stiffness matrix
    #[schemars(range(min = 0.0), extend("unit" = "s", "default" = 0.0))]
    pub stiffness_s: Option<f64>,
}

/// A direction of a rod or beam in a word, or of a structure from files as a vector.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum RawDirection {
    /// Along or across the axis.
    Word(Direction),
    /// Components along x, y and z, of any length.
    Vector(Vec<f64>),
}

/// `"axial"`, `"transverse"` or three numbers.
pub(super) fn word_or_vector(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": ["string", "array"],
        "enum_of_text": ["axial", "transverse"],
        "items": { "type": "number" },
        "minItems": 3,
        "maxItems": 3,
    })
}

/// A place of the structure, and a direction there.
#[derive(Debug, Default, Deserialize, JsonSchema)]
pub struct RawPlace {
    /// Position along the axis of a rod or beam, at a node or between two
    #[schemars(extend("unit" = "m", "minimum" = 0.0))]
    pub at_m: Option<f64>,
    /// Number of the structure to which `at_m` belongs, if there are several; from 1 in the order of the file
    #[schemars(range(min = 1, max = MAX_BODIES))]
    pub structure: Option<u32>,
    /// Node of a structure from files, instead of `at_m`
    pub node: Option<u64>,
    /// Row of a structure that was reduced elsewhere, from 1, instead of `at_m`; a row implies its direction
    #[schemars(range(min = 1, max = MAX_ROWS))]
    pub row: Option<u32>,
    /// Direction: "axial" or "transverse", by default along a rod and across a beam; for a structure from files, three
    /// numbers
    #[serde(default)]
    #[schemars(schema_with = "word_or_vector")]
    pub direction: Option<RawDirection>,
}

/// A dashpot between a place of the structure and the ground.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawDashpot {
    /// Where it is, and the direction of the motion that it damps
    #[serde(flatten)]
    pub place: RawPlace,
    /// Damping constant
    #[schemars(range(min = 0.0), extend("unit" = "N s/m"))]
    pub damping_n_s_m: f64,
}

/// A periodic force.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawForce {
    /// Where and in which direction it acts
    #[serde(flatten)]
    pub place: RawPlace,
    /// Amplitude. The `levels_n` of a response replace that of the first force; others keep their ratio to it
    #[schemars(extend("unit" = "N", "default" = 1.0))]
    pub amplitude_n: Option<f64>,
    /// Harmonic of the frequency of the response
    #[schemars(range(min = 1, max = 1000), extend("default" = 1))]
    pub harmonic: Option<u32>,
    /// Phase lead over a cosine
    #[schemars(range(min = -3600.0, max = 3600.0), extend("unit" = "deg", "default" = 0.0))]
    pub phase_deg: Option<f64>,
}

/// Motion of the base, instead of forces.
#[derive(Debug, Default, Deserialize, JsonSchema)]
pub struct RawBaseMotion {
    /// Direction: "axial" or "transverse", by default along a rod and across a beam; for a structure from files, three
    /// numbers
    #[serde(default)]
    #[schemars(schema_with = "word_or_vector")]
    pub direction: Option<RawDirection>,
    /// Amplitude of the acceleration
    #[schemars(extend("unit" = "m/s^2", "exclusiveMinimum" = 0.0))]
    pub acceleration_m_s2: Option<f64>,
    /// Amplitude of the displacement, instead of the acceleration
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
    pub amplitude_m: Option<f64>,
    /// Whether the stops move with the base or are fixed in space
    #[schemars(extend("default" = "moves"))]
    pub stop: Option<StopOfBase>,
}

/// A curve of damped or forced motions; several are written under headings `[[response]]`.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawResponse {
    /// What is followed, and how
    #[serde(flatten)]
    pub response: Response,
    /// Amplitudes of the first force: with kind = "frequency" a curve for each, otherwise the largest ends the curve;
    /// default: `amplitude_n`
    #[schemars(length(min = 1, max = 100), extend("unit" = "N"), inner(range(min = 1e-30)))]
    pub levels_n: Option<Vec<f64>>,
    /// Amplitudes of the acceleration of the base, likewise; default: `acceleration_m_s2`
    #[schemars(length(min = 1, max = 100), extend("unit" = "m/s^2"), inner(range(min = 1e-30)))]
    pub levels_m_s2: Option<Vec<f64>>,
    /// Amplitudes of the displacement of the base, likewise; default: `amplitude_m`
    #[schemars(length(min = 1, max = 100), extend("unit" = "m"), inner(range(min = 1e-30)))]
    pub levels_m: Option<Vec<f64>>,
    /// Position of the drive point; default: that of the first force, or with base motion of the first stop
    #[schemars(extend("unit" = "m", "minimum" = 0.0))]
    pub drive_m: Option<f64>,
    /// Number of the structure to which `drive_m` belongs, if there are several; from 1 in the order of the file
    #[schemars(range(min = 1, max = MAX_BODIES))]
    pub drive_structure: Option<u32>,
    /// Node of the drive point of a structure from files, instead of `drive_m`
    pub drive_node: Option<u64>,
    /// Row of the drive point of a structure that was reduced elsewhere, instead of `drive_m`
    #[schemars(range(min = 1, max = MAX_ROWS))]
    pub drive_row: Option<u32>,
    /// Direction of the motion of the drive point; default: that of the first force
    #[serde(default)]
    #[schemars(schema_with = "word_or_vector")]
    pub drive_direction: Option<RawDirection>,
}

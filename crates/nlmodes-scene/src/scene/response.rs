//! Damped and forced motions of a scene.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use super::{Direction, ResponseKind, StopOfBase, is_first};

/// Position of a load or of an observed motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "place")]
pub enum Place {
    /// Somewhere along a rod or beam, at a node or between two.
    Along {
        /// Position, m.
        at: f64,
        /// Direction.
        direction: Direction,
        /// Index of the structure of several, from 0.
        #[serde(default, skip_serializing_if = "is_first")]
        structure: usize,
    },
    /// A node of a structure from files.
    Node {
        /// Its number there.
        node: u64,
        /// Direction, a unit vector.
        direction: [f64; 3],
    },
    /// A row of a structure that was reduced elsewhere.
    Row {
        /// Its number, from 1.
        row: usize,
    },
}

/// Damping of the structure with its contacts open.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Damping {
    /// Of the modes.
    pub modes: ModeDamping,
    /// Dashpots to the ground.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub dashpots: Vec<Dashpot>,
}

/// Damping of the modes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ModeDamping {
    /// Damping ratios by mode; the last one is repeated.
    Ratios(Vec<f64>),
    /// `C = mass M + stiffness K`.
    Rayleigh {
        /// Factor of the mass, 1/s.
        mass: f64,
        /// Factor of the stiffness, s.
        stiffness: f64,
    },
}

/// A dashpot to the ground.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Dashpot {
    /// Where it is, and the direction of the motion that it damps.
    #[serde(flatten)]
    pub place: Place,
    /// Its constant, N s/m.
    pub damping: f64,
}

/// A periodic force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Force {
    /// Where and in which direction it acts.
    #[serde(flatten)]
    pub place: Place,
    /// Amplitude, N.
    pub amplitude: f64,
    /// Harmonic of the frequency of the response.
    pub harmonic: usize,
    /// Phase, degrees.
    pub phase_deg: f64,
}

/// The direction in which a base shakes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum BaseDirection {
    /// Along or across the axis of a rod or beam.
    Along(Direction),
    /// A unit vector, of a structure from files.
    Vector([f64; 3]),
}

/// A base that shakes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BaseMotion {
    /// Direction.
    pub direction: BaseDirection,
    /// Amplitude, m/s² or m; zero if given only by the levels of the responses.
    pub amplitude: f64,
    /// Whether levels are those of the acceleration, and not of the displacement.
    pub is_acceleration: bool,
    /// Whether the stops move with it.
    pub stop: StopOfBase,
}

/// A curve of damped or forced motions, or one for each level; several are written under headings `[[response]]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Response {
    /// What is computed
    pub kind: ResponseKind,
    /// Frequency window [lowest, highest] of the load, or of a mode; with kind = "force", one frequency
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(schema_with = "one_or_two_frequencies")]
    pub frequency_hz: Vec<f64>,
    /// Levels in the unit of the load; empty for modes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip)]
    pub levels: Vec<f64>,
    /// The drive point, if given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(skip)]
    pub drive: Option<Place>,
    /// Angle by which the drive point lags the load at phase resonance
    #[serde(default = "quarter_turn")]
    #[schemars(extend("unit" = "deg", "exclusiveMinimum" = 0.0, "exclusiveMaximum" = 180.0))]
    pub lag_deg: f64,
    /// Number of periods of the load in one period of the motion
    #[serde(default = "one")]
    #[schemars(range(min = 1, max = 20))]
    pub subharmonic: usize,
    /// Number of harmonics of the force that appropriation controls
    #[serde(default = "one")]
    #[schemars(range(min = 1, max = 1000))]
    pub controlled_harmonics: usize,
    /// Whether each level is also swept up and down in time, slowly and from rest, and overlaid on its curve
    #[serde(default, skip_serializing_if = "is_off")]
    pub sweep: bool,
    /// Length of each sweep; by default the frequency moves by a quarter of the mode's bandwidth 2 ζ f in the time 1/(2
    /// ζ f)
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("unit" = "s", "exclusiveMinimum" = 0.0))]
    pub sweep_s: Option<f64>,
}

impl Response {
    /// The conservative nonlinear mode.
    pub fn nonlinear_mode() -> Self {
        Self {
            kind: ResponseKind::Mode,
            frequency_hz: Vec::new(),
            levels: Vec::new(),
            drive: None,
            lag_deg: quarter_turn(),
            subharmonic: 1,
            controlled_harmonics: 1,
            sweep: false,
            sweep_s: None,
        }
    }
}

/// A number, or a list of them; a single one is read as a list.
fn one_or_two_frequencies(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": ["number", "array"],
        "exclusiveMinimum": 0.0,
        "items": { "type": "number", "exclusiveMinimum": 0.0 },
        "minItems": 1,
        "maxItems": 2,
        "unit": "Hz",
    })
}

fn is_off(is_on: &bool) -> bool {
    !is_on
}

fn quarter_turn() -> f64 {
    90.0
}

fn one() -> usize {
    1
}

impl ResponseKind {
    /// Whether the motions answer a load; modes need none.
    pub fn is_forced(self) -> bool {
        matches!(self, ResponseKind::Frequency | ResponseKind::Force | ResponseKind::PhaseResonance)
    }
}

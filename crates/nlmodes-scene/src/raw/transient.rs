use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;

use super::RawPlace;

/// Most places whose motion is written.
const MAX_PLACES: u32 = 1000;

/// A motion in time under any loads, instead of a branch or responses.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawTransient {
    /// Its length
    #[schemars(extend("unit" = "s", "exclusiveMinimum" = 0.0))]
    pub duration_s: f64,
    /// How it begins: undeformed and still, at rest under static loads and stops, or on a motion that was computed
    #[serde(default)]
    #[schemars(schema_with = "start")]
    pub from: RawStart,
    /// Samples per second of the histories; default: 64 per period of the highest frequency of the loads or, if that is
    /// higher, of the lowest mode, and no fewer than a table has
    #[schemars(extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub sample_rate_hz: Option<f64>,
    /// Number of equal parts of the duration for which the envelope has the largest and the smallest value
    #[schemars(range(min = 1, max = 1_000_000), extend("default" = 500))]
    pub envelope_windows: Option<u32>,
    /// Loads, each under its own heading `[[transient.load]]`
    pub load: Option<Vec<RawTransientLoad>>,
    /// Places whose motion is written, each under its own heading `[[transient.place]]`; default: those of the loads.
    /// Contacts are always written
    #[schemars(length(max = MAX_PLACES))]
    pub place: Option<Vec<RawPlace>>,
}

/// Where a motion begins.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum RawStart {
    /// `"rest"` or `"static"`.
    Word(StartWord),
    /// A point of results.
    Point {
        /// Directory written by a run.
        results: String,
        /// Number of the point, as in its `branch.csv`.
        point: usize,
    },
}

/// Starts without motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum StartWord {
    /// Undeformed.
    Rest,
    /// Where static loads and stops that press leave it.
    Static,
}

impl Default for RawStart {
    fn default() -> Self {
        Self::Word(StartWord::Rest)
    }
}

fn start(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": ["string", "object"],
        "enum_of_text": ["rest", "static"],
        "properties": {
            "results": { "type": "string", "minLength": 1, "description": "Directory that a run has written" },
            "point": { "type": "integer", "minimum": 0, "description": "Number of the point, as in its branch.csv" },
        },
        "required": ["results", "point"],
        "additionalProperties": false,
        "default": "rest",
        "expected": "\"rest\", \"static\" or { results = \"results/beam\", point = 40 }",
    })
}

/// A load: a force at a place or the acceleration of the base, and its course in time.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawTransientLoad {
    /// Where and in which direction it acts; of a base the direction alone
    #[serde(flatten)]
    pub place: RawPlace,
    /// Quantity of the base that is given, instead of a force; stops move with the base
    #[serde(default)]
    #[schemars(schema_with = "base")]
    pub base: Option<String>,
    /// When it begins
    #[serde(default)]
    #[schemars(extend("unit" = "s", "minimum" = 0.0, "default" = 0.0))]
    pub start_s: f64,
    /// A steady cosine
    pub sine: Option<RawSine>,
    /// A cosine whose frequency changes at a constant rate
    pub chirp: Option<RawChirp>,
    /// Table time_s,force_n, or time_s,acceleration_m_s2 of a base, joined by straight lines, zero before and behind:
    /// .csv with or without these names above, .npy or .npz#array with two columns; relative to the scene
    #[schemars(length(min = 1))]
    pub table: Option<String>,
    /// Noise with a flat spectrum in a band
    pub noise: Option<RawTransientNoise>,
    /// Half a period of a sine
    pub half_sine: Option<RawHalfSine>,
    /// An impulse without duration
    pub impact: Option<RawImpact>,
}

fn base(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "string", "enum": ["acceleration"] })
}

/// `A cos(2π f t + phase)`.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(extend("oneRequired" = ["amplitude_n", "amplitude_m_s2"]))]
pub struct RawSine {
    /// Amplitude of a force
    #[schemars(extend("unit" = "N"))]
    pub amplitude_n: Option<f64>,
    /// Amplitude of an acceleration of the base
    #[schemars(extend("unit" = "m/s^2"))]
    pub amplitude_m_s2: Option<f64>,
    /// Frequency
    #[schemars(extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub frequency_hz: f64,
    /// Phase lead over a cosine
    #[serde(default)]
    #[schemars(range(min = -3600.0, max = 3600.0), extend("unit" = "deg", "default" = 0.0))]
    pub phase_deg: f64,
}

/// `A cos φ(t)` with `φ' = 2π f(t)`, f linear in time.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(extend("oneRequired" = ["amplitude_n", "amplitude_m_s2"]))]
pub struct RawChirp {
    /// Amplitude of a force
    #[schemars(extend("unit" = "N"))]
    pub amplitude_n: Option<f64>,
    /// Amplitude of an acceleration of the base
    #[schemars(extend("unit" = "m/s^2"))]
    pub amplitude_m_s2: Option<f64>,
    /// Frequency at the beginning
    #[schemars(extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub from_hz: f64,
    /// Frequency at the end, or where it turns back
    #[schemars(extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub to_hz: f64,
    /// Whether it returns to the first frequency in the second half
    #[serde(default)]
    pub back: bool,
    /// Length; default: to the end of the motion
    #[schemars(extend("unit" = "s", "exclusiveMinimum" = 0.0))]
    pub length_s: Option<f64>,
}

/// Noise in a band.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(extend("oneRequired" = ["rms_n", "rms_m_s2"]))]
pub struct RawTransientNoise {
    /// Root mean square of a force
    #[schemars(extend("unit" = "N", "exclusiveMinimum" = 0.0))]
    pub rms_n: Option<f64>,
    /// Root mean square of an acceleration of the base
    #[schemars(extend("unit" = "m/s^2", "exclusiveMinimum" = 0.0))]
    pub rms_m_s2: Option<f64>,
    /// Lowest and highest frequency
    #[schemars(inner(range(min = 0.0)), extend("unit" = "Hz"))]
    pub band_hz: [f64; 2],
    /// Seed: the same number gives the same noise
    #[serde(default)]
    #[schemars(extend("default" = 0))]
    pub seed: u32,
}

/// `A sin(π t / w)` for a width.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(extend("oneRequired" = ["peak_n", "peak_m_s2"]))]
pub struct RawHalfSine {
    /// Largest force
    #[schemars(extend("unit" = "N"))]
    pub peak_n: Option<f64>,
    /// Largest acceleration of the base
    #[schemars(extend("unit" = "m/s^2"))]
    pub peak_m_s2: Option<f64>,
    /// Its width
    #[schemars(extend("unit" = "s", "exclusiveMinimum" = 0.0))]
    pub width_s: f64,
}

/// A blow.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawImpact {
    /// Impulse: the force integrated over time
    #[schemars(extend("unit" = "N s"))]
    pub impulse_ns: f64,
}

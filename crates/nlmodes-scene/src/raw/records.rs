//! The tables of a scene of measured records.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;

use crate::raw::RawStructure;
use crate::scene::{ChannelRole, Directory, MAX_HARMONICS, MeasuredQuantity, Overlay, Side};

/// Most numbers of a list.
const MAX_LIST: u32 = 4096;

/// Records of a test, and what is to be extracted from them. SI units unless a channel says otherwise.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(title = "nlmodes scene of measured records")]
pub struct RawRecordScene {
    /// Title of tables and figures; default: the name of the file
    pub title: Option<String>,
    /// The files of the records, and how they were sampled
    pub recording: RawRecording,
    /// Channels of the records, each under its own heading `[[channel]]`
    #[schemars(length(min = 1))]
    pub channel: Vec<RawChannel>,
    /// Parts of the recording in which a level is held, each a row of the table and under a heading `[[segment]]`;
    /// without them, a record is one level
    pub segment: Option<Vec<RawRecordSegment>>,
    /// For records that end in a free decay after the drive is switched off: frequency and damping over amplitude
    pub free_decay: Option<RawFreeDecay>,
    /// Mass-normalised linear modes at the response channels; without them there are no modal quantities
    pub linear_modes: Option<RawLinearModes>,
    /// The structure, instead of `linear_modes`: its linear modes at the sensors are computed, without damping
    pub structure: Option<RawStructure>,
    /// What is extracted from the records
    pub extraction: Option<RawExtraction>,
    /// The stop whose restitution and contact stiffness are evaluated
    pub stop: Option<RawStop>,
    /// Computed branches, or other tests, that figures and page show beside the records, each under a heading
    /// `[[overlay]]`
    pub overlay: Option<Vec<Overlay>>,
    /// Where results are written, and which
    pub output: Option<Directory>,
}

/// Files of records.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawRecording {
    /// Files, a record each: .csv, .uff or .unv (58, 58b), .wav, .npy, .tdms, .mat, .h5; behind # the structure, cell
    /// or array that is meant in the last two (run.mat#Tests{2}); paths from where the scene is
    #[schemars(length(min = 1, max = MAX_LIST))]
    pub files: Vec<String>,
    /// Sampling rate; must agree with the time column or the header to 1e-6
    #[schemars(extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub sample_rate_hz: Option<f64>,
    /// Name of the time column of .csv files, or of the array of times in .mat and .h5 files, in s
    #[schemars(length(min = 1))]
    pub time_column: Option<String>,
    /// "steady": the parts of each record in which force, motion, lag and frequency are steady are its segments
    pub segments: Option<Found>,
}

/// How segments are found.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Found {
    /// Where force, motion, the lag between them and the frequency are steady.
    Steady,
}

/// A part of a recording in which a level is held: `from_s` and `to_s`, or `flag`, or `segments`.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawRecordSegment {
    /// Name in the table, the figures and on the page; default: its number
    #[schemars(length(min = 1))]
    pub name: Option<String>,
    /// One of `recording.files`; default: all of them
    #[schemars(length(min = 1))]
    pub file: Option<String>,
    /// When it begins, on the time axis of the file; without a time axis, the first sample is at 0
    #[schemars(extend("unit" = "s"))]
    pub from_s: Option<f64>,
    /// When it ends
    #[schemars(extend("unit" = "s"))]
    pub to_s: Option<f64>,
    /// A channel that is not zero while a level is held, instead of `from_s` and `to_s`: any of its names, or in files
    /// without names its number, from 1. Every such interval is a segment
    #[schemars(length(min = 1))]
    pub flag: Option<String>,
    /// "steady": the parts in which force, motion, lag and frequency are steady, in place of `from_s` and `to_s`
    pub segments: Option<Found>,
}

/// The free decay at the end of a record.
#[derive(Debug, Default, Deserialize, JsonSchema)]
pub struct RawFreeDecay {
    /// When the decay begins, on the time axis of the file; default: where the force has ended
    #[schemars(extend("unit" = "s"))]
    pub from_s: Option<f64>,
    /// When it ends; default: at the end of the record, or where it sinks into noise
    #[schemars(extend("unit" = "s"))]
    pub to_s: Option<f64>,
}

/// A channel of the records.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawChannel {
    /// Name of the column, or the name in the header; in files without names (.wav, .npy), channels are taken in the
    /// order of the headings
    #[schemars(length(min = 1))]
    pub name: String,
    /// What the channel measures
    pub quantity: MeasuredQuantity,
    /// Unit of the recorded numbers, for instance N, m, mm, m/s, m/s^2, g, rad; default: the SI unit
    #[schemars(length(min = 1))]
    pub unit: Option<String>,
    /// What the channel is used for
    pub role: ChannelRole,
    /// Position along the structure, where the channel has one
    #[schemars(extend("unit" = "m"))]
    pub position_m: Option<f64>,
    /// 1, or -1 for a sensor that is mounted the other way round
    #[schemars(range(min = -1, max = 1), extend("default" = 1))]
    pub sign: Option<i32>,
    /// Recorded number per unit
    #[schemars(extend("default" = 1.0, "exclusiveMinimum" = 0.0))]
    pub sensitivity: Option<f64>,
    /// Delay of the signal
    #[schemars(extend("default" = 0.0, "unit" = "s"))]
    pub delay_s: Option<f64>,
    /// Measuring range of the sensor, [smallest, largest], in `unit`
    pub range: Option<[f64; 2]>,
    /// Relative standard error of the sensitivity. It becomes part of those of all results, and of how closely the
    /// channel is compared with the others (5 % if left out)
    #[schemars(extend("minimum" = 0.0, "maximum" = 1.0))]
    pub uncertainty: Option<f64>,
}

/// Mass-normalised linear modes.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawLinearModes {
    /// Eigenfrequencies
    #[schemars(inner(range(min = 1e-9)), length(min = 1, max = MAX_LIST), extend("unit" = "Hz"))]
    pub frequencies_hz: Vec<f64>,
    /// Damping ratios; default: zero
    #[schemars(inner(range(min = 0.0)), length(min = 1, max = MAX_LIST))]
    pub damping_ratios: Option<Vec<f64>>,
    /// Relative standard error of the frequencies, which enters that of the contact force by balance
    #[schemars(extend("default" = 1e-3, "minimum" = 0.0, "maximum" = 1.0))]
    pub frequency_uncertainty: Option<f64>,
    /// Relative standard error of the damping ratios
    #[schemars(extend("default" = 0.1, "minimum" = 0.0, "maximum" = 1.0))]
    pub damping_uncertainty: Option<f64>,
    /// Relative standard error of the shapes at each position; where it is given, modal amplitude and damping have it
    /// in theirs too
    #[schemars(extend("default" = 0.01, "minimum" = 0.0, "maximum" = 1.0))]
    pub shape_uncertainty: Option<f64>,
    /// Positions of the rows of `shapes`
    #[schemars(length(min = 1, max = MAX_LIST), extend("unit" = "m"))]
    pub positions_m: Vec<f64>,
    /// Mass-normalised mode shapes: a row for each position, an entry for each mode
    #[schemars(inner(length(min = 1, max = MAX_LIST)), length(min = 1, max = MAX_LIST), extend("unit" = "1/√kg"))]
    pub shapes: Vec<Vec<f64>>,
}

/// What is extracted from the records.
#[derive(Debug, Default, Deserialize, JsonSchema)]
pub struct RawExtraction {
    /// Number of the linear mode that is excited, 1 for the lowest
    #[schemars(range(min = 1), extend("default" = 1))]
    pub mode: Option<u32>,
    /// Number of periods to take from the end of each record; default: all
    #[schemars(range(min = 2, max = 1_000_000))]
    pub periods: Option<u32>,
    /// Harmonics of the mode shape and of the participation
    #[schemars(range(min = 1, max = MAX_HARMONICS), extend("default" = 20))]
    pub harmonics: Option<u32>,
    /// Harmonics of the power-based mode indicator, or "nyquist" for all that the sampling rate carries, 1000 at most
    #[serde(default)]
    #[schemars(schema_with = "number_or_nyquist")]
    pub pbmif_harmonics: Option<RawPbmifHarmonics>,
    /// First guess of the frequency; default: taken from the record
    #[schemars(extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub frequency_hz: Option<f64>,
}

/// A number of harmonics, or all of them.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(untagged)]
pub enum RawPbmifHarmonics {
    /// So many.
    Number(u32),
    /// All of them.
    Word(Nyquist),
}

/// The one word that means all harmonics.
#[derive(Debug, Clone, Copy, Deserialize)]
pub enum Nyquist {
    /// Up to half the sampling rate.
    #[serde(rename = "nyquist")]
    Nyquist,
}

fn number_or_nyquist(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": ["integer", "string"],
        "minimum": 1,
        "maximum": 5000,
        "pattern": "^nyquist$",
        "default": "nyquist",
    })
}

/// Where the stop is.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawStop {
    /// Position along the structure
    #[schemars(extend("unit" = "m"))]
    pub position_m: f64,
    /// Clearance at rest
    #[schemars(extend("unit" = "m"))]
    pub gap_m: f64,
    /// Side on which the stop is
    #[schemars(extend("default" = "positive"))]
    pub side: Option<Side>,
}

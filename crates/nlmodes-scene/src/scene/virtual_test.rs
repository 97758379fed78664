use std::f64::consts::TAU;
use std::path::PathBuf;

use nlmodes::experiment::extraction::ExtractionSettings;
use nlmodes::experiment::phase_loop::LevelSchedule;
use nlmodes::rig::{Chain, Converter, DropOuts, Exciter, Hum, Stage};
use nlmodes::virtual_test::BenchNoise;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::MAX_HARMONICS;

use super::{BackboneMethod, LoopDetector, Overlay, RecordFormat, Side, Structure};

/// A test of a structure on a virtual rig: plain values in SI units, every default filled in.
#[derive(Debug, Clone, PartialEq)]
pub struct TestScene {
    /// Title of tables and figures.
    pub title: String,
    /// The structure, which gives the shapes of the modes.
    pub structure: Structure,
    /// Damping ratios of the modes that are taken.
    pub damping_ratios: Vec<f64>,
    /// Their frequencies, Hz, where they are not to be the structure's own.
    pub frequencies_hz: Option<Vec<f64>>,
    /// Where the exciter pushes, m.
    pub drive: f64,
    /// Positions of the accelerometers, m.
    pub accelerometers: Vec<f64>,
    /// The stop, if there is one.
    pub stop: Option<TestStop>,
    /// The exciter, which turns the drive into a force.
    pub exciter: Exciter,
    /// Noise of the sensors.
    pub noise: BenchNoise,
    /// Its seed.
    pub seed: u64,
    /// What else lies between quantities and samples, by channel.
    pub sensors: Vec<TestSensor>,
    /// Sampling rate, Hz.
    pub sample_rate: f64,
    /// The phase-locked loop.
    pub control: TestLoop,
    /// Levels of the drive, and how each is held.
    pub schedule: LevelSchedule,
    /// Which records are kept.
    pub records: Option<KeptRecords>,
    /// The backbone that is computed beside the test.
    pub backbone: Option<Backbone>,
    /// What is to be extracted from each record; its modes and its stop come from the bench.
    pub settings: ExtractionSettings,
    /// Results that figures and page show beside the levels.
    pub overlays: Vec<Overlay>,
    /// Directory of the result files.
    pub output_directory: PathBuf,
    /// What looks wrong with the scene, in words.
    pub warnings: Vec<String>,
}

impl TestScene {
    /// Frequencies that are imposed on the lowest modes, Hz: those of the test, or of `[structure.modes]`.
    pub fn given_frequencies(&self) -> Option<&[f64]> {
        let imposed = self.structure.modes.as_ref().map(|modes| &modes.frequencies_hz);
        self.frequencies_hz.as_ref().or(imposed).map(Vec::as_slice)
    }
}

/// The stop of a virtual test.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TestStop {
    /// Position along the structure
    #[serde(alias = "position_m")]
    #[schemars(rename = "position_m", extend("unit" = "m", "minimum" = 0.0))]
    pub position: f64,
    /// Clearance at rest
    #[serde(alias = "gap_m")]
    #[schemars(rename = "gap_m", extend("unit" = "m"))]
    pub gap: f64,
    /// Side on which the stop is
    #[serde(default)]
    pub side: Side,
    /// Contact stiffness; left out, the stop is rigid, and the modes left out yield
    #[serde(alias = "stiffness_n_m", default, skip_serializing_if = "Option::is_none")]
    #[schemars(rename = "stiffness_n_m", extend("unit" = "N/m", "exclusiveMinimum" = 0.0))]
    pub stiffness: Option<f64>,
}

/// What lies between a quantity and its samples in a channel of the rig; by default nothing but its noise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TestSensor {
    /// Name of the channel: "force_N", "x_drive_m", "v_drive_mps", "a1_mps2" …, "x_stop_m", "v_stop_mps", "f_contact_N"
    pub channel: String,
    /// Mass of the force cell that moves with the structure, of "force_N"
    #[serde(default)]
    #[schemars(range(min = 0.0), extend("unit" = "kg"))]
    pub mass_kg: f64,
    /// Resonance of the cell or its fixture; left out, it has none
    #[schemars(extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub resonance_hz: Option<f64>,
    /// Its damping ratio
    #[serde(default = "little")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub resonance_damping_ratio: f64,
    /// Cut-off of an anti-aliasing filter, a low-pass of second order; left out, there is none
    #[schemars(extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub anti_alias_hz: Option<f64>,
    /// Delay
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0), extend("unit" = "s"))]
    pub delay_s: f64,
    /// Drift, in units of the channel a second
    #[serde(default)]
    pub drift_per_s: f64,
    /// Amplitude of hum, in the unit of the channel
    #[serde(default)]
    pub hum: f64,
    /// Its frequency
    #[serde(default = "mains")]
    #[schemars(extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub hum_hz: f64,
    /// Largest size that the converter carries, in the unit of the channel; left out, it carries everything exactly
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub range: Option<f64>,
    /// Bits of the converter, the sign included
    #[serde(default = "usual_bits")]
    #[schemars(range(min = 2, max = 32))]
    pub bits: u32,
    /// Drop-outs a second, which repeat the last sample
    #[serde(default)]
    #[schemars(range(min = 0.0), extend("unit" = "1/s"))]
    pub drop_outs_1_s: f64,
    /// Length of a drop-out
    #[serde(default = "a_millisecond")]
    #[schemars(extend("unit" = "s", "exclusiveMinimum" = 0.0))]
    pub drop_out_s: f64,
}

fn little() -> f64 {
    0.02
}

fn mains() -> f64 {
    50.0
}

fn usual_bits() -> u32 {
    16
}

fn a_millisecond() -> f64 {
    1e-3
}

impl TestSensor {
    /// The same as the rig has it.
    pub fn chain(&self) -> Chain {
        let cell = self.resonance_hz.map(|hz| Stage { omega: TAU * hz, damping_ratio: self.resonance_damping_ratio });
        Chain {
            mass: self.mass_kg,
            stages: cell.into_iter().chain(self.anti_alias_hz.map(Stage::low_pass)).collect(),
            delay: self.delay_s,
            drift: self.drift_per_s,
            hum: (self.hum != 0.0).then_some(Hum { amplitude: self.hum, frequency_hz: self.hum_hz }),
            converter: self.range.map(|range| Converter { range, bits: self.bits }),
            drop_outs: (self.drop_outs_1_s > 0.0)
                .then_some(DropOuts { rate: self.drop_outs_1_s, length: self.drop_out_s }),
        }
    }
}

/// Most harmonics of the force that a loop follows.
const MAX_CONTROLLED: u32 = nlmodes::experiment::phase_loop::MAX_HARMONICS as u32;

/// The phase-locked loop.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct TestLoop {
    /// How the lag is measured
    pub detector: LoopDetector,
    /// Cut-off of the detector; default: a tenth of the mode's frequency
    #[schemars(extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub cut_off_hz: Option<f64>,
    /// Frequency at which the test begins; default: that of the mode, less 0.25 %
    #[serde(alias = "start_frequency_hz")]
    #[schemars(rename = "start_frequency_hz", extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub start_hz: Option<f64>,
    /// Lag of the displacement behind the force
    #[schemars(range(min = 1.0, max = 179.0), extend("unit" = "degrees"))]
    pub lag_deg: f64,
    /// Harmonics of the force under control: 1 is the fundamental alone, others are brought to the force that
    /// appropriation wants, from the motion at all sensors and the damping ratios
    #[schemars(range(min = 1, max = MAX_CONTROLLED))]
    pub controlled_harmonics: usize,
}

impl Default for TestLoop {
    fn default() -> Self {
        Self {
            detector: LoopDetector::Adaptive,
            cut_off_hz: None,
            start_hz: None,
            lag_deg: 90.0,
            controlled_harmonics: 1,
        }
    }
}

/// Most levels whose records are kept.
const MAX_LEVELS: u32 = 1000;

/// Which records are kept.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct KeptRecords {
    /// Format of the files
    #[serde(default)]
    pub format: RecordFormat,
    /// Numbers of the levels in the order of the test, 1 for the first; default: all
    #[serde(default)]
    #[schemars(inner(range(min = 1)), length(min = 1, max = MAX_LEVELS))]
    pub levels: Option<Vec<usize>>,
}

/// The computed backbones.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Backbone {
    /// Methods, a backbone for each: "hbm" with the modes and the stop of the rig, "ms-hbm" with the finite elements
    /// before a rigid stop; with the rig's damping too its "damped-mode", and the "phase-resonance" that its loop holds
    #[serde(default = "by_harmonic_balance")]
    #[schemars(length(min = 1, max = 4))]
    pub methods: Vec<BackboneMethod>,
    /// Number of harmonics
    #[serde(default = "twenty")]
    #[schemars(range(min = 1, max = MAX_HARMONICS))]
    pub harmonics: usize,
    /// Frequency at which it ends
    #[serde(alias = "end_frequency_hz")]
    #[schemars(rename = "end_frequency_hz", extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub end_hz: f64,
}

fn by_harmonic_balance() -> Vec<BackboneMethod> {
    vec![BackboneMethod::Hbm]
}

fn twenty() -> usize {
    20
}

//! The tables of a scene of a virtual test.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::raw::{RawExtraction, RawStructure};
use crate::scene::{
    Backbone, Directory, ExciterKind, KeptRecords, LevelOrder, Overlay, TestLoop, TestSensor, TestStop,
};

/// Most modes, sensors or levels.
const MAX_LIST: u32 = 1000;

/// A test of a structure on a virtual rig: exciter, stop, sensors, and a loop that holds phase resonance. SI units
/// throughout.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(title = "nlmodes scene of a virtual test")]
pub struct RawTestScene {
    /// Title of tables and figures; default: the name of the file
    pub title: Option<String>,
    /// The structure: geometry, mesh and supports
    pub structure: RawStructure,
    /// A simulated rig and the test run on it
    pub virtual_test: RawVirtualTest,
    /// What is to be extracted from the record of each level
    pub extraction: Option<RawExtraction>,
    /// Computed branches, or other tests, that figures and page show beside the levels, each under a heading
    /// `[[overlay]]`
    pub overlay: Option<Vec<Overlay>>,
    /// Where results are written, and which
    pub output: Option<Directory>,
}

/// A simulated rig and the test run on it.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawVirtualTest {
    /// Damping ratios of the lowest modes; their number is that of the modes. Default: `structure.modes.damping_ratios`
    #[schemars(inner(range(min = 0.0, max = 0.999)), length(min = 1, max = MAX_LIST))]
    pub damping_ratios: Option<Vec<f64>>,
    /// Frequencies of these modes, as measured ones; the shapes stay those of the structure. Default: those of the
    /// structure, with `structure.modes` imposed
    #[schemars(inner(range(min = 1e-9)), length(min = 1, max = MAX_LIST), extend("unit" = "Hz"))]
    pub frequencies_hz: Option<Vec<f64>>,
    /// Position at which the exciter pushes and the loop measures
    #[schemars(extend("unit" = "m", "minimum" = 0.0))]
    pub drive_m: f64,
    /// Positions of the accelerometers
    #[schemars(inner(range(min = 0.0)), length(max = MAX_LIST), extend("unit" = "m"))]
    pub accelerometers_m: Option<Vec<f64>>,
    /// Sampling rate of loop and records
    #[schemars(extend("default" = 20000.0, "unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub sample_rate_hz: Option<f64>,
    /// Seed of the sensors' noise
    #[schemars(range(min = 0), extend("default" = 1))]
    pub seed: Option<u32>,
    /// The stop, with sensors of displacement, velocity and force; without it the structure is linear
    pub stop: Option<TestStop>,
    /// The exciter, which turns the drive into a force
    pub exciter: Option<RawExciter>,
    /// Noise of the sensors; default: none
    pub noise: Option<RawNoise>,
    /// What else lies between a quantity and its samples, each channel under its own heading `[[virtual_test.sensor]]`
    pub sensor: Option<Vec<TestSensor>>,
    /// The phase-locked loop
    #[serde(rename = "loop")]
    pub control: Option<TestLoop>,
    /// Levels of the drive, and how each is held
    pub schedule: RawSchedule,
    /// Which records are kept, and in which format; default: none
    pub records: Option<KeptRecords>,
    /// The conservative backbone of the same modes and the same stop, computed beside the test; left out, none is
    /// computed
    pub backbone: Option<Backbone>,
}

/// What turns the drive into a force: a shaker, of which all data have typical defaults, or an ideal force.
#[derive(Debug, Default, Deserialize, JsonSchema)]
pub struct RawExciter {
    /// Shaker or ideal force
    #[schemars(extend("default" = "shaker"))]
    pub kind: Option<ExciterKind>,
    /// Resistance of the coil
    #[schemars(extend("unit" = "Ω", "default" = 2.0, "exclusiveMinimum" = 0.0))]
    pub resistance_ohm: Option<f64>,
    /// Inductance of the coil
    #[schemars(extend("unit" = "H", "default" = 1.5e-4, "exclusiveMinimum" = 0.0))]
    pub inductance_h: Option<f64>,
    /// Force constant, which is also that of the induced voltage
    #[schemars(extend("unit" = "N/A", "default" = 9.8, "exclusiveMinimum" = 0.0))]
    pub force_constant_n_a: Option<f64>,
    /// Mass of armature and table
    #[schemars(extend("unit" = "kg", "default" = 0.06, "exclusiveMinimum" = 0.0))]
    pub armature_mass_kg: Option<f64>,
    /// Stiffness of the suspension
    #[schemars(extend("unit" = "N/m", "default" = 12e3, "minimum" = 0.0))]
    pub suspension_stiffness_n_m: Option<f64>,
    /// Damping of the suspension
    #[schemars(extend("unit" = "N·s/m", "default" = 5.0, "minimum" = 0.0))]
    pub suspension_damping_n_s_m: Option<f64>,
    /// Axial stiffness of the stinger
    #[schemars(extend("unit" = "N/m", "default" = 1e6, "exclusiveMinimum" = 0.0))]
    pub stinger_stiffness_n_m: Option<f64>,
    /// Damping of the stinger
    #[schemars(extend("unit" = "N·s/m", "default" = 20.0, "minimum" = 0.0))]
    pub stinger_damping_n_s_m: Option<f64>,
}

/// Standard deviations of the sensors' noise.
#[derive(Debug, Default, Deserialize, JsonSchema)]
pub struct RawNoise {
    /// Of the excitation force
    #[schemars(extend("unit" = "N", "default" = 0.0, "minimum" = 0.0))]
    pub force_n: Option<f64>,
    /// Of displacements
    #[schemars(extend("unit" = "m", "default" = 0.0, "minimum" = 0.0))]
    pub displacement_m: Option<f64>,
    /// Of velocities
    #[schemars(extend("unit" = "m/s", "default" = 0.0, "minimum" = 0.0))]
    pub velocity_m_s: Option<f64>,
    /// Of accelerations
    #[schemars(extend("unit" = "m/s²", "default" = 0.0, "minimum" = 0.0))]
    pub acceleration_m_s2: Option<f64>,
    /// Of the contact force
    #[schemars(extend("unit" = "N", "default" = 0.0, "minimum" = 0.0))]
    pub contact_force_n: Option<f64>,
}

/// Levels of the drive, and how each is held.
#[derive(Debug, Default, Deserialize, JsonSchema)]
pub struct RawSchedule {
    /// Levels of a shaker: amplitudes of its voltage
    #[schemars(inner(range(min = 1e-9)), length(min = 1, max = MAX_LIST), extend("unit" = "V"))]
    pub levels_v: Option<Vec<f64>>,
    /// Levels of an ideal force: its amplitudes
    #[schemars(inner(range(min = 1e-9)), length(min = 1, max = MAX_LIST), extend("unit" = "N"))]
    pub levels_n: Option<Vec<f64>>,
    /// Through the levels in their order, or also back from the last but one
    #[schemars(extend("default" = "once"))]
    pub order: Option<LevelOrder>,
    /// Time from one level to the next
    #[schemars(extend("unit" = "s", "default" = 1.0, "minimum" = 0.0))]
    pub ramp_s: Option<f64>,
    /// Longest time that a level is held to settle
    #[schemars(extend("unit" = "s", "default" = 40.0, "exclusiveMinimum" = 0.0))]
    pub longest_hold_s: Option<f64>,
    /// Length of the record of each level
    #[schemars(extend("unit" = "s", "default" = 1.0, "exclusiveMinimum" = 0.0, "maximum" = 1000.0))]
    pub record_s: Option<f64>,
    /// Largest deviation of the lag of a settled level
    #[schemars(extend("unit" = "degrees", "default" = 0.02, "exclusiveMinimum" = 0.0))]
    pub lag_tolerance_deg: Option<f64>,
    /// Largest relative drift of the frequency of a settled level
    #[schemars(extend("unit" = "1/s", "default" = 3e-6, "exclusiveMinimum" = 0.0))]
    pub frequency_drift_1_s: Option<f64>,
    /// Largest relative drift of the response of a settled level
    #[schemars(extend("unit" = "1/s", "default" = 3e-4, "exclusiveMinimum" = 0.0))]
    pub amplitude_drift_1_s: Option<f64>,
    /// Largest relative difference between a period and the mean one
    #[schemars(extend("default" = 0.01, "exclusiveMinimum" = 0.0))]
    pub period_spread: Option<f64>,
}

//! The tables of a scene of a virtual test.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::raw::method::MAX_HARMONICS;
use crate::raw::{RawDirectory, RawExtraction, RawOverlay, RawStructure};
use crate::scene::{BackboneMethod, ExciterKind, LevelOrder, LoopDetector, RecordFormat, Side};

/// Most harmonics of the force that a loop follows.
const MAX_CONTROLLED: u32 = nlmodes::experiment::phase_loop::MAX_HARMONICS as u32;
/// Most modes, sensors or levels.
const MAX_LIST: u32 = 1000;

/// A test of a structure on a virtual rig: exciter, stop, sensors, and a loop that holds phase resonance. SI units
/// throughout.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "nlmodes scene of a virtual test")]
pub struct RawTestScene {
    /// Title of tables and figures; default: the name of the file
    pub title: Option<String>,
    /// The structure: geometry, mesh and supports
    #[schemars(required)]
    pub structure: Option<RawStructure>,
    /// The rig, and the test on it
    #[schemars(required)]
    pub virtual_test: Option<RawVirtualTest>,
    /// What is to be extracted from the record of each level
    pub extraction: Option<RawExtraction>,
    /// Computed branches, or other tests, that figures and page show beside the levels, each under a heading
    /// `[[overlay]]`
    pub overlay: Option<Vec<RawOverlay>>,
    /// Where results go
    pub output: Option<RawDirectory>,
}

/// The rig, and the test on it.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawVirtualTest {
    /// Damping ratios of the lowest modes, one a mode; so many modes are taken. Default:
    /// `structure.modes.damping_ratios`
    #[schemars(inner(range(min = 0.0, max = 0.999)), length(min = 1, max = MAX_LIST))]
    pub damping_ratios: Option<Vec<f64>>,
    /// Frequencies of these modes, as measured ones; the shapes stay those of the structure. Default: those of the
    /// structure, with `structure.modes` imposed
    #[schemars(inner(range(min = 1e-9)), length(min = 1, max = MAX_LIST), extend("unit" = "Hz"))]
    pub frequencies_hz: Option<Vec<f64>>,
    /// Where the exciter pushes, and the loop measures
    #[schemars(required, extend("unit" = "m", "minimum" = 0.0))]
    pub drive_m: Option<f64>,
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
    pub stop: Option<RawTestStop>,
    /// What turns the drive into a force
    pub exciter: Option<RawExciter>,
    /// Noise of the sensors, none by default
    pub noise: Option<RawNoise>,
    /// The phase-locked loop
    #[serde(rename = "loop")]
    pub control: Option<RawLoop>,
    /// Levels of the drive, and how they are held
    #[schemars(required)]
    pub schedule: Option<RawSchedule>,
    /// Which records are kept, and how; none by default
    pub records: Option<RawKeptRecords>,
    /// The conservative backbone of the same modes and the same stop, computed beside the test; left out, it is not
    pub backbone: Option<RawBackbone>,
}

/// The stop of a virtual test.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawTestStop {
    /// Position along the structure
    #[schemars(required, extend("unit" = "m", "minimum" = 0.0))]
    pub position_m: Option<f64>,
    /// Clearance at rest
    #[schemars(required, extend("unit" = "m"))]
    pub gap_m: Option<f64>,
    /// Side on which the stop stands
    #[schemars(extend("default" = "positive"))]
    pub side: Option<Side>,
    /// Contact stiffness; left out, the stop is rigid, and the modes left out yield
    #[schemars(extend("unit" = "N/m", "exclusiveMinimum" = 0.0))]
    pub stiffness_n_m: Option<f64>,
}

/// What turns the drive into a force: a shaker, of which all data have typical defaults, or an ideal force.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
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
#[serde(deny_unknown_fields)]
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

/// The phase-locked loop.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawLoop {
    /// How the lag is measured
    #[schemars(extend("default" = "adaptive"))]
    pub detector: Option<LoopDetector>,
    /// Cut-off of the detector; default: a tenth of the mode's frequency
    #[schemars(extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub cut_off_hz: Option<f64>,
    /// Frequency at which the test begins; default: that of the mode, less 0.25 %
    #[schemars(extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub start_frequency_hz: Option<f64>,
    /// Lag of the displacement behind the force
    #[schemars(range(min = 1.0, max = 179.0), extend("unit" = "degrees", "default" = 90.0))]
    pub lag_deg: Option<f64>,
    /// Harmonics of the force under control: 1 is the fundamental alone, others are brought to the force that
    /// appropriation wants, from the motion at all sensors and the damping ratios
    #[schemars(range(min = 1, max = MAX_CONTROLLED), extend("default" = 1))]
    pub controlled_harmonics: Option<u32>,
}

/// Levels of the drive, and how they are held.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawSchedule {
    /// Levels of a shaker: amplitudes of its voltage
    #[schemars(inner(range(min = 1e-9)), length(min = 1, max = MAX_LIST), extend("unit" = "V"))]
    pub levels_v: Option<Vec<f64>>,
    /// Levels of an ideal force: its amplitudes
    #[schemars(inner(range(min = 1e-9)), length(min = 1, max = MAX_LIST), extend("unit" = "N"))]
    pub levels_n: Option<Vec<f64>>,
    /// Through the levels as they stand, or also back from the last but one
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

/// Which records are kept.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawKeptRecords {
    /// Format of the files
    #[schemars(extend("default" = "csv"))]
    pub format: Option<RecordFormat>,
    /// Numbers of the levels in the order of the test, 1 for the first; default: all
    #[schemars(inner(range(min = 1)), length(min = 1, max = MAX_LIST))]
    pub levels: Option<Vec<u32>>,
}

/// The computed backbone.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawBackbone {
    /// Methods, a backbone for each: "hbm" with the modes and the stop of the rig, "ms-hbm" with the finite elements
    /// before a rigid stop; with the rig's damping too its "damped-mode", and the "phase-resonance" that its loop holds
    #[schemars(length(min = 1, max = 4), extend("default" = ["hbm"]))]
    pub methods: Option<Vec<BackboneMethod>>,
    /// Number of harmonics
    #[schemars(range(min = 1, max = MAX_HARMONICS), extend("default" = 20))]
    pub harmonics: Option<u32>,
    /// Frequency at which it ends
    #[schemars(required, extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub end_frequency_hz: Option<f64>,
}

use std::path::PathBuf;

use nlmodes::experiment::extraction::ExtractionSettings;
use nlmodes::rig::{Exciter, Schedule};
use nlmodes::virtual_test::BenchNoise;
use serde::Serialize;

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
    /// What turns the drive into a force.
    pub exciter: Exciter,
    /// Noise of the sensors.
    pub noise: BenchNoise,
    /// Its seed.
    pub seed: u64,
    /// Sampling rate, Hz.
    pub sample_rate: f64,
    /// The phase-locked loop.
    pub control: TestLoop,
    /// Levels of the drive, and how they are held.
    pub schedule: Schedule,
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
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TestStop {
    /// Position, m.
    pub position: f64,
    /// Clearance at rest, m.
    pub gap: f64,
    /// Side on which it stands.
    pub side: Side,
    /// Contact stiffness, N/m; a rigid stop has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<f64>,
}

/// The phase-locked loop.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TestLoop {
    /// How the lag is measured.
    pub detector: LoopDetector,
    /// Cut-off of the detector, Hz.
    pub cut_off_hz: Option<f64>,
    /// Frequency at which the test begins, Hz.
    pub start_hz: Option<f64>,
    /// Lag of the displacement behind the force, degrees.
    pub lag_deg: f64,
    /// Harmonics of the force under control, 1 to this one.
    pub controlled_harmonics: usize,
}

/// Records that are kept as files.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KeptRecords {
    /// Format.
    pub format: RecordFormat,
    /// Numbers of the levels, 1 for the first; all where there are none.
    pub levels: Option<Vec<usize>>,
}

/// The backbones that are computed beside the test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Backbone {
    /// One for each of these methods.
    pub methods: Vec<BackboneMethod>,
    /// Number of harmonics.
    pub harmonics: usize,
    /// Frequency at which it ends, Hz.
    pub end_hz: f64,
}

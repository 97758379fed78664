use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::StabilityChoice;

/// Most points with histories.
const MAX_HISTORIES: u32 = 10_000;

/// Which results are written, and where.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, JsonSchema)]
pub struct Output {
    /// Directory of the result files, relative to where the program is started; default: `results/<name of the file>`
    #[serde(default)]
    #[schemars(length(min = 1))]
    pub directory: Option<PathBuf>,
    /// For which points Floquet multipliers are computed
    #[serde(default)]
    pub stability: StabilityChoice,
    /// Wall time allowed for the multipliers of each curve; points beyond it have none, which is reported. Default:
    /// three times that of the curve, at least ten seconds
    #[serde(default)]
    #[schemars(extend("unit" = "s", "minimum" = 0.0))]
    pub stability_budget_s: Option<f64>,
    /// Relative errors that are acceptable; `summary.json` and the page say where they are met
    #[serde(default)]
    pub require: Requirement,
    /// Which files.
    #[serde(flatten)]
    pub files: OutputFiles,
}

/// Largest relative errors that are wanted; none where none are given.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Requirement {
    /// Of the frequency
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1.0))]
    pub frequency: Option<f64>,
    /// Of displacements
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1.0))]
    pub displacement: Option<f64>,
    /// Of the impulse of each contact
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1.0))]
    pub impulse: Option<f64>,
    /// Of the largest contact force
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1.0))]
    pub peak_force: Option<f64>,
}

impl Requirement {
    /// Whether nothing is required.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// Where results are written, and which.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, JsonSchema)]
pub struct Directory {
    /// Directory of the result files, relative to where the program is started; default: `results/<name of the file>`
    #[serde(default)]
    #[schemars(length(min = 1))]
    pub directory: Option<PathBuf>,
}

/// Which files of results are written beside the tables; nothing is computed for those that are not.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct OutputFiles {
    /// Whether figures are drawn
    pub figures: bool,
    /// Whether the page `report.html` is written
    pub page: bool,
    /// Whether `results.mat` is written, for MATLAB and Octave
    pub matlab: bool,
    /// Numbers of further points whose motion over a period is written to `histories.npz`
    #[schemars(length(max = MAX_HISTORIES))]
    pub histories: Vec<usize>,
    /// Width of the figures in print, in mm, with 8 point letters: 90 for one column, 190 for two; default: 720 pixels,
    /// for screens
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 60.0, max = 400.0))]
    pub figure_width_mm: Option<f64>,
    /// Whether figures have titles
    pub figure_titles: bool,
    /// Whether the largest stress of each point is computed, where the elements are known
    pub stress: bool,
    /// Maximum memory for the stresses of the modes of solids, GB; for larger structures no stress is recovered, which
    /// is reported
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub stress_memory_gb: f64,
}

impl Default for OutputFiles {
    fn default() -> Self {
        Self {
            figures: true,
            page: true,
            matlab: false,
            histories: Vec::new(),
            figure_width_mm: None,
            figure_titles: true,
            stress: true,
            stress_memory_gb: 2.0,
        }
    }
}

impl OutputFiles {
    /// Whether nothing else was asked for.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// Results that are laid over those of the scene: of another run, or of a test.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Overlay {
    /// A folder of results, or a table with the columns frequency_hz and modal_amplitude or energy_j; relative to the
    /// scene
    #[schemars(length(min = 1))]
    pub path: PathBuf,
    /// Name in legends; default: the name of the folder or table
    #[serde(default)]
    #[schemars(length(min = 1))]
    pub label: String,
}

use schemars::JsonSchema;
use serde::Deserialize;

use crate::scene::StabilityChoice;

/// Most points with histories.
const MAX_HISTORIES: u32 = 10_000;

/// Which results are written, and where.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawOutput {
    /// Directory of the result files, from where the program is started; default: results/<name of the file>
    #[schemars(length(min = 1))]
    pub directory: Option<String>,
    /// For which points Floquet multipliers are computed
    #[schemars(extend("default" = "auto"))]
    pub stability: Option<StabilityChoice>,
    /// Whether figures are drawn
    #[schemars(extend("default" = true))]
    pub figures: Option<bool>,
    /// Width of the figures in print, mm, with letters of 8 points: 90 for one column, 190 for two; left out: 720
    /// pixels, for screens
    #[schemars(range(min = 60.0, max = 400.0))]
    pub figure_width_mm: Option<f64>,
    /// Whether figures have titles
    #[schemars(extend("default" = true))]
    pub figure_titles: Option<bool>,
    /// Whether the page `report.html` is written
    #[schemars(extend("default" = true))]
    pub page: Option<bool>,
    /// Numbers of points whose motion over a period goes to `histories.npz`, beside those that figures and page show
    #[schemars(length(max = MAX_HISTORIES))]
    pub histories: Option<Vec<usize>>,
    /// Whether the results are written for MATLAB and Octave too, as `results.mat`
    #[schemars(extend("default" = false))]
    pub matlab: Option<bool>,
}

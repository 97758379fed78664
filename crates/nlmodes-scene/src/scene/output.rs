use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// Which files of results are written beside the tables; nothing is computed for those that are not.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct OutputFiles {
    /// Figures.
    pub figures: bool,
    /// The page.
    pub page: bool,
    /// The results for MATLAB.
    pub matlab: bool,
    /// Numbers of points whose motion over a period is written, ascending, beside those that are shown.
    pub histories: Vec<usize>,
    /// Width of the figures in print, mm; without it they are made for screens.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub figure_width_mm: Option<f64>,
    /// Whether figures have titles.
    pub figure_titles: bool,
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
        }
    }
}

impl OutputFiles {
    /// Whether nothing else was asked for.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// Results that are laid over those of the scene.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Overlay {
    /// A folder of results, or a table.
    pub path: PathBuf,
    /// Its name in legends.
    pub label: String,
}

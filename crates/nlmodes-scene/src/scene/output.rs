use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// Which files of results are written beside the tables; nothing is computed for those that are not.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct OutputFiles {
    /// Figures.
    pub figures: bool,
    /// The page.
    pub page: bool,
    /// The results for MATLAB.
    pub matlab: bool,
    /// Numbers of points whose motion over a period is written, ascending, beside those that are shown.
    pub histories: Vec<usize>,
}

impl Default for OutputFiles {
    fn default() -> Self {
        Self { figures: true, page: true, matlab: false, histories: Vec::new() }
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

use schemars::JsonSchema;
use serde::Deserialize;

/// Results that are laid over those of the scene: of another run, or of a test.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawOverlay {
    /// A folder of results, or a table with the columns frequency_hz and modal_amplitude or energy_j; from where the
    /// scene is
    #[schemars(required, length(min = 1))]
    pub path: Option<String>,
    /// Its name in legends; default: the name of the folder or table
    #[schemars(length(min = 1))]
    pub label: Option<String>,
}

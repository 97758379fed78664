use schemars::JsonSchema;
use serde::Deserialize;

/// A parameter by which the points of every curve are differentiated.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
pub struct RawSensitivity {
    /// A key of the scene with a number, as `--set` takes it: "contact.0.gap_m", "structure.material.youngs_modulus_pa"
    #[schemars(length(min = 1))]
    pub key: String,
}

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use super::UpdatedParameter;

/// Parameters that are fitted to given linear frequencies before anything else is computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Updating {
    /// The parameters; the search begins with their values in the scene
    #[serde(default = "modulus")]
    #[schemars(length(min = 1))]
    pub parameters: Vec<UpdatedParameter>,
    /// Linear frequencies to be met, with open contacts and the contact mass as in `method`
    #[schemars(schema_with = "frequencies")]
    pub frequencies_hz: Vec<f64>,
    /// Numbers of their modes, 1 for the lowest; default: 1, 2 …
    #[serde(default)]
    #[schemars(length(min = 1), inner(range(min = 1)))]
    pub modes: Vec<usize>,
    /// What was found; nothing before the computation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(skip)]
    pub done: Option<UpdatingDone>,
}

/// What an updating changed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UpdatingDone {
    /// Values of the parameters before.
    pub from: Vec<f64>,
    /// Values of the parameters after.
    pub to: Vec<f64>,
    /// Frequencies before, Hz.
    pub from_hz: Vec<f64>,
    /// Frequencies after, Hz.
    pub to_hz: Vec<f64>,
}

fn modulus() -> Vec<UpdatedParameter> {
    vec![UpdatedParameter::YoungsModulus]
}

fn frequencies(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": "array",
        "items": { "type": "number", "exclusiveMinimum": 0.0 },
        "minItems": 1,
        "unit": "Hz",
    })
}

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;

use crate::scene::UpdatedParameter;

/// Parameters that are fitted to given linear frequencies before anything else is computed.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawUpdating {
    /// The parameters; what the scene says of them elsewhere is where the search begins
    #[schemars(length(min = 1), extend("default" = ["youngs_modulus_pa"]))]
    pub parameters: Option<Vec<UpdatedParameter>>,
    /// Linear frequencies that the structure is to have, with its contacts open and the contact mass as `method` has it
    #[schemars(required, schema_with = "frequencies")]
    pub frequencies_hz: Option<Vec<f64>>,
    /// Numbers of their modes, 1 for the lowest; default: 1, 2 …
    #[schemars(length(min = 1), inner(range(min = 1)))]
    pub modes: Option<Vec<u32>>,
}

fn frequencies(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": "array",
        "items": { "type": "number", "exclusiveMinimum": 0.0 },
        "minItems": 1,
        "unit": "Hz",
    })
}

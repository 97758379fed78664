//! The tables of a study file as they are written. Attributes carry the schema, against which they are checked.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde_json::Value;

use crate::study::{DesignKind, Keep};

/// A study of nlmodes: a scene, what varies in it, and which quantities are wanted of each case.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "nlmodes study")]
pub struct RawStudy {
    /// Title of tables and page; default: the name of the file
    pub title: Option<String>,
    /// The scene that is varied; a path relative to this file
    #[schemars(required, length(min = 1))]
    pub scene: Option<String>,
    /// Which cases are computed
    pub design: Option<RawDesign>,
    /// What varies, each under its own heading `[[vary]]`
    pub vary: Option<Vec<RawVary>>,
    /// What is wanted of each case, each under its own heading `[[quantity]]`
    pub quantity: Option<Vec<RawQuantity>>,
    /// Where results go
    pub output: Option<RawOutput>,
}

/// Which cases are computed.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawDesign {
    /// All combinations of values, values side by side or rows of a CSV, or points in the space of the distributions
    #[schemars(extend("default" = "grid"))]
    pub kind: Option<DesignKind>,
    /// Number of points; not for grid and list
    #[schemars(range(min = 1, max = 10_000_000))]
    pub samples: Option<u32>,
    /// Number from which random numbers follow: the same one gives the same points
    #[schemars(extend("default" = 1))]
    pub seed: Option<u32>,
    /// Of a list: a CSV with a row a case, its header the keys that `--set` takes; a path relative to this file
    #[schemars(length(min = 1))]
    pub file: Option<String>,
    /// Whether each of `samples` points gets the further ones from which Sobol indices follow: 2 more than there is to
    /// vary
    #[schemars(extend("default" = false))]
    pub sobol_indices: Option<bool>,
}

/// What varies.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("required" = ["key"]))]
pub struct RawVary {
    /// What `--set` takes, as "contact.0.gap_m"; a list of such keys moves together
    #[schemars(required, schema_with = "any")]
    pub key: Option<Value>,
    /// Name of the column; default: the (first) key
    #[schemars(length(min = 1))]
    pub name: Option<String>,
    /// These values; where several keys move together each may be a list with a value a key
    #[schemars(schema_with = "any")]
    pub values: Option<Value>,
    /// So many values at equal distances, both ends included: [from, to, number]
    #[schemars(length(min = 3, max = 3))]
    pub linspace: Option<Vec<f64>>,
    /// Equally likely everywhere between two limits: [from, to]
    #[schemars(length(min = 2, max = 2))]
    pub uniform: Option<Vec<f64>>,
    /// Its logarithm equally likely everywhere between two limits: [from, to]
    #[schemars(length(min = 2, max = 2))]
    pub loguniform: Option<Vec<f64>>,
    /// Normal distribution
    pub normal: Option<RawNormal>,
    /// Distribution of which the logarithm is normal
    pub lognormal: Option<RawLognormal>,
}

/// A normal distribution, cut off where limits are given.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawNormal {
    /// Mean, before it is cut off
    #[schemars(required)]
    pub mean: Option<f64>,
    /// Standard deviation, before it is cut off
    #[schemars(required, extend("exclusiveMinimum" = 0.0))]
    pub std: Option<f64>,
    /// Nothing lies below; default: no limit
    pub min: Option<f64>,
    /// Nothing lies above; default: no limit
    pub max: Option<f64>,
}

/// A lognormal distribution.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawLognormal {
    /// Mean of the quantity itself, not of its logarithm
    #[schemars(required, extend("exclusiveMinimum" = 0.0))]
    pub mean: Option<f64>,
    /// Standard deviation of the quantity itself, not of its logarithm
    #[schemars(required, extend("exclusiveMinimum" = 0.0))]
    pub std: Option<f64>,
}

/// What is wanted of each case.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawQuantity {
    /// Name of its column
    #[schemars(required, length(min = 1))]
    pub name: Option<String>,
    /// A column of `branch.csv`, as "frequency_hz", or `energy_ratio`, the averaged kinetic energy over that at grazing
    #[schemars(required, length(min = 1))]
    pub of: Option<String>,
    /// Where on the branch: { energy_ratio = 2.0 } or { column = value }, "first", "last", "max", "min", or the name of
    /// an event
    #[schemars(required, schema_with = "any")]
    pub at: Option<Value>,
}

/// Where results go, and what stays of each case.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawOutput {
    /// Directory of the study, from where the program is started; default: results/<name of the file>
    #[schemars(length(min = 1))]
    pub directory: Option<String>,
    /// What stays of each case: all that a run writes, or its tables and summary only, a tenth of that
    #[schemars(extend("default" = "all"))]
    pub keep: Option<Keep>,
}

/// A value that is checked where it is read.
fn any(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "anyValue": true })
}

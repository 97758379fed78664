//! The tables of a study file as written. Attributes carry the schema against which they are checked.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde_json::Value;

use crate::study::{DesignKind, Keep};

/// A study of nlmodes: a scene, its variables, and the quantities of each case.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "nlmodes study")]
pub struct RawStudy {
    /// Title of tables and page; default: the name of the file
    pub title: Option<String>,
    /// The scene that is varied; a path relative to this file
    #[schemars(required, length(min = 1))]
    pub scene: Option<String>,
    /// The cases to compute
    pub design: Option<RawDesign>,
    /// Variables, each under its own heading `[[vary]]`
    pub vary: Option<Vec<RawVary>>,
    /// Quantities of each case, each under its own heading `[[quantity]]`
    pub quantity: Option<Vec<RawQuantity>>,
    /// Measured points to which the variables are fitted, by `nlmodes-cli study fit`
    pub fit: Option<RawFit>,
    /// Directory of the results
    pub output: Option<RawOutput>,
}

/// Measured points to which the variables are fitted.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("required" = ["measured", "over"]))]
pub struct RawFit {
    /// A CSV with columns of `branch.csv`, and the standard deviation of a column `frequency_hz` as `frequency_hz_std`;
    /// a path relative to this file
    #[schemars(required, length(min = 1))]
    pub measured: Option<String>,
    /// The column that says where on the curve a row is, such as "level" or "fundamental_m"; its values count as exact
    #[schemars(required, length(min = 1))]
    pub over: Option<String>,
    /// The columns that are fitted; default: all of the file that have derivatives
    #[schemars(length(min = 1))]
    pub columns: Option<Vec<String>>,
    /// Number of the response in the scene that was measured, from 1; default: all
    #[schemars(range(min = 1, max = 1000))]
    pub response: Option<u32>,
    /// Level at which it was measured, in the unit of the load; default: all
    pub level: Option<f64>,
}

/// The cases to compute.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawDesign {
    /// All combinations of values, values row by row or rows of a CSV, points in the space of the distributions, or
    /// only the means of these, with gradients
    #[schemars(extend("default" = "grid"))]
    pub kind: Option<DesignKind>,
    /// Number of points; not for grid and list
    #[schemars(range(min = 1, max = 10_000_000))]
    pub samples: Option<u32>,
    /// Random seed: the same one gives the same points
    #[schemars(extend("default" = 1))]
    pub seed: Option<u32>,
    /// For a list: a CSV with one row per case and keys of `--set` as header; a path relative to this file
    #[schemars(length(min = 1))]
    pub file: Option<String>,
    /// Whether each of `samples` points gets the additional ones for Sobol indices: 2 more than the number of variables
    #[schemars(extend("default" = false))]
    pub sobol_indices: Option<bool>,
    /// Whether each of `samples` points is computed with gradients, and Sobol indices come from polynomials fitted to
    /// both, with a stated error: with a tenth of the cases that `sobol_indices` takes
    #[schemars(extend("default" = false))]
    pub expansion: Option<bool>,
    /// Whether spread and worst corners are computed from gradients, too: one case with the variables at their means,
    /// one for each corner; always for kind "first-order"
    #[schemars(extend("default" = false))]
    pub first_order: Option<bool>,
    /// Where a distribution has no limits of its own, the box of tolerances ends this many standard deviations from the
    /// mean
    #[schemars(extend("default" = 3.0, "exclusiveMinimum" = 0.0, "maximum" = 10.0))]
    pub box_deviations: Option<f64>,
}

/// The variables.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("required" = ["key"]))]
pub struct RawVary {
    /// A key of `--set`, such as "contact.0.gap_m"; a list of keys varies together
    #[schemars(required, schema_with = "any")]
    pub key: Option<Value>,
    /// Name of the column; default: the (first) key
    #[schemars(length(min = 1))]
    pub name: Option<String>,
    /// These values; if several keys vary together each may be a list with one value per key
    #[schemars(schema_with = "any")]
    pub values: Option<Value>,
    /// Equally spaced values, including both ends: [from, to, number]
    #[schemars(length(min = 3, max = 3))]
    pub linspace: Option<Vec<f64>>,
    /// Uniform distribution between two limits: [from, to]
    #[schemars(length(min = 2, max = 2))]
    pub uniform: Option<Vec<f64>>,
    /// Log-uniform distribution between two limits: [from, to]
    #[schemars(length(min = 2, max = 2))]
    pub loguniform: Option<Vec<f64>>,
    /// Normal distribution
    pub normal: Option<RawNormal>,
    /// Lognormal distribution
    pub lognormal: Option<RawLognormal>,
}

/// A normal distribution, truncated at limits if given.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawNormal {
    /// Mean before truncation
    #[schemars(required)]
    pub mean: Option<f64>,
    /// Standard deviation before truncation
    #[schemars(required, extend("exclusiveMinimum" = 0.0))]
    pub std: Option<f64>,
    /// Lower limit; default: none
    pub min: Option<f64>,
    /// Upper limit; default: none
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

/// The quantities of each case.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("required" = ["name", "of"]))]
pub struct RawQuantity {
    /// Name of its column
    #[schemars(required, length(min = 1))]
    pub name: Option<String>,
    /// A column of `branch.csv`, such as "frequency_hz", or `energy_ratio`, the averaged kinetic energy relative to
    /// that at grazing; of responses also "peak", "jump_up_hz", "jump_down_hz", "max_force", "impulse"
    #[schemars(required, length(min = 1))]
    pub of: Option<String>,
    /// Point of the branch: { energy_j = 0.1 } or { column = value }, "first", "last", "max", "min", or the name of an
    /// event; not for "peak" and jumps, and "max" where "max_force" and "impulse" say nothing else
    #[schemars(schema_with = "any")]
    pub at: Option<Value>,
    /// Level of the responses that it is about, in the unit of the load; default: all
    pub level: Option<f64>,
    /// Number of the response in the scene that it is about, from 1; default: all
    #[schemars(range(min = 1, max = 1000))]
    pub response: Option<u32>,
    /// What it must not exceed: how much of the tolerances keeps it below, and which cases do
    pub at_most: Option<f64>,
    /// What it must not fall below, in the same way
    pub at_least: Option<f64>,
}

/// Directory of the results, and the files kept of each case.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawOutput {
    /// Directory of the study, relative to the current directory; default: results/<name of the file>
    #[schemars(length(min = 1))]
    pub directory: Option<String>,
    /// Files kept of each case: all files of a run, or only its tables and summary, a tenth of the size
    #[schemars(extend("default" = "all"))]
    pub keep: Option<Keep>,
}

/// A value that is checked where it is read.
fn any(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "anyValue": true })
}

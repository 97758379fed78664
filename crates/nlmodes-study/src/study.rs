//! A study that was checked.

mod design;

use nlmodes::modal::Event;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::distribution::Distribution;
pub use design::{Design, DesignKind};

/// Files kept of each case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Keep {
    /// All files of a run
    #[default]
    All,
    /// Tables and summary: no coefficients, no participation of modes, and no steps from which it could continue with
    /// more points
    Tables,
}

/// The values of a variable.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// These values, each with a value for each key.
    Listed(Vec<Vec<Value>>),
    /// Drawn from a distribution, the same for all keys.
    Drawn(Distribution),
}

/// A variable: one key of the scene, or several that vary together.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name of its column.
    pub name: String,
    /// Keys of `--set`.
    pub keys: Vec<String>,
    /// Its values.
    pub values: Values,
}

/// Point of a branch at which a quantity is evaluated.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// The first point at which this column has this value.
    Column {
        /// The column.
        name: String,
        /// The value.
        value: f64,
    },
    /// At the first point.
    First,
    /// At the last point.
    Last,
    /// At the point with the largest value.
    Max,
    /// At the point with the smallest value.
    Min,
    /// At the first point with this event.
    Event(Event),
}

/// The quantities of each case.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Name of its column.
    pub name: String,
    /// Column of the branch.
    pub of: String,
    /// Point of the branch.
    pub at: Place,
}

impl Quantity {
    /// Axis label: the name, and its column, which ends with the unit.
    pub fn label(&self) -> String {
        if self.name == self.of { self.name.clone() } else { format!("{} ({})", self.name, self.of) }
    }
}

/// A study that was checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Title of tables and page.
    pub title: String,
    /// Name of the scene's file, as messages show it.
    pub scene_name: String,
    /// Its text.
    pub scene_text: String,
    /// The cases to compute.
    pub design: Design,
    /// The variables.
    pub variables: Vec<Variable>,
    /// The quantities of each case.
    pub quantities: Vec<Quantity>,
    /// Directory of the study.
    pub directory: PathBuf,
    /// Files kept of each case.
    pub keep: Keep,
}

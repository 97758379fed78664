//! A study that was checked.

mod design;

use nlmodes::modal::Event;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::distribution::Distribution;
pub use design::{Design, DesignKind};

/// What stays of each case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Keep {
    /// All that a run writes
    #[default]
    All,
    /// Tables and summary: no coefficients, no participation of modes, and no steps from which it could go on with more
    /// points
    Tables,
}

/// The values that something takes.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// These, each with a value for each key.
    Listed(Vec<Vec<Value>>),
    /// Drawn from a distribution, the same for all keys.
    Drawn(Distribution),
}

/// Something that varies: one key of the scene, or several that move together.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name of its column.
    pub name: String,
    /// What `--set` takes.
    pub keys: Vec<String>,
    /// Which values it takes.
    pub values: Values,
}

/// Where on a branch a quantity is taken.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// Where this column first has this value.
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

/// What is wanted of each case.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Name of its column.
    pub name: String,
    /// Column of the branch.
    pub of: String,
    /// Where on the branch.
    pub at: Place,
}

impl Quantity {
    /// What stands at an axis: the name, and the column it is of, which ends with its unit.
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
    /// Which cases are computed.
    pub design: Design,
    /// What varies.
    pub variables: Vec<Variable>,
    /// What is wanted of each case.
    pub quantities: Vec<Quantity>,
    /// Directory of the study.
    pub directory: PathBuf,
    /// What stays of each case.
    pub keep: Keep,
}

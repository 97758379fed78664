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
    /// What is evaluated.
    pub of: Of,
    /// Point of the branch; of what needs none the largest value.
    pub at: Place,
    /// Which of the responses of a scene it is about.
    pub response: Selected,
    /// What it has to keep to.
    pub limit: Option<Limit>,
}

/// What a quantity has to keep to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Limit {
    /// At most this.
    AtMost(f64),
    /// At least this.
    AtLeast(f64),
}

impl Limit {
    /// The number.
    pub fn value(self) -> f64 {
        match self {
            Self::AtMost(value) | Self::AtLeast(value) => value,
        }
    }

    /// Whether a value keeps to it.
    pub fn holds(self, value: f64) -> bool {
        match self {
            Self::AtMost(limit) => value <= limit,
            Self::AtLeast(limit) => value >= limit,
        }
    }

    /// Before the number.
    pub fn words(self) -> &'static str {
        match self {
            Self::AtMost(_) => "at most",
            Self::AtLeast(_) => "at least",
        }
    }
}

/// What a quantity evaluates.
#[derive(Debug, Clone, PartialEq)]
pub enum Of {
    /// A column of the branch.
    Column(String),
    /// The largest amplitude of the first stop at the frequency of the load, between points.
    Peak,
    /// The frequency at which a sweep in this direction jumps first.
    Jump(Sweep),
}

/// Direction of a sweep over the frequency.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sweep {
    /// Toward higher frequencies.
    Up,
    /// Toward lower ones.
    Down,
}

/// Responses of a scene by their number and level; all of them where neither is given.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Selected {
    /// Number of the response, from 1.
    pub response: Option<usize>,
    /// Level, in the unit of the load.
    pub level: Option<f64>,
}

impl Of {
    /// Names of what is no column of `branch.csv`, and what it is called in labels.
    pub const NAMES: [(&'static str, &'static str); 5] = [
        ("peak", "fundamental_m"),
        ("jump_up_hz", "jump_up_hz"),
        ("jump_down_hz", "jump_down_hz"),
        ("max_force", "peak_contact_force_n"),
        ("impulse", "impulse_ns"),
    ];

    /// By its name in a study: a column, or one of [`Self::NAMES`].
    pub fn named(name: &str) -> Self {
        match name {
            "peak" => Self::Peak,
            "jump_up_hz" => Self::Jump(Sweep::Up),
            "jump_down_hz" => Self::Jump(Sweep::Down),
            "max_force" => Self::Column("peak_contact_force_n".to_owned()),
            "impulse" => Self::Column("impulse_ns".to_owned()),
            column => Self::Column(column.to_owned()),
        }
    }

    /// The column that it is of, or its name.
    pub fn column(&self) -> &str {
        match self {
            Self::Column(name) => name,
            Self::Peak => "fundamental_m",
            Self::Jump(Sweep::Up) => "jump_up_hz",
            Self::Jump(Sweep::Down) => "jump_down_hz",
        }
    }

    /// Whether it is of responses over the frequency alone.
    pub fn is_of_sweeps(&self) -> bool {
        !matches!(self, Self::Column(_))
    }
}

impl Quantity {
    /// Axis label: the name, and its column, which ends with the unit.
    pub fn label(&self) -> String {
        let of = self.of.column();
        if self.name == of { self.name.clone() } else { format!("{} ({of})", self.name) }
    }
}

/// Measured points to which variables are fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// The column that says where on the curve each row is.
    pub over: String,
    /// Its value in each row.
    pub places: Vec<f64>,
    /// The columns that are fitted.
    pub columns: Vec<MeasuredColumn>,
    /// The responses that were measured.
    pub response: Selected,
}

/// A column that is fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredColumn {
    /// Its name in `branch.csv`.
    pub name: String,
    /// Its value and standard deviation in each row; none where a cell is empty.
    pub cells: Vec<Option<[f64; 2]>>,
    /// Whether its standard deviations are stated; else all are one.
    pub has_deviations: bool,
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
    /// Measured points to which the variables are fitted.
    pub fit: Option<Measured>,
    /// Directory of the study.
    pub directory: PathBuf,
    /// Files kept of each case.
    pub keep: Keep,
}

//! Columns of a table.

use serde_json::Value;

/// The cells of a column; those that are empty are `None`.
#[derive(Debug, Clone, PartialEq)]
pub enum Cells {
    /// Numbers.
    Numbers(Vec<Option<f64>>),
    /// Whole numbers.
    Integers(Vec<Option<i64>>),
    /// Texts.
    Texts(Vec<Option<String>>),
}

/// A column with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Its cells.
    pub cells: Cells,
}

/// Columns of the same length.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// The columns.
    pub columns: Vec<Column>,
}

impl Cells {
    /// Values of a study file or a list: integers if all are, otherwise numbers if all are, otherwise text.
    pub fn of_values<'a>(values: impl Iterator<Item = &'a Value> + Clone) -> Self {
        if values.clone().all(Value::is_i64) {
            return Self::Integers(values.map(Value::as_i64).collect());
        }
        if values.clone().all(Value::is_number) {
            return Self::Numbers(values.map(Value::as_f64).collect());
        }
        let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        Self::Texts(values.map(|value| Some(text(value))).collect())
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(cells) => cells.len(),
            Self::Integers(cells) => cells.len(),
            Self::Texts(cells) => cells.len(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// As numbers; `None` if they are text.
    pub fn numbers(&self) -> Option<Vec<Option<f64>>> {
        match self {
            Self::Numbers(cells) => Some(cells.clone()),
            Self::Integers(cells) => Some(cells.iter().map(|cell| cell.map(|n| n as f64)).collect()),
            Self::Texts(_) => None,
        }
    }

    /// A cell in text form: the shortest decimal that reads back as the same number, or an empty string.
    pub fn text(&self, row: usize) -> String {
        let cell = match self {
            Self::Numbers(cells) => cells.get(row).copied().flatten().map(|x| format!("{x:?}")),
            Self::Integers(cells) => cells.get(row).copied().flatten().map(|n| n.to_string()),
            Self::Texts(cells) => cells.get(row).cloned().flatten(),
        };
        cell.unwrap_or_default()
    }
}

impl Table {
    /// Adds a column.
    pub fn push(&mut self, name: impl Into<String>, cells: Cells) {
        self.columns.push(Column { name: name.into(), cells });
    }

    /// A column by its name.
    pub fn column(&self, name: &str) -> Option<&Cells> {
        self.columns.iter().find(|column| column.name == name).map(|column| &column.cells)
    }

    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.cells.len())
    }
}

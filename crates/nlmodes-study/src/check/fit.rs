//! Measured points to which variables are fitted.

use std::path::Path;

use nlmodes_scene::{Diagnostic, Diagnostics};

use super::list::table;
use crate::curve::DIFFERENTIATED;
use crate::raw::RawFit;
use crate::study::{Measured, MeasuredColumn, Selected};

/// How the name of a column with standard deviations ends.
const DEVIATION: &str = "_std";

/// The points of a table, if there is no error.
pub fn measured(raw: &RawFit, base: &Path, diagnostics: &mut Diagnostics<'_>) -> Option<Measured> {
    let (path, over) = (base.join(raw.measured.as_ref()?), raw.over.clone()?);
    let refuse = |key: &str, title: String, label: String, diagnostics: &mut Diagnostics<'_>| {
        diagnostics.put(&format!("fit.{key}"), Diagnostic::error(title), label);
    };
    if !is_differentiated(&over) && over != "energy_j" {
        let title = format!("`fit.over` cannot be \"{over}\", of which no derivatives are known");
        refuse("over", title, format!("expected energy_j, {}", names().join(", ")), diagnostics);
        return None;
    }
    let table = match Table::read(&path) {
        Ok(table) => table,
        Err(reason) => {
            refuse("measured", format!("the points in {} cannot be read", path.display()), reason, diagnostics);
            return None;
        }
    };
    let Some(places) = table.column(&over) else {
        let title = format!("{} has no column {over}", path.display());
        refuse("over", title, format!("its columns: {}", table.header.join(", ")), diagnostics);
        return None;
    };
    let wanted = raw.columns.clone().unwrap_or_else(|| {
        let known = table.header.iter().filter(|name| **name != over && is_differentiated(name));
        known.cloned().collect()
    });
    let mut columns = Vec::new();
    for name in &wanted {
        match table.measured(name) {
            Some(column) if is_differentiated(name) => columns.push(column),
            _ => {
                let title = format!("\"{name}\" cannot be fitted");
                let label = format!("expected columns of the file among {}", names().join(", "));
                refuse("columns", title, label, diagnostics);
                return None;
            }
        }
    }
    if columns.is_empty() {
        let title = format!("{} has no column to fit", path.display());
        refuse("measured", title, format!("expected one of {}", names().join(", ")), diagnostics);
        return None;
    }
    if let Some(column) = columns.iter().find(|column| columns.len() > 1 && !column.has_deviations) {
        let title = format!("nothing says how much a row of {} counts beside the other columns", column.name);
        let label = format!("expected a column {}{DEVIATION} with standard deviations", column.name);
        refuse("measured", title, label, diagnostics);
        return None;
    }
    let is_bad = |cell: &Option<[f64; 2]>| cell.is_some_and(|[_, std]| !(std > 0.0 && std.is_finite()));
    if let Some(column) = columns.iter().find(|column| column.cells.iter().any(is_bad)) {
        let title = format!("a standard deviation of {} is not positive", column.name);
        refuse("measured", title, "expected positive numbers beside all values".to_owned(), diagnostics);
        return None;
    }
    let Some(places) = places.iter().copied().collect::<Option<Vec<f64>>>() else {
        let title = format!("a row of {} has no {over}", path.display());
        refuse("over", title, "expected a number in each row".to_owned(), diagnostics);
        return None;
    };
    let response = Selected { response: raw.response.map(|number| number as usize), level: raw.level };
    Some(Measured { over, places, columns, response })
}

fn names() -> Vec<&'static str> {
    DIFFERENTIATED.iter().map(|(name, _)| *name).collect()
}

fn is_differentiated(name: &str) -> bool {
    DIFFERENTIATED.iter().any(|(known, _)| *known == name)
}

/// A table of numbers; empty cells are none.
struct Table {
    header: Vec<String>,
    rows: Vec<Vec<Option<f64>>>,
}

impl Table {
    fn read(path: &Path) -> Result<Self, String> {
        let (header, rows) = table(path).map_err(|error| error.to_string())?;
        if rows.is_empty() {
            return Err("expected a header, and a row for each point".to_owned());
        }
        let number = |cell: &str| cell.parse::<f64>().ok().filter(|value| value.is_finite());
        let rows = rows.iter().map(|row| row.iter().map(number).collect()).collect();
        Ok(Self { header: header.iter().map(str::to_owned).collect(), rows })
    }

    fn column(&self, name: &str) -> Option<Vec<Option<f64>>> {
        let k = self.header.iter().position(|known| known == name)?;
        Some(self.rows.iter().map(|row| row.get(k).copied().flatten()).collect())
    }

    /// A column with its standard deviations; those of one without are one.
    fn measured(&self, name: &str) -> Option<MeasuredColumn> {
        let (values, stated) = (self.column(name)?, self.column(&format!("{name}{DEVIATION}")));
        let has_deviations = stated.is_some();
        let deviations = stated.unwrap_or_else(|| vec![Some(1.0); values.len()]);
        let cell = |(value, std): (Option<f64>, Option<f64>)| Some([value?, std.unwrap_or(f64::NAN)]);
        let cells = values.into_iter().zip(deviations).map(cell).collect();
        Some(MeasuredColumn { name: name.to_owned(), cells, has_deviations })
    }
}

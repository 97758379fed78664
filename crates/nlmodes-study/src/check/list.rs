//! A list of cases in a CSV.

use std::path::Path;

use csv::StringRecord;
use nlmodes_scene::{Diagnostic, Diagnostics};
use serde_json::Value;

use crate::study::{Design, DesignKind, Values, Variable};

const KEY: &str = "design.file";

/// A variable for each column.
pub fn variables(
    path: &Path,
    design: &Design,
    tables: usize,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<Vec<Variable>> {
    if design.kind != DesignKind::List || tables > 0 {
        let diagnostic = Diagnostic::error("a file of cases cannot be combined with other designs")
            .help("design.kind = \"list\", and no heading [[vary]]: the header of the file says what varies");
        diagnostics.put(KEY, diagnostic, "expected a list without other variables");
        return None;
    }
    match read(path) {
        Ok(variables) => Some(variables),
        Err(reason) => {
            diagnostics.put(KEY, Diagnostic::error(format!("the cases in {} cannot be read", path.display())), reason);
            None
        }
    }
}

fn read(path: &Path) -> Result<Vec<Variable>, String> {
    let (header, rows) = table(path).map_err(|error| error.to_string())?;
    let mut columns: Vec<Vec<Vec<Value>>> = vec![Vec::new(); header.len()];
    for row in &rows {
        columns.iter_mut().zip(row).for_each(|(column, cell)| column.push(vec![value(cell)]));
    }
    if columns.first().is_none_or(Vec::is_empty) {
        return Err("expected a header with keys, and a row a case".into());
    }
    if let Some(wrong) = header.iter().find(|key| key.is_empty() || key.contains('=')) {
        return Err(format!("the header has \"{wrong}\", expected what `--set` takes, as contact.0.gap_m"));
    }
    let variable = |(key, values): (&str, Vec<Vec<Value>>)| Variable {
        name: key.to_owned(),
        keys: vec![key.to_owned()],
        values: Values::Listed(values),
    };
    Ok(header.iter().zip(columns).map(variable).collect())
}

/// The header of a file and its rows, cells without blanks around them.
pub(super) fn table(path: &Path) -> Result<(StringRecord, Vec<StringRecord>), csv::Error> {
    let mut table = csv::ReaderBuilder::new().trim(csv::Trim::All).from_path(path)?;
    Ok((table.headers()?.clone(), table.records().collect::<Result<_, _>>()?))
}

/// A number if it is one, otherwise text.
fn value(cell: &str) -> Value {
    let whole = cell.parse::<i64>().map(Value::from);
    whole.unwrap_or_else(|_| {
        cell.parse::<f64>().ok().filter(|x| x.is_finite()).map_or_else(|| Value::from(cell), Value::from)
    })
}

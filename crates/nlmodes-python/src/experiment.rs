//! `nlmodes.experiment`: modal points of records in memory.

use nlmodes::experiment::records::{Column, RecordTable};
use nlmodes_run::chain;
use nlmodes_run::records::{extract_tables, table_of};
use nlmodes_scene::parse_records;
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;

use crate::errors;

/// A row of figures and the findings of one record: name and sentence of each.
type Told = Vec<(String, String)>;

/// The table of `modal_points.csv` as text, and the findings of each record.
///
/// `scene` is the text of a scene of records; `records` have a name and their channels, by name, in the units that the
/// scene gives.
#[pyfunction]
pub fn extract(
    py: Python<'_>,
    scene: &str,
    records: Vec<(String, Vec<(String, PyReadonlyArray1<'_, f64>)>)>,
) -> PyResult<(Vec<u8>, Vec<Told>, Vec<String>)> {
    let file = parse_records("scene of records", scene, &[]).map_err(|refused| errors::refused(py, &refused))?;
    let column = |(name, values): (String, PyReadonlyArray1<'_, f64>)| {
        Column::new(name, values.as_array().iter().copied().collect())
    };
    let table = |(name, channels): (String, Vec<_>)| {
        (name, RecordTable { columns: channels.into_iter().map(column).collect(), named: true })
    };
    let tables: Vec<(String, RecordTable)> = records.into_iter().map(table).collect();
    let found = errors::computed(py, || extract_tables(&file, tables))?;
    let outcomes = found.map_err(|error| errors::of_run(py, &error))?;
    let modes = outcomes.iter().filter_map(|outcome| Some(outcome.result.as_ref().ok()?.modal.as_ref()?));
    let modes = modes.map(|modal| modal.participation.factors.len()).max().unwrap_or(0);
    let text = table_of(&outcomes, modes).map_err(|error| errors::run_error(py, &chain(error.as_ref())))?;
    let told = outcomes.iter().map(|outcome| match &outcome.result {
        Ok(found) => found.findings.iter().map(|finding| (finding.name().to_owned(), finding.to_string())).collect(),
        Err(error) => vec![(error.names(), error.to_string())],
    });
    Ok((text, told.collect(), file.warning_sentences()))
}

//! The table of a study: one row per case.

use crate::case::Case;
use crate::collect::row::Row;
use crate::study::{Of, Place, Study};
use crate::table::{Cells, Table, error_column};

/// Fixed and optional columns of every table.
pub const FIXED: [&str; 7] = ["case", "method", "harmonics", "points", "status", "reason", "id"];

/// The table of cases with the results of each.
pub fn table(study: &Study, cases: &[Case], rows: &[Row]) -> Table {
    let mut table = Table::default();
    table.push("case", Cells::Integers(cases.iter().map(|case| Some(case.number as i64)).collect()));
    for (k, variable) in study.variables.iter().enumerate() {
        table.push(&variable.name, Cells::of_values(cases.iter().filter_map(|case| case.values.get(k))));
    }
    // A case may have no scene and therefore no method.
    let methods = || cases.iter().filter(|case| case.harmonics > 0);
    if methods().any(|case| case.part > 0) {
        let known = |case: &Case| case.harmonics > 0;
        table.push("method", Cells::Texts(cases.iter().map(|c| known(c).then(|| c.method.to_owned())).collect()));
        table
            .push("harmonics", Cells::Integers(cases.iter().map(|c| known(c).then_some(c.harmonics as i64)).collect()));
    }
    for (k, quantity) in study.quantities.iter().enumerate() {
        let cell = |row: &Row| row.values.get(k).copied().flatten();
        table.push(&quantity.name, Cells::Numbers(rows.iter().map(|row| cell(row).map(|v| v[0])).collect()));
        if matches!(quantity.at, Place::Column { .. }) || quantity.of == Of::Peak {
            let error = rows.iter().map(|row| cell(row).map(|v| v[1])).collect();
            table.push(error_column(&quantity.name), Cells::Numbers(error));
        }
    }
    table.push("points", Cells::Integers(rows.iter().map(|row| row.points.map(|n| n as i64)).collect()));
    table.push("status", Cells::Texts(rows.iter().map(|row| Some(row.state.name().to_owned())).collect()));
    table.push("reason", Cells::Texts(rows.iter().map(|row| Some(row.reason.clone())).collect()));
    table.push("id", Cells::Texts(cases.iter().map(|case| case.id.as_ref().ok().cloned()).collect()));
    table
}

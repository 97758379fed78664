//! Data for the script of the page.

use serde_json::{Map, Value, json};

use crate::collect::{Collected, Drawn};
use crate::store::Store;
use crate::study::Study;
use crate::table::{Cells, Column};

/// As JSON that can be embedded in an element of a page.
pub fn json(study: &Study, collected: &Collected) -> String {
    let store = Store::new(&study.directory);
    let ids = match collected.table.column("id") {
        Some(Cells::Texts(ids)) => ids.as_slice(),
        _ => &[],
    };
    let link = |id: &Option<String>| {
        let id = id.as_ref()?;
        let own = store.case(id).join("report.html").is_file();
        Some(format!("{}/{}", Store::link(id), if own { "report.html" } else { "" }))
    };
    let data = json!({
        "columns": collected.table.columns.iter().map(column).collect::<Vec<_>>(),
        "links": ids.iter().map(link).collect::<Vec<_>>(),
        "labels": study.quantities.iter().map(|quantity| (quantity.name.clone(), json!(quantity.label())))
            .collect::<Map<_, _>>(),
        "quantities": study.quantities.iter().map(|quantity| &quantity.name).collect::<Vec<_>>(),
        "variables": study.variables.iter().map(|variable| &variable.name).collect::<Vec<_>>(),
        "drawn": collected.drawn.iter().map(branch).collect::<Vec<_>>(),
        "band": { "x": rounded(&collected.band.x), "y": collected.band.y.each_ref().map(|line| rounded(line)) },
        "envelope": collected.band.envelope.as_ref().map(|[least, most]| [rounded(least), rounded(most)]),
        "of_responses": collected.drawn.iter().any(|drawn| drawn.is_response),
    });
    // A string must not contain the end of an element.
    data.to_string().replace('<', "\\u003c").replace('&', "\\u0026")
}

fn column(column: &Column) -> Value {
    let (kind, cells) = match &column.cells {
        Cells::Numbers(cells) => ("number", json!(cells)),
        Cells::Integers(cells) => ("number", json!(cells)),
        Cells::Texts(cells) => ("text", json!(cells)),
    };
    json!({ "name": column.name, "kind": kind, "cells": cells })
}

fn branch(drawn: &Drawn) -> Value {
    json!({ "case": drawn.case, "x": rounded(&drawn.x), "y": rounded(&drawn.y) })
}

/// Seven digits, more than any screen shows.
fn rounded(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| nlmodes_scene::rounded(*value, 7)).collect()
}

//! Comma-separated `row,node,component[,x,y,z]`.

use std::collections::HashMap;
use std::path::Path;

use super::{Component, DofLabel, LabelTable, repeated};
use crate::error::{Problem, Result};
use crate::text::{Lines, commas, unsigned};

const NAMES: [&str; 6] = ["row", "node", "component", "x", "y", "z"];

struct Row {
    row: u64,
    line: u64,
    label: DofLabel,
}

/// Rows may come in any order and be counted from 0 or from 1: with n of them, one is 0 or n.
pub(super) fn read(path: &Path) -> Result<LabelTable> {
    let mut lines = Lines::open(path)?;
    let mut rows = Vec::new();
    let mut positions = HashMap::new();
    let (mut width, mut lines_of) = (None, HashMap::new());
    while lines.advance()? {
        if lines.line().trim_ascii().is_empty() || lines.line().starts_with(b"#") {
            continue;
        }
        let fields: Vec<&[u8]> = commas(lines.line()).collect();
        if width.is_none() {
            width = Some(fields.len());
            if !(fields.len() == 3 || fields.len() == 6) {
                return Err(lines.expected("three or six columns, row,node,component[,x,y,z]", lines.line()));
            }
            if unsigned(fields[0]).is_none() {
                check_heading(&lines, &fields, &NAMES)?;
                continue;
            }
        }
        let width = width.unwrap_or_default();
        if fields.len() != width {
            return Err(lines.expected(format!("{width} columns, as in the lines before"), lines.line()));
        }
        let row = lines.unsigned(fields[0], "row")?;
        let node = lines.unsigned(fields[1], "number of the node")?;
        let label = DofLabel { node, component: component(&lines, fields[2])? };
        if let Some(before) = lines_of.insert(label, lines.number()) {
            return Err(lines.error(repeated(label, before)));
        }
        if let [x, y, z] = fields[3..] {
            let place = [lines.real(x, "coordinate")?, lines.real(y, "coordinate")?, lines.real(z, "coordinate")?];
            if positions.insert(node, place).is_some_and(|before| before != place) {
                return Err(lines.expected(format!("node {node} at the place of its earlier line"), lines.line()));
            }
        }
        rows.push(Row { row, line: lines.number(), label });
    }
    if rows.is_empty() {
        return Err(lines.ended("a line row,node,component"));
    }
    Ok(LabelTable { labels: in_order(&lines, rows)?, positions, repeated: None })
}

pub(super) fn check_heading(lines: &Lines, fields: &[&[u8]], names: &[&str]) -> Result<()> {
    let wrong = fields.iter().zip(names).find(|(found, name)| !found.eq_ignore_ascii_case(name.as_bytes()));
    wrong.map_or(Ok(()), |(found, name)| Err(lines.expected(format!("the column `{name}`"), found)))
}

pub(super) fn component(lines: &Lines, field: &[u8]) -> Result<Component> {
    let named = std::str::from_utf8(field).ok().and_then(Component::from_name);
    named.ok_or_else(|| lines.expected("a component 1 to 6, ux, uy, uz, rotx, roty or rotz", field))
}

fn in_order(lines: &Lines, mut rows: Vec<Row>) -> Result<Vec<DofLabel>> {
    rows.sort_by_key(|row| row.row);
    let base = u64::from(rows[0].row != 0);
    for (k, row) in rows.iter().enumerate() {
        let expected = k as u64 + base;
        if row.row != expected {
            let problem = Problem::Expected {
                expected: format!(
                    "each row from {base} to {} once, so row {expected} next",
                    rows.len() as u64 - 1 + base
                ),
                found: format!("row {}", row.row),
            };
            return Err(crate::ReadError::new(lines.path(), crate::Place::Line(row.line), problem));
        }
    }
    Ok(rows.into_iter().map(|row| row.label).collect())
}

//! `node,dof, node,dof, value`: what Abaqus writes with `*MATRIX OUTPUT, FORMAT=MATRIX INPUT`, one triangle.

use std::path::Path;

use super::MatrixData;
use super::labelled::{LabelledBuilder, label};
use crate::build::{Fault, Pass, Triangles, with_lines_of_faults};
use crate::error::{Problem, ReadError, Result};
use crate::labels::DofLabel;
use crate::text::{Lines, commas, signed};

pub(super) fn read(path: &Path) -> Result<MatrixData> {
    with_lines_of_faults(
        |fault| pass(path, fault),
        |fault| ReadError::whole(path, fault.problem(|k| format!("degree of freedom {}", k + 1))),
    )
}

fn pass(path: &Path, fault: Option<Fault>) -> Result<Pass<MatrixData>> {
    let mut lines = Lines::open(path)?;
    let mut builder = LabelledBuilder::new(Triangles::One, fault);
    while lines.advance_whole()? {
        let line = lines.line().trim_ascii();
        if line.is_empty() || line.starts_with(b"**") {
            continue;
        }
        let mut fields = commas(line);
        let mut next = || fields.next().unwrap_or_default();
        let (row, column) = (dof(&lines, next(), next())?, dof(&lines, next(), next())?);
        let value = lines.real(next(), "value")?;
        if let Some(more) = fields.next() {
            return Err(lines.expected("the end of the line after `node,dof, node,dof, value`", more));
        }
        builder.push(row, column, value).map_err(|problem| lines.error(problem))?;
    }
    if builder.is_empty() {
        return Err(lines.ended("a line `node,dof, node,dof, value`"));
    }
    Ok(builder.finish())
}

fn dof(lines: &Lines, node: &[u8], direction: &[u8]) -> Result<DofLabel> {
    match (signed(node), signed(direction)) {
        (Some(number), Some(_)) if number < 0 => Err(lines.error(Problem::Refused {
            found: format!("node {number}"),
            expected: "nodes of the mesh",
            reason: "negative numbers are Lagrange multipliers of constraints or contacts, which have no mass and no positive \
                     stiffness; write the constraints as equations, which Abaqus eliminates",
        })),
        (Some(number), Some(direction)) if number > 0 && direction > 0 => {
            label(number as u64, direction as u64, false).ok_or_else(|| {
                lines.expected("a direction from 1 to 6", direction.to_string().as_bytes())
            })
        }
        (Some(number), _) if number > 0 => Err(lines.expected("a direction from 1 to 6", direction)),
        _ => Err(lines.expected("a node, as in `node,dof, node,dof, value`", node)),
    }
}

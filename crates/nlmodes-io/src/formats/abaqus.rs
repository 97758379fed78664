//! What Abaqus writes as text: `node,dof, node,dof, value` with `*MATRIX OUTPUT, FORMAT=MATRIX INPUT`, one triangle or
//! both of them, and user elements.

use std::path::Path;

use super::labelled::{LabelledBuilder, label};
use super::{MatrixData, check_unnamed, user_element};
use crate::build::{Fault, Pass, Triangles, with_lines_of_faults};
use crate::error::{Problem, ReadError, Result};
use crate::labels::DofLabel;
use crate::text::{Lines, commas, signed};

pub(super) fn read(path: &Path, name: Option<&str>) -> Result<MatrixData> {
    if user_element::is_one(path)? {
        return user_element::read(path, name);
    }
    check_unnamed(path, name)?;
    let triangles = match pass(path, Triangles::One, None)? {
        (Pass::Read(matrix), _) => return Ok(matrix),
        (Pass::Faulty(_), triangles) => triangles,
    };
    with_lines_of_faults(
        |fault| pass(path, triangles, fault).map(|(matrix, _)| matrix),
        |fault| ReadError::whole(path, fault.problem(|k| format!("degree of freedom {}", k + 1))),
    )
}

/// Of the entries above and below the diagonal, the share that may lack its mirror image in a file of both triangles:
/// zeros of rounding that are written on one side alone, or entries that were lost, which are named then.
const ONE_SIDED: f64 = 0.1;

/// The matrix, and which triangles the file seems to hold: both of them where about as many entries are above the
/// diagonal as below it.
fn pass(path: &Path, triangles: Triangles, fault: Option<Fault>) -> Result<(Pass<MatrixData>, Triangles)> {
    let mut lines = Lines::open(path)?;
    let mut builder = LabelledBuilder::new(triangles, fault);
    let (mut above, mut below) = (0_u64, 0_u64);
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
        above += u64::from(row < column);
        below += u64::from(row > column);
        builder.push(row, column, value).map_err(|problem| lines.error(problem))?;
    }
    if builder.is_empty() {
        return Err(lines.ended("a line `node,dof, node,dof, value`"));
    }
    let (more, less) = (above.max(below) as f64, above.min(below) as f64);
    let both = more > 0.0 && more - less <= ONE_SIDED * more;
    Ok((builder.finish(), if both { Triangles::Both } else { Triangles::One }))
}

fn dof(lines: &Lines, node: &[u8], direction: &[u8]) -> Result<DofLabel> {
    match (signed(node), signed(direction)) {
        (Some(number), Some(_)) if number < 0 => Err(lines.error(Problem::Refused {
            found: format!("node {number}"),
            expected: "nodes of the mesh",
            reason: "negative numbers are Lagrange multipliers of constraints or contacts, which have no mass and no \
                positive \
                     stiffness; write the constraints as equations, which Abaqus eliminates",
        })),
        (Some(number), Some(direction)) if number > 0 && direction > 0 => label(number as u64, direction as u64, false)
            .ok_or_else(|| lines.expected("a direction from 1 to 6", direction.to_string().as_bytes())),
        (Some(number), _) if number > 0 => Err(lines.expected("a direction from 1 to 6", direction)),
        _ => Err(lines.expected("a node, as in `node,dof, node,dof, value`", node)),
    }
}

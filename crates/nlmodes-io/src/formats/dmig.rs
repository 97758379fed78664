//! Direct matrix input at grid points, as Nastran punches: fields of 8 or 16 characters, symmetric (form 6) or square
//! (form 1).

use std::path::Path;

use super::MatrixData;
use super::labelled::{LabelledBuilder, label};
use crate::build::{Fault, Pass, Triangles, with_lines_of_faults};
use crate::error::{Problem, ReadError, Result};
use crate::labels::DofLabel;
use crate::text::{Lines, real, unsigned};

/// Entries of a punch file that say nothing about matrices.
const PASSED_OVER: [&[u8]; 14] = [
    b"$",
    b"TITLE",
    b"SUBTITLE",
    b"LABEL",
    b"BEGIN",
    b"ENDDATA",
    b"GRID",
    b"CORD",
    b"SPOINT",
    b"ASET",
    b"EXTRN",
    b"SEBULK",
    b"INCLUDE",
    b"PARAM",
];

pub(super) fn read(path: &Path, name: Option<&str>) -> Result<MatrixData> {
    let name = match name {
        Some(name) => name.to_owned(),
        None => only_name(path)?,
    };
    with_lines_of_faults(
        |fault| pass(path, &name, fault),
        |fault| ReadError::whole(path, fault.problem(|k| format!("degree of freedom {}", k + 1))),
    )
}

/// Names of the matrices, from their headers.
fn names(path: &Path) -> Result<Vec<String>> {
    let mut lines = Lines::open(path)?;
    let mut names = Vec::new();
    while lines.advance_whole()? {
        if let Card::Header { name, .. } = card(&lines)? {
            names.push(name);
        }
    }
    Ok(names)
}

fn only_name(path: &Path) -> Result<String> {
    let names = names(path)?;
    match names.as_slice() {
        [name] => Ok(name.clone()),
        [] => Err(ReadError::whole(path, Problem::Expected { expected: "a DMIG header".into(), found: "none".into() })),
        _ => {
            let example =
                format!("{}#{}", path.file_name().map_or("model.pch".into(), |n| n.to_string_lossy()), names[0]);
            Err(ReadError::whole(path, Problem::Ambiguous { what: "matrices", known: names, example }))
        }
    }
}

/// What a line is.
enum Card {
    /// `DMIG name 0 form type …`
    Header { name: String, form: u64, kind: u64 },
    /// `DMIG name node direction …`: a column begins, with entries in the line itself where fields are short.
    Column { name: String, label: DofLabel, long: bool },
    /// Entries of the column.
    More { long: bool },
    /// Something else.
    Other,
}

/// Field `k` of a line, from 0, which is the first after the one of the name of the card.
fn field(line: &[u8], long: bool, k: usize) -> &[u8] {
    let width = if long { 16 } else { 8 };
    let (from, to) = (8 + k * width, 8 + (k + 1) * width);
    line.get(from.min(line.len())..to.min(line.len())).unwrap_or_default().trim_ascii()
}

fn card(lines: &Lines) -> Result<Card> {
    let line = lines.line();
    let start = line.get(..8.min(line.len())).unwrap_or_default().trim_ascii();
    let upper = start.to_ascii_uppercase();
    match upper.as_slice() {
        b"DMIG" | b"DMIG*" => dmig(lines, upper.ends_with(b"*")),
        b"*" => Ok(Card::More { long: true }),
        b"+" | b"" if !line.trim_ascii().is_empty() => Ok(Card::More { long: false }),
        b"" => Ok(Card::Other),
        start if start.starts_with(b"*") => Ok(Card::More { long: true }),
        start if start.starts_with(b"+") => Ok(Card::More { long: false }),
        start if PASSED_OVER.iter().any(|known| start.starts_with(known)) => Ok(Card::Other),
        _ => Err(lines.expected("DMIG, its continuation or a comment", line)),
    }
}

fn dmig(lines: &Lines, long: bool) -> Result<Card> {
    let line = lines.line();
    if line.contains(&b',') {
        return Err(lines.expected("fields of 8 or 16 characters, as punched, without commas", line));
    }
    let name = String::from_utf8_lossy(field(line, long, 0)).to_uppercase();
    let node = lines.unsigned(field(line, long, 1), "number of the grid point")?;
    if name.is_empty() {
        return Err(lines.expected("the name of a matrix", line));
    }
    if node == 0 {
        let form = lines.unsigned(field(line, long, 2), "form")?;
        return Ok(Card::Header { name, form, kind: lines.unsigned(field(line, long, 3), "type of the numbers")? });
    }
    Ok(Card::Column { name, label: dof(lines, field(line, long, 1), field(line, long, 2))?, long })
}

fn dof(lines: &Lines, node: &[u8], direction: &[u8]) -> Result<DofLabel> {
    let node = lines.unsigned(node, "number of the grid point")?;
    let number = if direction.is_empty() { Some(0) } else { unsigned(direction) };
    number
        .and_then(|number| label(node, number, true))
        .filter(|label| label.node > 0)
        .ok_or_else(|| lines.expected("a direction from 1 to 6, or 0 of a scalar point", direction))
}

fn pass(path: &Path, wanted: &str, fault: Option<Fault>) -> Result<Pass<MatrixData>> {
    let mut lines = Lines::open(path)?;
    let mut builder: Option<LabelledBuilder> = None;
    // The column under way, if it is of the matrix that is wanted, and whether a card is one of a matrix at all.
    let (mut column, mut in_matrix) = (None, false);
    let mut known = Vec::new();
    while lines.advance_whole()? {
        match card(&lines)? {
            Card::Header { name, form, kind } => {
                (column, in_matrix) = (None, false);
                if name.eq_ignore_ascii_case(wanted) {
                    builder = Some(LabelledBuilder::new(header(&lines, form, kind)?, fault));
                }
                known.push(name);
            }
            Card::Column { name, label, long } => {
                if !known.contains(&name) {
                    return Err(lines.expected(format!("the header of {name} before its columns"), lines.line()));
                }
                in_matrix = true;
                column = name.eq_ignore_ascii_case(wanted).then_some(label);
                if let (Some(label), Some(builder), false) = (column, &mut builder, long) {
                    entry(&lines, builder, label, false, 4)?;
                }
            }
            Card::More { long } => {
                if let (Some(label), Some(builder)) = (column, &mut builder) {
                    entry(&lines, builder, label, long, 0)?;
                    if !long {
                        entry(&lines, builder, label, long, 4)?;
                    }
                } else if !in_matrix && column.is_some() {
                    return Err(lines.expected("a column before its entries", lines.line()));
                }
            }
            Card::Other => (column, in_matrix) = (None, false),
        }
    }
    let missing = || Problem::Missing { what: "matrix", name: wanted.to_owned(), known: known.clone() };
    let builder = builder.ok_or_else(|| ReadError::whole(path, missing()))?;
    if builder.is_empty() {
        return Err(lines.ended(&format!("columns of {wanted}")));
    }
    Ok(builder.finish())
}

fn header(lines: &Lines, form: u64, kind: u64) -> Result<Triangles> {
    if kind > 2 {
        return Err(lines.error(Problem::Refused {
            found: format!("numbers of type {kind}"),
            expected: "type 1 or 2, real numbers",
            reason: "complex matrices hold damping, which stands elsewhere",
        }));
    }
    match form {
        6 => Ok(Triangles::One),
        1 => Ok(Triangles::Both),
        _ => Err(lines.expected("form 6, symmetric, or form 1, square", form.to_string().as_bytes())),
    }
}

/// Grid point, direction and value from field `first` on, if there is anything.
fn entry(lines: &Lines, builder: &mut LabelledBuilder, column: DofLabel, long: bool, first: usize) -> Result<()> {
    let at = |k: usize| field(lines.line(), long, first + k);
    if (0..4).all(|k| at(k).is_empty()) {
        return Ok(());
    }
    let row = dof(lines, at(0), at(1))?;
    let text = at(2);
    if real(text).is_none() {
        return Err(lines.expected("a number, the value", text));
    }
    builder.push(row, column, lines.real(text, "value")?).map_err(|problem| lines.error(problem))
}

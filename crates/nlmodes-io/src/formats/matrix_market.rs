//! Matrix Market exchange format, <https://math.nist.gov/MatrixMarket/formats.html>: real or integer, symmetric or
//! general, coordinate or array.

use std::path::Path;

use super::{check_entries, check_order};
use crate::build::{EntryBuilder, Fault, Pass, Triangles, with_lines_of_faults};
use crate::error::{Place, Problem, ReadError, Result, shown};
use crate::lower::LowerTriangle;
use crate::text::Lines;

pub(super) fn read(path: &Path, order: Option<usize>) -> Result<LowerTriangle> {
    let name = |k: usize| (k + 1).to_string();
    with_lines_of_faults(|fault| pass(path, order, fault), |fault| ReadError::whole(path, fault.problem(name)))
}

fn pass(path: &Path, expected: Option<usize>, fault: Option<Fault>) -> Result<Pass<LowerTriangle>> {
    let mut lines = Lines::open(path)?;
    let header = header(&mut lines)?;
    let mut builder = EntryBuilder::new(header.triangles, fault);
    let order = if header.coordinate {
        coordinates(&mut lines, &mut builder, expected)?
    } else {
        array(&mut lines, &mut builder, header.triangles, expected)?
    };
    nothing_more(&mut lines)?;
    Ok(builder.finish(order, None).map_or_else(Pass::Faulty, Pass::Read))
}

struct Header {
    coordinate: bool,
    triangles: Triangles,
}

fn header(lines: &mut Lines) -> Result<Header> {
    lines.need("the line %%MatrixMarket matrix …")?;
    let words = String::from_utf8_lossy(lines.line()).to_lowercase();
    let words: Vec<&str> = words.split_whitespace().collect();
    let expected = |what: &str, k: usize| lines.expected(what, words.get(k).unwrap_or(&"").as_bytes());
    let word = |k: usize| words.get(k).copied().unwrap_or_default();
    if word(0) != "%%matrixmarket" || word(1) != "matrix" {
        return Err(expected("%%MatrixMarket matrix", usize::from(word(0) == "%%matrixmarket")));
    }
    let coordinate = match word(2) {
        "coordinate" => true,
        "array" => false,
        _ => return Err(expected("coordinate or array", 2)),
    };
    if !["real", "integer", "double"].contains(&word(3)) {
        return Err(expected("real or integer", 3));
    }
    let triangles = match word(4) {
        "symmetric" => Triangles::One,
        "general" => Triangles::Both,
        _ => return Err(expected("symmetric or general", 4)),
    };
    Ok(Header { coordinate, triangles })
}

/// The next line that is neither a comment nor empty.
fn content(lines: &mut Lines, expected: &str) -> Result<()> {
    loop {
        lines.need(expected)?;
        let line = lines.line().trim_ascii();
        if !line.is_empty() && !line.starts_with(b"%") {
            return Ok(());
        }
    }
}

/// Rows and columns, which are as many.
fn square(lines: &Lines, rows: u64, columns: u64, expected: Option<usize>) -> Result<usize> {
    if rows != columns {
        let what = "columns of a symmetric matrix".to_owned();
        return Err(lines.error(Problem::Size { what, expected: rows, found: columns }));
    }
    check_order(lines.path(), Place::Line(lines.number()), rows, expected)
}

fn coordinates(lines: &mut Lines, builder: &mut EntryBuilder, expected: Option<usize>) -> Result<usize> {
    content(lines, "a line with the numbers of rows, columns and entries")?;
    let mut fields = lines.fields();
    let rows = lines.unsigned(fields.word(), "number of rows")?;
    let columns = lines.unsigned(fields.word(), "number of columns")?;
    let entries = lines.unsigned(fields.word(), "number of entries")?;
    lines.end(fields, "the number of entries")?;
    let order = square(lines, rows, columns, expected)?;
    check_entries(lines.path(), Place::Line(lines.number()), order, entries, expected)?;
    for k in 0..entries {
        if !lines.advance_whole()? {
            return Err(lines.ended(&format!("entry {} of {entries}", k + 1)));
        }
        let mut fields = lines.fields();
        let row = lines.index(fields.word(), "row", order)?;
        let column = lines.index(fields.word(), "column", order)?;
        let value = lines.real(fields.word(), "value")?;
        lines.end(fields, "the value")?;
        builder.push(row, column, value).map_err(|fault| lines.error(fault.problem(|k| (k + 1).to_string())))?;
    }
    // The header may promise entries that were not there when it was checked against the order.
    check_entries(lines.path(), Place::File, order, builder.n_entries() as u64, expected)?;
    Ok(order)
}

/// All values column by column; of a symmetric matrix those from the diagonal on.
fn array(
    lines: &mut Lines,
    builder: &mut EntryBuilder,
    triangles: Triangles,
    expected: Option<usize>,
) -> Result<usize> {
    content(lines, "a line with the numbers of rows and columns")?;
    let mut fields = lines.fields();
    let rows = lines.unsigned(fields.word(), "number of rows")?;
    let columns = lines.unsigned(fields.word(), "number of columns")?;
    lines.end(fields, "the number of columns")?;
    let order = square(lines, rows, columns, expected)?;
    for j in 0..order {
        for i in if triangles == Triangles::One { j } else { 0 }..order {
            if !lines.advance_whole()? {
                return Err(lines.ended(&format!("the value in row {} of column {}", i + 1, j + 1)));
            }
            let mut fields = lines.fields();
            let value = lines.real(fields.word(), "value")?;
            lines.end(fields, "the value")?;
            builder.push(i, j, value).map_err(|fault| lines.error(fault.problem(|k| (k + 1).to_string())))?;
        }
    }
    Ok(order)
}

fn nothing_more(lines: &mut Lines) -> Result<()> {
    while lines.advance()? {
        let line = lines.line().trim_ascii();
        if !line.is_empty() {
            let found = shown(line);
            return Err(
                lines.error(Problem::Expected { expected: "the end of the file: all entries are there".into(), found })
            );
        }
    }
    Ok(())
}

//! Harwell-Boeing format, real symmetric assembled (`RSA`): the lower triangle in compressed columns, numbers in
//! Fortran's columns.

use std::path::Path;

use super::compressed::Layout;
use super::fortran::Columns;
use super::{check_entries, check_order};
use crate::build::Stored;
use crate::error::{Place, Problem, Result, shown};
use crate::lower::LowerTriangle;
use crate::text::Lines;

pub(super) fn read(path: &Path, expected: Option<usize>) -> Result<LowerTriangle> {
    let mut lines = Lines::open(path)?;
    let header = header(&mut lines, expected)?;
    let layout = Layout { path, stored: Stored::Lower, base: 1, names: ["pointers", "row indices", "values"] };
    let mut pointers = Vec::new();
    let mut section = Section::new(&mut lines, header.pointers, header.order as u64 + 1, "pointer");
    while let Some(pointer) = section.whole_number() {
        pointers.push(pointer?);
    }
    layout.check_pointers(&pointers, header.entries)?;
    let mut rows: Vec<u32> = Vec::new();
    let mut section = Section::new(&mut lines, header.rows, header.entries, "row index");
    while let Some(row) = section.whole_number() {
        let row = row?;
        if row < 1 || row > header.order as u64 {
            return Err(section
                .lines
                .expected(format!("a row from 1 to {}", header.order), row.to_string().as_bytes()));
        }
        rows.push(row as u32);
    }
    let mut section = Section::new(&mut lines, header.values, header.entries, "value");
    let mut values = std::iter::from_fn(|| section.real());
    layout.read(&pointers, &mut rows.iter().map(|row| Ok(u64::from(*row))), &mut values)
}

struct Header {
    order: usize,
    entries: u64,
    pointers: Columns,
    rows: Columns,
    values: Columns,
}

/// Title; numbers of lines; type and size; formats; with right-hand sides, their type.
fn header(lines: &mut Lines, expected: Option<usize>) -> Result<Header> {
    lines.need("a title")?;
    lines.need("the numbers of lines")?;
    let counts = numbers(lines, "number of lines")?;
    if counts.len() < 4 {
        return Err(lines.expected("the numbers of lines: all, pointers, row indices, values", lines.line()));
    }
    let with_right_hand_sides = counts.get(4).is_some_and(|count| *count > 0);
    lines.need("the type RSA and the size")?;
    let (order, entries) = size(lines, expected)?;
    lines.need("the formats of the numbers")?;
    let (pointers, rows, values) = formats(lines)?;
    if with_right_hand_sides {
        lines.need("the type of right-hand sides")?;
    }
    Ok(Header { order, entries, pointers, rows, values })
}

fn numbers(lines: &Lines, what: &str) -> Result<Vec<u64>> {
    lines.fields().map(|field| lines.unsigned(field, what)).collect()
}

fn size(lines: &Lines, expected: Option<usize>) -> Result<(usize, u64)> {
    let mut fields = lines.fields();
    let kind = fields.word();
    if !kind.eq_ignore_ascii_case(b"RSA") {
        return Err(lines.error(Problem::Refused {
            found: shown(kind),
            expected: "RSA",
            reason: "only real symmetric assembled matrices are mass and stiffness",
        }));
    }
    let rows = lines.unsigned(fields.word(), "number of rows")?;
    let columns = lines.unsigned(fields.word(), "number of columns")?;
    let entries = lines.unsigned(fields.word(), "number of entries")?;
    if rows != columns {
        let what = "columns of a symmetric matrix".to_owned();
        return Err(lines.error(Problem::Size { what, expected: rows, found: columns }));
    }
    let place = Place::Line(lines.number());
    let order = check_order(lines.path(), place.clone(), rows, expected)?;
    check_entries(lines.path(), place, order, entries, expected)?;
    Ok((order, entries))
}

/// Two of 16 characters, then one of 20.
fn formats(lines: &Lines) -> Result<(Columns, Columns, Columns)> {
    let line = lines.line();
    let part = |from: usize, to: usize| line.get(from.min(line.len())..to.min(line.len())).unwrap_or_default();
    let parsed = |text: &[u8], integer: bool, what: &str| {
        let columns = Columns::parse(text).filter(|columns| columns.integer == integer);
        columns.ok_or_else(|| lines.expected(format!("a Fortran format of {what}"), text.trim_ascii()))
    };
    Ok((
        parsed(part(0, 16), true, "pointers, as (8I10)")?,
        parsed(part(16, 32), true, "row indices, as (8I10)")?,
        parsed(part(32, 52), false, "values, as (4E20.12)")?,
    ))
}

/// `count` numbers, with the number per line given by the format.
struct Section<'a> {
    lines: &'a mut Lines,
    columns: Columns,
    left: u64,
    count: u64,
    what: &'static str,
    start: usize,
}

impl<'a> Section<'a> {
    fn new(lines: &'a mut Lines, columns: Columns, count: u64, what: &'static str) -> Self {
        Self { lines, columns, left: count, count, what, start: columns.count * columns.width }
    }

    /// Start and end of the next number in the line; continues with the next line after the last one.
    fn next(&mut self) -> Option<Result<(usize, usize)>> {
        if self.left == 0 {
            return None;
        }
        let Columns { count, width, .. } = self.columns;
        if self.start >= count * width {
            match self.lines.advance_whole() {
                Ok(true) => self.start = 0,
                Ok(false) => {
                    let expected = format!("{} {} of {}", self.what, self.count - self.left + 1, self.count);
                    return Some(Err(self.lines.ended(&expected)));
                }
                Err(error) => return Some(Err(error)),
            }
        }
        let range = (self.start.min(self.lines.line().len()), (self.start + width).min(self.lines.line().len()));
        self.start += width;
        self.left -= 1;
        Some(Ok(range))
    }

    fn whole_number(&mut self) -> Option<Result<u64>> {
        let (from, to) = match self.next()? {
            Ok(range) => range,
            Err(error) => return Some(Err(error)),
        };
        Some(self.lines.unsigned(self.lines.line()[from..to].trim_ascii(), self.what))
    }

    fn real(&mut self) -> Option<Result<f64>> {
        let (from, to) = match self.next()? {
            Ok(range) => range,
            Err(error) => return Some(Err(error)),
        };
        Some(self.lines.real(self.lines.line()[from..to].trim_ascii(), self.what))
    }
}

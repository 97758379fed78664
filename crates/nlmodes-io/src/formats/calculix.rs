//! `.sti` and `.mas` of CalculiX: lines `row column value`, counted from 1, upper triangle column by column, the diagonal last in each.

use std::path::Path;

use super::check_order;
use crate::build::{EntryBuilder, Fault, MAX_ORDER, Pass, Triangles, with_lines_of_faults};
use crate::error::{Place, ReadError, Result};
use crate::lower::LowerTriangle;
use crate::text::Lines;

pub(super) fn read(path: &Path, order: Option<usize>) -> Result<LowerTriangle> {
    let name = |k: usize| (k + 1).to_string();
    with_lines_of_faults(|fault| pass(path, order, fault), |fault| ReadError::whole(path, fault.problem(name)))
}

fn pass(path: &Path, order: Option<usize>, fault: Option<Fault>) -> Result<Pass<LowerTriangle>> {
    let mut lines = Lines::open(path)?;
    let mut builder = EntryBuilder::new(Triangles::One, fault);
    let most = order.unwrap_or(MAX_ORDER as usize);
    let (mut highest, mut last) = (0, None);
    while lines.advance_whole()? {
        let mut fields = lines.fields();
        let row = lines.index(fields.word(), "row", most)?;
        let column = lines.index(fields.word(), "column", most)?;
        let value = lines.real(fields.word(), "value")?;
        lines.end(fields, "the value")?;
        builder.push(row, column, value).map_err(|fault| lines.error(fault.problem(|k| (k + 1).to_string())))?;
        highest = highest.max(row.max(column) + 1);
        last = Some((row, column));
    }
    // Zeros are written too, so that the last line is there also in a mass matrix with massless rows.
    let whole = order.unwrap_or(highest);
    if last != whole.checked_sub(1).map(|k| (k, k)) || whole == 0 {
        return Err(lines.ended(&format!("entries up to the diagonal of row {}", whole.max(1))));
    }
    let order = check_order(path, Place::File, whole as u64, order)?;
    super::check_entries(path, Place::File, order, lines.number(), None)?;
    Ok(builder.finish(order, None).map_or_else(Pass::Faulty, Pass::Read))
}

//! `.sti` and `.mas` of CalculiX: lines `row column value`, counted from 1, upper triangle column by column, the
//! diagonal last in each.

use std::path::Path;

use super::check_order;
use crate::build::{EntryBuilder, Fault, MAX_ORDER, Pass, Triangles, with_lines_of_faults};
use crate::error::{Place, ReadError, Result};
use crate::lower::LowerTriangle;
use crate::text::{Lines, unsigned};

pub(super) fn read(path: &Path, order: Option<usize>) -> Result<LowerTriangle> {
    let name = |k: usize| (k + 1).to_string();
    with_lines_of_faults(|fault| pass(path, order, fault), |fault| ReadError::whole(path, fault.problem(name)))
}

fn pass(path: &Path, order: Option<usize>, fault: Option<Fault>) -> Result<Pass<LowerTriangle>> {
    let mut lines = Lines::open(path)?;
    let mut builder = EntryBuilder::new(Triangles::One, fault);
    let (mut highest, mut last) = (0, None);
    while lines.advance_whole()? {
        let mut fields = lines.fields();
        let row = index(&lines, fields.word(), "row", order)?;
        let column = index(&lines, fields.word(), "column", order)?;
        let value = lines.real(fields.word(), "value")?;
        lines.end(fields, "the value")?;
        builder.push(row, column, value).map_err(|fault| lines.error(fault.problem(|k| (k + 1).to_string())))?;
        highest = highest.max(row.max(column) + 1);
        last = Some((row, column));
    }
    // Zeros are written too, so that the last line is there also in a mass matrix with massless rows.
    let whole = order.unwrap_or(highest);
    if last != whole.checked_sub(1).map(|k| (k, k)) || whole == 0 {
        let named = if order.is_some() { ", as many as the table of degrees of freedom has" } else { "" };
        return Err(lines.ended(&format!("entries up to the diagonal of row {}{named}", whole.max(1))));
    }
    let order = check_order(path, Place::File, whole as u64, order)?;
    super::check_entries(path, Place::File, order, lines.number(), None)?;
    Ok(builder.finish(order, None).map_or_else(Pass::Faulty, Pass::Read))
}

/// A row or column, which must be one of the table of degrees of freedom where that is known.
fn index(lines: &Lines, field: &[u8], what: &str, order: Option<usize>) -> Result<usize> {
    let most = order.unwrap_or(MAX_ORDER as usize);
    let beyond = unsigned(field).is_some_and(|found| found > most as u64);
    if let (Some(order), true) = (order, beyond) {
        let expected = format!(
            "a {what} from 1 to {order}, as many as the table of degrees of freedom has: .dof, .sti and .mas of one \
                run belong together (those of a cyclic \
             sector with a nodal diameter are complex, with twice the rows, and cannot be used)"
        );
        return Err(lines.expected(expected, field));
    }
    lines.index(field, what, most)
}

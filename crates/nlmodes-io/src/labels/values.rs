//! Comma-separated `node,component,value`.

use std::collections::HashMap;
use std::path::Path;

use super::{DofLabel, repeated, table};
use crate::error::Result;
use crate::text::{Lines, commas, unsigned};

/// A quantity of nodes, as `force_n` or `displacement_m`: values of degrees of freedom, each at most once, in the order
/// of a table `node,component,<quantity>`, with or without that heading.
///
/// # Errors
/// [`ReadError`](crate::ReadError): another number of columns, another heading, a value that is not finite, a degree of
/// freedom that comes twice, an empty table.
pub fn read_nodal_values(path: &Path, quantity: &'static str) -> Result<Vec<(DofLabel, f64)>> {
    let mut lines = Lines::open(path)?;
    let (mut values, mut known) = (Vec::new(), HashMap::new());
    let expected = format!("node,component,{quantity}");
    while lines.advance()? {
        if lines.line().trim_ascii().is_empty() || lines.line().starts_with(b"#") {
            continue;
        }
        let fields: Vec<&[u8]> = commas(lines.line()).collect();
        let [node, component, value] = fields[..] else { return Err(lines.expected(expected, lines.line())) };
        if values.is_empty() && unsigned(node).is_none() {
            table::check_heading(&lines, &fields, &["node", "component", quantity])?;
            continue;
        }
        let node = lines.unsigned(node, "number of the node")?;
        let label = DofLabel { node, component: table::component(&lines, component)? };
        if let Some(before) = known.insert(label, lines.number()) {
            return Err(lines.error(repeated(label, before)));
        }
        values.push((label, lines.real(value, quantity)?));
    }
    if values.is_empty() {
        return Err(lines.ended(&format!("a line {expected}")));
    }
    Ok(values)
}

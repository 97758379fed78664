//! `.mapping` of Ansys: equation, node and name of the direction, below a heading.

use std::path::Path;

use super::{Component, Distinct, DofLabel, LabelTable, repeated};
use crate::error::Result;
use crate::text::{Lines, unsigned};

pub(super) fn read(path: &Path) -> Result<LabelTable> {
    let mut lines = Lines::open(path)?;
    let mut labels = Distinct::default();
    let mut equation = 0;
    while lines.advance_whole()? {
        let mut fields = lines.fields();
        let first = fields.word();
        if first.is_empty() || (equation == 0 && unsigned(first).is_none()) {
            continue; // the heading, and empty lines
        }
        equation += 1;
        if unsigned(first) != Some(equation) {
            return Err(lines.expected(format!("equation {equation}"), first));
        }
        let node = lines.unsigned(fields.word(), "number of the node")?;
        let name = fields.word();
        let component = std::str::from_utf8(name).ok().filter(|n| unsigned(n.as_bytes()).is_none());
        let component = component.and_then(Component::from_name).ok_or_else(|| {
            lines.expected("a direction UX, UY, UZ, ROTX, ROTY or ROTZ (other fields have no contacts)", name)
        })?;
        lines.end(fields, "the direction")?;
        let label = DofLabel { node, component };
        if let Some(before) = labels.push(label, lines.number()) {
            return Err(lines.error(repeated(label, before)));
        }
    }
    if equation == 0 {
        return Err(lines.ended("equation 1, its node and its direction"));
    }
    Ok(LabelTable { labels: labels.finish(), ..LabelTable::default() })
}

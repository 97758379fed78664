//! `.dof` of CalculiX: line i is `node.direction` of row i.

use std::collections::HashMap;
use std::path::Path;

use super::{Component, DofLabel, LabelTable, RepeatedLabel};
use crate::error::Result;
use crate::text::{Lines, unsigned};

/// `node.direction` is two whole numbers with a point between them and no decimal fraction: 10.1 and 10.10 would be one
/// number.
pub(super) fn read(path: &Path) -> Result<LabelTable> {
    let mut lines = Lines::open(path)?;
    let (mut labels, mut lines_of, mut repeated) = (Vec::new(), HashMap::new(), None);
    while lines.advance_whole()? {
        let field = lines.line().trim_ascii();
        let label =
            split(field).ok_or_else(|| lines.expected("`node.direction` with a direction from 1 to 6", field))?;
        let line = lines.number();
        let before = *lines_of.entry(label).or_insert(line);
        if before != line {
            repeated.get_or_insert(RepeatedLabel { label, line, before });
        }
        labels.push(label);
    }
    Ok(LabelTable { labels, repeated, ..LabelTable::default() })
}

fn split(field: &[u8]) -> Option<DofLabel> {
    let point = field.iter().position(|b| *b == b'.')?;
    let node = unsigned(&field[..point]).filter(|node| *node > 0)?;
    let component = Component::from_number(unsigned(&field[point + 1..]).filter(|_| field.len() == point + 2)?)?;
    Some(DofLabel { node, component })
}

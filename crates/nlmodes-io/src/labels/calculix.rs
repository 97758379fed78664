//! `.dof` of CalculiX: line i is `node.direction` of row i.

use std::path::Path;

use super::{Component, Distinct, DofLabel, LabelTable, found_again};
use crate::error::{Problem, Result};
use crate::text::{Lines, unsigned};

/// `node.direction` is two whole numbers with a point between them and no decimal fraction: 10.1 and 10.10 would be one
/// number.
pub(super) fn read(path: &Path) -> Result<LabelTable> {
    let mut lines = Lines::open(path)?;
    let mut labels = Distinct::default();
    while lines.advance_whole()? {
        let field = lines.line().trim_ascii();
        let label =
            split(field).ok_or_else(|| lines.expected("`node.direction` with a direction from 1 to 6", field))?;
        if let Some(before) = labels.push(label, lines.number()) {
            return Err(lines.error(expanded(label, before)));
        }
    }
    Ok(LabelTable { labels: labels.finish(), ..LabelTable::default() })
}

fn split(field: &[u8]) -> Option<DofLabel> {
    let point = field.iter().position(|b| *b == b'.')?;
    let node = unsigned(&field[..point]).filter(|node| *node > 0)?;
    let component = Component::from_number(unsigned(&field[point + 1..]).filter(|_| field.len() == point + 2)?)?;
    Some(DofLabel { node, component })
}

/// What has the rows of a node several times.
fn expanded(label: DofLabel, line: u64) -> Problem {
    Problem::Expected {
        expected: "each node and direction once (CalculiX expands shells and beams, as S4, S8R, B31, B32R, into solids, whose rows no longer tell nodes apart: use solid \
                   elements)"
            .into(),
        found: found_again(label, line),
    }
}

//! Tables `node_a,node_b[,nx,ny,nz,gap_m]`.

use std::path::Path;

use crate::error::Result;
use crate::text::{Lines, commas};

/// A line of the table.
pub(super) struct Pair {
    pub(super) a: u64,
    pub(super) b: u64,
    /// Direction from a to b, and the clearance in m.
    pub(super) normal_and_gap: Option<([f64; 3], f64)>,
}

pub(super) fn read(path: &Path) -> Result<Vec<Pair>> {
    let mut lines = Lines::open(path)?;
    let mut pairs = Vec::new();
    while lines.advance()? {
        let fields: Vec<&[u8]> = commas(lines.line()).collect();
        if fields.is_empty() || (lines.number() == 1 && fields[0] == b"node_a") {
            continue;
        }
        let normal_and_gap = match fields[..] {
            [_, _] => None,
            [_, _, x, y, z, gap] => {
                let number = |field| lines.real(field, "part of the normal");
                Some(([number(x)?, number(y)?, number(z)?], lines.real(gap, "gap")?))
            }
            _ => return Err(lines.expected("node_a,node_b or node_a,node_b,nx,ny,nz,gap_m", lines.line())),
        };
        let (a, b) = (lines.unsigned(fields[0], "number of a node")?, lines.unsigned(fields[1], "number of a node")?);
        pairs.push(Pair { a, b, normal_and_gap });
    }
    if pairs.is_empty() {
        return Err(lines.ended("a line node_a,node_b"));
    }
    Ok(pairs)
}

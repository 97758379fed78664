use std::collections::HashMap;

use super::{File, Group};
use crate::error::Result;
use crate::text::signed;

/// Physical groups of each entity, named by dimension and number.
pub(super) type Groups = HashMap<Group, Vec<Group>>;

/// Points have three coordinates before their groups, the others six.
pub(super) fn entities(file: &mut File) -> Result<Groups> {
    let counts = file.numbers("the numbers of points, curves, surfaces and volumes")?;
    if counts.len() != 4 {
        return Err(file.lines.expected("the numbers of points, curves, surfaces and volumes", file.lines.line()));
    }
    let mut groups = Groups::new();
    for (dimension, count) in counts.iter().enumerate() {
        for _ in 0..*count {
            file.lines.need("an entity")?;
            let fields: Vec<&[u8]> = file.lines.fields().collect();
            let at = if dimension == 0 { 4 } else { 7 };
            let integer = |k: usize| {
                let field = fields.get(k).copied().unwrap_or_default();
                signed(field).ok_or_else(|| file.lines.expected("an entity with its physical groups", field))
            };
            let number = integer(0)?;
            let n_groups = usize::try_from(integer(at)?).unwrap_or(0);
            if n_groups > fields.len() {
                return Err(file.lines.expected(format!("{n_groups} physical groups"), file.lines.line()));
            }
            let dimension = dimension as u64;
            let of: Vec<Group> =
                (0..n_groups).map(|k| Ok((dimension, integer(at + 1 + k)?.abs()))).collect::<Result<_>>()?;
            groups.insert((dimension, number), of);
        }
    }
    Ok(groups)
}

/// Four numbers at the head of a section or block.
fn four(file: &mut File, what: &str) -> Result<[i64; 4]> {
    let numbers = file.numbers(what)?;
    <[i64; 4]>::try_from(numbers).map_err(|_| file.lines.expected(what, file.lines.line()))
}

pub(super) fn nodes(file: &mut File) -> Result<()> {
    let [blocks, ..] = four(file, "the numbers of blocks and nodes, the smallest and largest node")?;
    for _ in 0..blocks {
        let [.., count] = four(file, "dimension, entity, parametric, number of nodes of a block")?;
        let mut numbers = Vec::new();
        for _ in 0..count {
            let line = file.numbers("the number of a node")?;
            match line[..] {
                [number] => numbers.push(number),
                _ => return Err(file.lines.expected("the number of a node", file.lines.line())),
            }
        }
        for number in numbers {
            file.lines.need("the coordinates of a node")?;
            let fields: Vec<&[u8]> = file.lines.fields().collect();
            let place = file.place(&fields)?;
            file.node(number, place)?;
        }
    }
    Ok(())
}

pub(super) fn elements(file: &mut File, groups: &Groups) -> Result<()> {
    let [blocks, ..] = four(file, "the numbers of blocks and elements, the smallest and largest element")?;
    for _ in 0..blocks {
        let [dimension, entity, kind, count] = four(file, "dimension, entity, type and number of elements of a block")?;
        let kind = file.element_type(kind)?;
        let entity = (u64::try_from(dimension).unwrap_or(u64::MAX), entity);
        let of = groups.get(&entity).cloned().unwrap_or_default();
        for _ in 0..count {
            let numbers = file.numbers("an element and its nodes")?;
            let [number, nodes @ ..] = numbers.as_slice() else {
                return Err(file.lines.expected("an element and its nodes", file.lines.line()));
            };
            file.element(*number, kind, nodes, &of)?;
        }
    }
    Ok(())
}

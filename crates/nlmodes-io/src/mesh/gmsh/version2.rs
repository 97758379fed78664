use super::{File, Group};
use crate::error::Result;
use crate::mesh::ElementKind;
use crate::text::signed;

fn count(file: &mut File, what: &str) -> Result<i64> {
    match file.numbers(what)?[..] {
        [count] => Ok(count),
        _ => Err(file.lines.expected(what, file.lines.line())),
    }
}

pub(super) fn nodes(file: &mut File) -> Result<()> {
    for _ in 0..count(file, "the number of nodes")? {
        file.lines.need("a node: number, x, y, z")?;
        let fields: Vec<&[u8]> = file.lines.fields().collect();
        let number = fields.first().and_then(|field| signed(field));
        let number = number.ok_or_else(|| file.lines.expected("a node: number, x, y, z", file.lines.line()))?;
        let place = file.place(&fields[1..])?;
        file.node(number, place)?;
    }
    Ok(())
}

/// `number type tags…`: the first tag is the physical group.
pub(super) fn elements(file: &mut File) -> Result<()> {
    for _ in 0..count(file, "the number of elements")? {
        let numbers = file.numbers("an element: number, type, number of tags, tags, nodes")?;
        let parts = match numbers.as_slice() {
            [number, kind, tags, rest @ ..] => usize::try_from(*tags)
                .ok()
                .filter(|tags| *tags <= rest.len())
                .map(|tags| (*number, *kind, rest.split_at(tags))),
            _ => None,
        };
        let Some((number, kind, (tags, nodes))) = parts else {
            return Err(file
                .lines
                .expected("an element: number, type, number of tags, tags, nodes", file.lines.line()));
        };
        let kind = file.element_type(kind)?;
        let dimension = match kind.kind {
            None => 0,
            Some(ElementKind::Line) => 1,
            Some(kind) if kind.is_solid() => 3,
            Some(_) => 2,
        };
        let groups: Vec<Group> =
            tags.first().filter(|tag| **tag > 0).map(|tag| (dimension, *tag)).into_iter().collect();
        file.element(number, kind, nodes, &groups)?;
    }
    Ok(())
}

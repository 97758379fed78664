//! Arrays within arrays: structures and cells.

use super::element::Elements;
use super::{Head, MATRIX, head};
use crate::error::Result;
use crate::formats::matlab::{DEEPEST, MAX_ARRAYS, MatPath};

/// Classes of arrays.
const CELL: u8 = 1;
const STRUCTURE: u8 = 2;
/// Longest list of names of fields, bytes.
const FIELDS: u64 = 1 << 20;

/// What is done with an array that holds none; whether that ends the walk.
pub(super) type Visit<'v> = dyn FnMut(&MatPath, &Head, &mut Elements<'_>) -> Result<bool> + 'v;

/// Goes through a variable and all that is in it.
pub(super) struct Walk<'v> {
    pub(super) visit: &'v mut Visit<'v>,
    count: usize,
}

impl<'v> Walk<'v> {
    pub(super) fn new(visit: &'v mut Visit<'v>) -> Self {
        Self { visit, count: 0 }
    }

    /// The array that begins here; `path` is its own, or none of a variable, which has a name.
    pub(super) fn array(&mut self, elements: &mut Elements<'_>, path: Option<MatPath>, depth: usize) -> Result<bool> {
        self.count += 1;
        if self.count > MAX_ARRAYS || depth > DEEPEST {
            let expected = format!("at most {MAX_ARRAYS} arrays, at most {DEEPEST} deep");
            return Err(elements.expected("array", &expected, "more".into()));
        }
        let head = head(elements)?;
        let path = path.unwrap_or_else(|| MatPath::variable(&head.name));
        match head.class {
            CELL => self.members(elements, &path, &head, None, depth),
            STRUCTURE => {
                let names = fields(elements)?;
                self.members(elements, &path, &head, Some(&names), depth)
            }
            _ => (self.visit)(&path, &head, elements),
        }
    }

    /// The arrays in a cell, or the fields of each structure.
    fn members(
        &mut self,
        elements: &mut Elements<'_>,
        path: &MatPath,
        head: &Head,
        fields: Option<&[String]>,
        depth: usize,
    ) -> Result<bool> {
        let count = head.dimensions.iter().try_fold(1_u64, |product, length| product.checked_mul(*length));
        for index in 0..count.unwrap_or(u64::MAX) {
            let element = path.element(index, &head.dimensions, fields.is_none());
            let members = fields.map_or(1, <[String]>::len);
            for k in 0..members {
                let path = fields.map_or_else(|| element.clone(), |fields| element.field(&fields[k]));
                if self.member(elements, path, depth)? {
                    return Ok(true);
                }
            }
            if members == 0 {
                break;
            }
        }
        Ok(false)
    }

    fn member(&mut self, elements: &mut Elements<'_>, path: MatPath, depth: usize) -> Result<bool> {
        let tag = elements.tag("array in an array")?;
        if tag.kind != MATRIX {
            let found = format!("type {}", tag.kind);
            return Err(elements.expected("array in an array", "an array (type 14)", found));
        }
        self.count += 1;
        if self.count > MAX_ARRAYS {
            return Err(elements.expected("array", &format!("at most {MAX_ARRAYS} arrays"), "more".into()));
        }
        if tag.length == 0 {
            return Ok(false); // []
        }
        let end = elements.enter_for(tag.length);
        if self.array(elements, Some(path), depth + 1)? {
            return Ok(true);
        }
        elements.pass_to(end)?;
        Ok(false)
    }
}

/// Names of the fields of a structure: their length including trailing zeros, then one after the other.
fn fields(elements: &mut Elements<'_>) -> Result<Vec<String>> {
    let length = elements.small("length of names of fields", 8)?;
    let length = match *length.as_slice() {
        [a, b, c, d, ..] => elements.order().u32([a, b, c, d]) as usize,
        _ => 0,
    };
    let names = elements.small("names of fields", FIELDS)?;
    if length == 0 || !names.len().is_multiple_of(length) {
        let found = format!("{} bytes", names.len());
        return Err(elements.expected("names of fields", &format!("names of {length} bytes"), found));
    }
    let name = |bytes: &[u8]| {
        let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
        String::from_utf8_lossy(&bytes[..end]).into_owned()
    };
    Ok(names.chunks(length).map(name).collect())
}

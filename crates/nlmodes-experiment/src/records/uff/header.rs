//! Fixed-width fields of header lines.

use crate::records::uff::{Axis, Node, UffError};

/// A header line with its number.
#[derive(Debug, Clone, Copy)]
pub struct Line<'a> {
    pub bytes: &'a [u8],
    pub number: usize,
}

impl Line<'_> {
    /// Text between two columns, counted from 0, without the blanks around it.
    pub fn text(&self, first: usize, last: usize) -> String {
        let field = self.bytes.get(first..last.min(self.bytes.len())).unwrap_or_default();
        String::from_utf8_lossy(field.trim_ascii()).into_owned()
    }

    /// Whole number; an empty field is zero.
    pub fn integer(&self, first: usize, last: usize) -> Result<i64, UffError> {
        let text = self.text(first, last);
        if text.is_empty() {
            return Ok(0);
        }
        text.parse().map_err(|_| self.refuse(first, last, "a whole number"))
    }

    /// Whole number of few digits; an empty field is zero.
    pub fn small(&self, first: usize, last: usize) -> Result<i32, UffError> {
        i32::try_from(self.integer(first, last)?).map_err(|_| self.refuse(first, last, "a number of few digits"))
    }

    /// Number; an empty field is zero.
    pub fn number(&self, first: usize, last: usize) -> Result<f64, UffError> {
        let text = self.text(first, last);
        if text.is_empty() {
            return Ok(0.0);
        }
        parse(&text).ok_or_else(|| self.refuse(first, last, "a number"))
    }

    pub fn refuse(&self, first: usize, last: usize, expected: &'static str) -> UffError {
        UffError::Field { line: self.number, first: first + 1, last, text: self.text(first, last), expected }
    }

    /// Response and reference: entity, node and direction of each, from column 31 on. An entity of more than ten
    /// letters shifts the rest: words are then read one after the other.
    pub fn nodes(&self) -> Result<[Node; 2], UffError> {
        let by_columns = || Ok([self.node(31)?, self.node(56)?]);
        by_columns().or_else(|error| self.shifted_nodes().ok_or(error))
    }

    fn shifted_nodes(&self) -> Option<[Node; 2]> {
        let text = self.text(31, self.bytes.len());
        let words: Vec<&str> = text.split_whitespace().collect();
        let node = |words: &[&str]| match words {
            [entity, node, direction] => Some(Node {
                entity: (*entity).to_owned(),
                node: node.parse().ok()?,
                direction: direction.parse().ok()?,
            }),
            _ => None,
        };
        if words.len() != 6 {
            return None;
        }
        Some([node(&words[..3])?, node(&words[3..])?])
    }

    /// Entity, node and direction.
    fn node(&self, first: usize) -> Result<Node, UffError> {
        Ok(Node {
            entity: self.text(first, first + 10),
            node: self.small(first + 10, first + 20)?,
            direction: self.small(first + 20, first + 24)?,
        })
    }

    /// Axis with label and unit.
    pub fn axis(&self) -> Result<Axis, UffError> {
        Ok(Axis {
            kind: self.small(0, 10)?,
            exponents: [self.small(10, 15)?, self.small(15, 20)?, self.small(20, 25)?],
            label: self.text(26, 46),
            unit: self.text(47, 67),
        })
    }
}

/// A number as Fortran writes it.
pub fn parse(text: &str) -> Option<f64> {
    text.parse().ok().or_else(|| text.replace(['D', 'd'], "e").parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fields that are full to their last column, next to each other.
    #[test]
    fn entity_node_and_direction_end_where_the_next_begins() {
        let bytes = [&b" "[..], b"ENTITY7890", b"1234567890", b"-123", b"9"].concat();
        let found = Line { bytes: &bytes, number: 1 }.node(1).unwrap();
        assert_eq!((found.entity.as_str(), found.node, found.direction), ("ENTITY7890", 1_234_567_890, -123));
        let bytes =
            [&b"        17"[..], b"   12", b"   -2", b"    3", b" ", b"a label of twenty co", b" ", b"m/s^2"].concat();
        let found = Line { bytes: &bytes, number: 1 }.axis().unwrap();
        assert_eq!((found.kind, found.exponents), (17, [12, -2, 3]));
        assert_eq!((found.label.as_str(), found.unit.as_str()), ("a label of twenty co", "m/s^2"));
    }
}

use std::io::Read;
use std::path::Path;

use crate::error::{Place, Problem, ReadError, Result};

/// Order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    Little,
    Big,
}

impl Order {
    pub(super) fn u32(self, bytes: [u8; 4]) -> u32 {
        if self == Self::Little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) }
    }
}

/// Type and length of an element.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tag {
    pub(super) kind: u32,
    pub(super) length: u64,
    padding: u64,
}

impl Tag {
    pub(super) fn long([a, b, c, d, e, f, g, h]: [u8; 8], order: Order) -> Self {
        let length = u64::from(order.u32([e, f, g, h]));
        Self { kind: order.u32([a, b, c, d]), length, padding: length.next_multiple_of(8) - length }
    }
}

/// The elements of a variable, one after the other.
pub(super) struct Elements<'a> {
    path: &'a Path,
    bytes: Box<dyn Read + 'a>,
    order: Order,
    variable: &'a str,
    /// Bytes of the element under way, and what fills it up to a multiple of eight.
    left: u64,
    padding: u64,
    /// Bytes that have been read.
    position: u64,
}

impl<'a> Elements<'a> {
    pub(super) fn new(path: &'a Path, bytes: Box<dyn Read + 'a>, order: Order, variable: &'a str) -> Self {
        Self { path, bytes, order, variable, left: 0, padding: 0, position: 0 }
    }

    pub(super) fn order(&self) -> Order {
        self.order
    }

    pub(super) fn expected(&self, part: &str, expected: &str, found: String) -> ReadError {
        let place = Place::Part(format!("{}: {part}", self.variable));
        ReadError::new(self.path, place, Problem::Expected { expected: expected.to_owned(), found })
    }

    fn fill(&mut self, target: &mut [u8], part: &str) -> Result<()> {
        self.position += target.len() as u64;
        self.bytes.read_exact(target).map_err(|error| {
            let place = Place::Part(format!("{}: {part}", self.variable));
            let problem = match error.kind() {
                std::io::ErrorKind::UnexpectedEof => Problem::Ended { expected: "more bytes".into() },
                _ => Problem::Io(error),
            };
            ReadError::new(self.path, place, problem)
        })
    }

    /// The next element, after the rest of the previous one.
    pub(super) fn tag(&mut self, part: &str) -> Result<Tag> {
        self.pass(self.left + self.padding, part)?;
        let mut head = [0; 4];
        self.fill(&mut head, part)?;
        let word = self.order.u32(head);
        // A small element has its length in the upper half of the first word and its bytes in the second.
        let tag = if word >> 16 != 0 {
            let length = u64::from(word >> 16);
            if length > 4 {
                return Err(self.expected(part, "an element", format!("a small element of {length} bytes")));
            }
            Tag { kind: word & 0xffff, length, padding: 4 - length }
        } else {
            let mut length = [0; 4];
            self.fill(&mut length, part)?;
            let [a, b, c, d] = head;
            let [e, f, g, h] = length;
            Tag::long([a, b, c, d, e, f, g, h], self.order)
        };
        (self.left, self.padding) = (tag.length, tag.padding);
        Ok(tag)
    }

    fn pass(&mut self, rest: u64, part: &str) -> Result<()> {
        let passed = std::io::copy(&mut self.bytes.by_ref().take(rest), &mut std::io::sink());
        if passed.is_ok_and(|passed| passed < rest) {
            return Err(self.expected(part, "more bytes", "the end of the variable".into()));
        }
        self.position += rest;
        Ok(())
    }

    /// Enters the current element of `length` bytes, and returns its end.
    pub(super) fn enter_for(&mut self, length: u64) -> u64 {
        self.enter();
        self.position.saturating_add(length)
    }

    /// Skips the rest of an element that ends there.
    pub(super) fn pass_to(&mut self, end: u64) -> Result<()> {
        if self.position > end {
            let found = format!("{} bytes more", self.position - end);
            return Err(self.expected("array in an array", "an array that ends where it says", found));
        }
        self.pass(end - self.position, "array in an array")?;
        self.enter();
        Ok(())
    }

    /// Goes into the element under way: the next one is the first within it.
    pub(super) fn enter(&mut self) {
        (self.left, self.padding) = (0, 0);
    }

    /// An element of at most `most` bytes.
    pub(super) fn small(&mut self, part: &str, most: u64) -> Result<Vec<u8>> {
        let tag = self.tag(part)?;
        if tag.length > most {
            return Err(self.expected(part, &format!("at most {most} bytes"), format!("{} bytes", tag.length)));
        }
        let mut bytes = vec![0; tag.length as usize];
        self.left = 0;
        self.fill(&mut bytes, part)?;
        Ok(bytes)
    }

    /// An element of numbers.
    pub(super) fn numbers(&mut self, part: &'static str) -> Result<Numbers<'_, 'a>> {
        let tag = self.tag(part)?;
        let size = match tag.kind {
            1 | 2 => 1,
            3 | 4 => 2,
            5..=7 => 4,
            9 | 12 | 13 => 8,
            _ => return Err(self.expected(part, "an element of numbers", format!("type {}", tag.kind))),
        };
        if !tag.length.is_multiple_of(size) {
            return Err(self.expected(part, &format!("numbers of {size} bytes"), format!("{} bytes", tag.length)));
        }
        Ok(Numbers { elements: self, part, kind: tag.kind, size: size as usize })
    }
}

/// The numbers of an element: MATLAB stores them in the smallest type that holds them all.
pub(super) struct Numbers<'b, 'a> {
    elements: &'b mut Elements<'a>,
    part: &'static str,
    kind: u32,
    size: usize,
}

impl Numbers<'_, '_> {
    /// How many are left.
    pub(super) fn count(&self) -> u64 {
        self.elements.left / self.size as u64
    }

    pub(super) fn next(&mut self) -> Result<Option<f64>> {
        if self.elements.left == 0 {
            return Ok(None);
        }
        let mut bytes = [0; 8];
        self.elements.fill(&mut bytes[..self.size], self.part)?;
        self.elements.left -= self.size as u64;
        if self.elements.order == Order::Big {
            bytes[..self.size].reverse();
        }
        let [a, b, c, d, ..] = bytes;
        Ok(Some(match self.kind {
            1 => f64::from(a as i8),
            2 => f64::from(a),
            3 => f64::from(i16::from_le_bytes([a, b])),
            4 => f64::from(u16::from_le_bytes([a, b])),
            5 => f64::from(i32::from_le_bytes([a, b, c, d])),
            6 => f64::from(u32::from_le_bytes([a, b, c, d])),
            7 => f64::from(f32::from_le_bytes([a, b, c, d])),
            12 => i64::from_le_bytes(bytes) as f64,
            13 => u64::from_le_bytes(bytes) as f64,
            _ => f64::from_le_bytes(bytes),
        }))
    }

    /// The next one, which must be a whole number from 0 on.
    pub(super) fn whole(&mut self) -> Result<Option<u64>> {
        const MOST: f64 = 9_007_199_254_740_992.0;
        match self.next()? {
            None => Ok(None),
            Some(value) if (0.0..MOST).contains(&value) && value.fract() == 0.0 => Ok(Some(value as u64)),
            Some(value) => Err(self.elements.expected(self.part, "whole numbers from 0 on", value.to_string())),
        }
    }
}

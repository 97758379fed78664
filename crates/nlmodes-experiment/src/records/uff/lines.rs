//! A file line by line, possibly with binary numbers between the lines.

/// A place in the bytes of a file.
#[derive(Debug, Clone)]
pub struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Number of the next line, from 1; binary numbers count as the line they begin in.
    pub number: usize,
}

impl<'a> Lines<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, number: 1 }
    }

    /// The next line without its end (LF or CR LF); `None` at the end of the file.
    pub fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        if rest.is_empty() {
            return None;
        }
        let length = rest.iter().position(|byte| *byte == b'\n');
        let line = &rest[..length.unwrap_or(rest.len())];
        self.at += length.map_or(rest.len(), |length| length + 1);
        self.number += 1;
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }

    /// What is left.
    pub fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// Passes over bytes.
    pub fn skip(&mut self, n: usize) {
        self.at = (self.at + n).min(self.bytes.len());
    }
}

/// Whether a line is the mark between datasets.
pub fn is_mark(line: &[u8]) -> bool {
    line.trim_ascii() == b"-1"
}

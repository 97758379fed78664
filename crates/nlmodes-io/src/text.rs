//! Lines of text files, plain or packed with gzip, and the numbers in them.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use flate2::bufread::MultiGzDecoder;

use crate::Address;
use crate::error::{Place, Problem, ReadError, Result, shown};

/// Longest line that is read, bytes.
const MAX_LINE: u64 = 1 << 16;
const BUFFER: usize = 1 << 17;

/// Opens a file, unpacked if it begins as gzip files do.
pub(crate) fn open(path: &Path) -> Result<Box<dyn BufRead>> {
    let failed = |error| ReadError::whole(path, unreadable(path, error));
    if path.is_dir() {
        let found = "a directory".to_owned();
        return Err(ReadError::whole(path, Problem::Expected { expected: "a file".into(), found }));
    }
    let mut file = BufReader::with_capacity(BUFFER, File::open(path).map_err(failed)?);
    let packed = file.fill_buf().map_err(failed)?.starts_with(&[0x1f, 0x8b]);
    Ok(if packed { Box::new(BufReader::with_capacity(BUFFER, MultiGzDecoder::new(file))) } else { Box::new(file) })
}

/// Why a file cannot be opened, and what writes it where it is not there.
fn unreadable(path: &Path, error: io::Error) -> Problem {
    let ending = Address { path: path.to_owned(), name: None }.ending();
    match (error.kind(), ending.as_str()) {
        (io::ErrorKind::NotFound, "sti" | "mas" | "dof") => Problem::NotWritten {
            error,
            writer: "CalculiX writes .sti, .mas and .dof where the step has *FREQUENCY, SOLVER=MATRIXSTORAGE",
        },
        _ => Problem::Io(error),
    }
}

/// The lines of a file, one at a time.
pub(crate) struct Lines {
    path: PathBuf,
    input: Box<dyn BufRead>,
    line: Vec<u8>,
    number: u64,
    complete: bool,
}

impl Lines {
    pub(crate) fn open(path: &Path) -> Result<Self> {
        Ok(Self { path: path.to_owned(), input: open(path)?, line: Vec::new(), number: 0, complete: true })
    }

    /// Goes on to the next line; false at the end of the file.
    pub(crate) fn advance(&mut self) -> Result<bool> {
        self.line.clear();
        let read = self.input.by_ref().take(MAX_LINE).read_until(b'\n', &mut self.line);
        let length = read.map_err(|error| self.error_after(Problem::Io(error)))?;
        if length == 0 {
            return Ok(false);
        }
        self.number += 1;
        self.complete = self.line.ends_with(b"\n");
        if !self.complete && length as u64 == MAX_LINE {
            return Err(self.error(Problem::TooLarge {
                what: "bytes of a line",
                found: MAX_LINE,
                limit: MAX_LINE - 1,
            }));
        }
        let end = self.line.iter().rposition(|b| *b != b'\n' && *b != b'\r').map_or(0, |last| last + 1);
        self.line.truncate(end);
        Ok(true)
    }

    /// As [`advance`](Self::advance), of a file that a program wrote: a last line without an end is one that was cut
    /// off, and a number in it could be another.
    pub(crate) fn advance_whole(&mut self) -> Result<bool> {
        let more = self.advance()?;
        if more && !self.complete {
            return Err(self.error(Problem::Ended { expected: "the end of the line".into() }));
        }
        Ok(more)
    }

    /// The next line, which must be there.
    pub(crate) fn need(&mut self, expected: &str) -> Result<()> {
        if self.advance_whole()? { Ok(()) } else { Err(self.ended(expected)) }
    }

    /// The line, without its end.
    pub(crate) fn line(&self) -> &[u8] {
        &self.line
    }

    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn fields(&self) -> Fields<'_> {
        Fields(&self.line)
    }

    /// An error in this line.
    pub(crate) fn error(&self, problem: Problem) -> ReadError {
        ReadError::new(&self.path, Place::Line(self.number), problem)
    }

    fn error_after(&self, problem: Problem) -> ReadError {
        ReadError::new(&self.path, Place::Line(self.number + 1), problem)
    }

    pub(crate) fn ended(&self, expected: &str) -> ReadError {
        self.error_after(Problem::Ended { expected: expected.to_owned() })
    }

    pub(crate) fn expected(&self, expected: impl Into<String>, found: &[u8]) -> ReadError {
        self.error(Problem::Expected { expected: expected.into(), found: shown(found) })
    }

    /// A number from 1 to `most`, as an index from 0.
    pub(crate) fn index(&self, field: &[u8], what: &str, most: usize) -> Result<usize> {
        match unsigned(field) {
            Some(k) if k >= 1 && k <= most as u64 => Ok((k - 1) as usize),
            _ => Err(self.expected(format!("a {what} from 1 to {most}"), field)),
        }
    }

    pub(crate) fn unsigned(&self, field: &[u8], what: &str) -> Result<u64> {
        unsigned(field).ok_or_else(|| self.expected(format!("a whole number, the {what}"), field))
    }

    /// A finite number.
    pub(crate) fn real(&self, field: &[u8], what: &'static str) -> Result<f64> {
        match real(field) {
            Some(value) if value.is_finite() => Ok(value),
            Some(_) => Err(self.error(Problem::NotFinite { what, found: String::from_utf8_lossy(field).into_owned() })),
            None => Err(self.expected(format!("a number, the {what}"), field)),
        }
    }

    /// Nothing may follow in this line.
    pub(crate) fn end(&self, mut fields: Fields<'_>, after: &str) -> Result<()> {
        match fields.next() {
            None => Ok(()),
            Some(more) => Err(self.expected(format!("the end of the line after {after}"), more)),
        }
    }
}

/// Fields between blanks.
#[derive(Clone, Copy)]
pub(crate) struct Fields<'a>(pub(crate) &'a [u8]);

impl<'a> Iterator for Fields<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let start = self.0.iter().position(|b| !b.is_ascii_whitespace())?;
        let rest = &self.0[start..];
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.0 = &rest[end..];
        Some(&rest[..end])
    }
}

impl<'a> Fields<'a> {
    /// The next field, or an empty one.
    pub(crate) fn word(&mut self) -> &'a [u8] {
        self.next().unwrap_or_default()
    }
}

/// Fields between commas, without the blanks around them; a comma at the end opens no field.
pub(crate) fn commas(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    let line = line.trim_ascii();
    let line = line.strip_suffix(b",").unwrap_or(line);
    let fields = (!line.is_empty()).then(|| line.split(|b| *b == b','));
    fields.into_iter().flatten().map(<[u8]>::trim_ascii)
}

/// Digits only, below 2⁶³.
pub(crate) fn unsigned(field: &[u8]) -> Option<u64> {
    if field.is_empty() || field.len() > 18 {
        return None;
    }
    field.iter().try_fold(0_u64, |sum, b| b.is_ascii_digit().then(|| sum * 10 + u64::from(b - b'0')))
}

/// Digits with a sign, if any.
pub(crate) fn signed(field: &[u8]) -> Option<i64> {
    match field.split_first()? {
        (b'-', digits) => Some(-(unsigned(digits)? as i64)),
        (b'+', digits) => Some(unsigned(digits)? as i64),
        _ => Some(unsigned(field)? as i64),
    }
}

/// A number as C and Fortran write it: the exponent with `e`, `d`, or its sign alone.
pub(crate) fn real(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(field).ok()?;
    match text.parse() {
        Ok(value) => Some(value),
        Err(_) => fortran(field),
    }
}

/// `1.5D+05`, `3.+5`, `-1.2-3`.
fn fortran(field: &[u8]) -> Option<f64> {
    const LONGEST: usize = 64;
    if field.len() > LONGEST {
        return None;
    }
    let mantissa = field.iter().skip(1).position(|b| matches!(b, b'd' | b'D' | b'+' | b'-' | b'e' | b'E'))? + 1;
    let (digits, exponent) = field.split_at(mantissa);
    let exponent = exponent.strip_prefix(b"d").or_else(|| exponent.strip_prefix(b"D")).unwrap_or(exponent);
    if !digits.last().is_some_and(|b| b.is_ascii_digit() || *b == b'.') || signed(exponent).is_none() {
        return None;
    }
    format!("{}e{}", std::str::from_utf8(digits).ok()?, std::str::from_utf8(exponent).ok()?).parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_c_and_fortran_are_read() {
        let cases: [(&[u8], f64); 9] = [
            (b"1.5", 1.5),
            (b"-2.e+05", -2e5),
            (b"1.5D+05", 1.5e5),
            (b"1.5d-05", 1.5e-5),
            (b"3.+5", 3e5),
            (b"-1.25-3", -1.25e-3),
            (b".5+1", 5.0),
            (b"+7", 7.0),
            (b"8.4059829059829e+05", 840598.29059829),
        ];
        for (text, value) in cases {
            assert_eq!(real(text), Some(value), "{}", String::from_utf8_lossy(text));
        }
        for text in ["", "-", "1.5e", "1.5D", "1.5+", "x", "1.2.3", "1e5e5", "--1", "1,5", "0x10", "1.5D+5D"] {
            assert_eq!(real(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn whole_numbers_keep_to_their_digits() {
        assert_eq!((unsigned(b"007"), unsigned(b"-1"), unsigned(b"1.0"), unsigned(b"")), (Some(7), None, None, None));
        assert_eq!(unsigned(b"99999999999999999999"), None);
        assert_eq!((signed(b"-12"), signed(b"+3"), signed(b"-")), (Some(-12), Some(3), None));
    }

    #[test]
    fn fields_are_split_at_blanks_and_commas() {
        assert_eq!(Fields(b"  1\t22  x ").collect::<Vec<_>>(), [&b"1"[..], b"22", b"x"]);
        assert_eq!(commas(b" 1, 2 ,,3,").collect::<Vec<_>>(), [&b"1"[..], b"2", b"", b"3"]);
        assert_eq!(commas(b"  ").count(), 0);
    }
}

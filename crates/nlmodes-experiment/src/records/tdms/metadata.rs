//! What a segment says of its objects.

use std::io::Read;

use super::layout::{ByteOrder, DataType, Index, Layout, Scaler};
use super::{cursor, some_bytes, wrong};
use crate::records::RecordError;

/// Bytes of a lead-in.
const LEAD_IN: u64 = 28;
/// Most bytes of the description of a segment's objects.
const MAX_METADATA: u64 = 1 << 28;
/// What a file says of a segment that was never finished: it goes to the end of the file.
const UNFINISHED: u64 = u64::MAX;
/// The beginning of the index of a device's numbers.
const DAQMX: u32 = 0x1269;
/// That of its digital lines.
const DIGITAL: u32 = 0x126A;

/// A segment: where its numbers are, and what it says of its objects.
pub struct Segment {
    pub order: ByteOrder,
    pub renews_objects: bool,
    pub has_data: bool,
    pub layout: Layout,
    /// First byte of the numbers.
    pub data: u64,
    /// First byte of the next segment.
    pub end: u64,
    pub objects: Vec<Object>,
}

/// An object of a segment.
pub struct Object {
    pub path: String,
    pub index: RawIndex,
    pub properties: Vec<(String, Property)>,
}

/// How the numbers of an object are laid out in a segment.
pub enum RawIndex {
    None,
    AsBefore,
    New(Index),
}

/// The value of a property.
#[derive(Debug, Clone, PartialEq)]
pub enum Property {
    Number(f64),
    Text(String),
    /// A time stamp, or what is no number.
    Other,
}

impl Property {
    pub fn number(&self) -> Option<f64> {
        if let Self::Number(x) = self { Some(*x) } else { None }
    }

    pub fn text(&self) -> Option<&str> {
        if let Self::Text(text) = self { Some(text) } else { None }
    }
}

/// Bytes of which numbers are taken one after the other; `byte` is the place of the first in the file.
pub struct Cursor<'a> {
    pub bytes: &'a [u8],
    pub at: usize,
    pub order: ByteOrder,
    pub byte: u64,
}

impl Cursor<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], RecordError> {
        let next = self.bytes.get(self.at..).and_then(|rest| rest.first_chunk::<N>()).copied();
        self.at += N;
        next.map_or_else(|| wrong(self.place(), "the description of the objects ends too early"), Ok)
    }

    fn place(&self) -> u64 {
        self.byte + self.at as u64
    }

    pub fn u32(&mut self) -> Result<u32, RecordError> {
        let bytes = self.take()?;
        Ok(if self.order == ByteOrder::Little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
    }

    pub fn u64(&mut self) -> Result<u64, RecordError> {
        let bytes = self.take()?;
        Ok(if self.order == ByteOrder::Little { u64::from_le_bytes(bytes) } else { u64::from_be_bytes(bytes) })
    }

    fn text(&mut self) -> Result<String, RecordError> {
        let (length, place) = (self.u32()? as usize, self.place());
        let Some(bytes) = self.bytes.get(self.at..).and_then(|rest| rest.get(..length)) else {
            return wrong(place, format!("a text of {length} bytes ends behind the description of the objects"));
        };
        self.at += length;
        Ok(String::from_utf8_lossy(bytes).into_owned())
    }

    fn property(&mut self) -> Result<(String, Property), RecordError> {
        let (name, place) = (self.text()?, self.place());
        let kind = self.u32()?;
        let value = match kind {
            0x20 => Property::Text(self.text()?),
            0x44 => {
                self.take::<16>()?;
                Property::Other
            }
            0x21 => Property::Number(f64::from(self.take::<1>()?[0])),
            _ => {
                let Some(number) = DataType::of(kind) else {
                    return wrong(place, format!("the property \"{name}\" is of the unknown type 0x{kind:X}"));
                };
                let mut bytes = [0; 8];
                for byte in &mut bytes[..number.size()] {
                    [*byte] = self.take::<1>()?;
                }
                Property::Number(number.value(&bytes[..number.size()], self.order))
            }
        };
        Ok((name, value))
    }

    fn index(&mut self) -> Result<RawIndex, RecordError> {
        let place = self.place();
        let first = self.u32()?;
        if first == u32::MAX {
            return Ok(RawIndex::None);
        }
        if first == 0 {
            return Ok(RawIndex::AsBefore);
        }
        if first == DIGITAL {
            return wrong(place, "a digital line of a device: export it as a channel of numbers");
        }
        let kind = self.u32()?;
        let (dimension, count) = (self.u32()?, self.u64()?);
        if dimension != 1 {
            return wrong(place, format!("the numbers of a channel have {dimension} dimensions, expected 1"));
        }
        if first == DAQMX {
            return Ok(RawIndex::New(self.daqmx(count, place)?));
        }
        if kind == 0x20 {
            self.u64()?;
            return Ok(RawIndex::None);
        }
        match DataType::of(kind) {
            Some(of) => Ok(RawIndex::New(Index::Plain { of, count })),
            None if kind == 0x44 => wrong(place, "a channel of time stamps: export its numbers without it"),
            None => wrong(place, format!("the numbers of a channel are of the unknown type 0x{kind:X}")),
        }
    }

    /// Scalers of one channel, and the widths of the buffers of a device.
    fn daqmx(&mut self, count: u64, place: u64) -> Result<Index, RecordError> {
        let mut scalers = Vec::new();
        for _ in 0..self.u32()? {
            let (kind, buffer, offset) = (self.u32()?, self.u32()? as usize, self.u32()? as usize);
            let (_, scale) = (self.u32()?, self.u32()?);
            let Some(of) = DataType::of_daqmx(kind) else {
                return wrong(place, format!("a device gives numbers of the unknown type {kind}"));
            };
            scalers.push(Scaler { of, buffer, offset, scale });
        }
        let n_buffers = self.u32()?;
        let widths = (0..n_buffers).map(|_| Ok(self.u32()? as usize)).collect::<Result<Vec<_>, RecordError>>()?;
        let Some(scaler) = scalers.first().cloned() else {
            return wrong(place, "a channel of a device without a scaler");
        };
        Ok(Index::Device { scaler, widths, count })
    }
}

impl Segment {
    /// The segment that begins at this byte, of a file of so many.
    pub fn read(source: &mut impl Read, at: u64, length: u64) -> Result<Self, RecordError> {
        let lead = some_bytes(source, LEAD_IN, at)?;
        if !lead.starts_with(b"TDSm") {
            return wrong(at, "a segment does not begin with TDSm; is this a TDMS file?");
        }
        let contents = cursor(&lead[4..], ByteOrder::Little, at + 4).u32()?;
        let has = |bit: u32| contents & (1 << bit) != 0;
        let order = if has(6) { ByteOrder::Big } else { ByteOrder::Little };
        let mut rest = cursor(&lead[12..], order, at + 12);
        let (next, raw) = (rest.u64()?, rest.u64()?);
        let begin = at + LEAD_IN;
        let end = if next == UNFINISHED { Some(length) } else { begin.checked_add(next).filter(|end| *end <= length) };
        let data = begin.checked_add(raw);
        let (Some(end), Some(data)) = (end, data) else {
            return wrong(at, format!("a segment of {next} bytes in a file of {length}: it was cut off"));
        };
        if data > end || raw > MAX_METADATA {
            return wrong(at, format!("the description of its objects has {raw} bytes"));
        }
        let bytes = some_bytes(source, raw, begin)?;
        let mut cursor = cursor(&bytes, order, begin);
        let objects = if has(1) { objects(&mut cursor)? } else { vec![] };
        let layout = match (has(7), has(5)) {
            (true, _) => Layout::Device,
            (_, true) => Layout::Interleaved,
            _ => Layout::Contiguous,
        };
        Ok(Self { order, renews_objects: has(2), has_data: has(3), layout, data, end, objects })
    }
}

fn objects(cursor: &mut Cursor<'_>) -> Result<Vec<Object>, RecordError> {
    let count = cursor.u32()?;
    let mut objects = Vec::new();
    for _ in 0..count {
        let (path, index) = (cursor.text()?, cursor.index()?);
        let n_properties = cursor.u32()?;
        let properties = (0..n_properties).map(|_| cursor.property()).collect::<Result<Vec<_>, _>>()?;
        objects.push(Object { path, index, properties });
    }
    Ok(objects)
}

/// The names in a path: `/'group'/'channel'`, with doubled quotation marks within.
pub fn parts(path: &str) -> Vec<String> {
    let mut parts = Vec::new();
    let mut rest = path;
    while let Some(begin) = rest.find('\'') {
        rest = &rest[begin + 1..];
        let mut name = String::new();
        while let Some(end) = rest.find('\'') {
            name += &rest[..end];
            rest = &rest[end + 1..];
            if !rest.starts_with('\'') {
                break;
            }
            name.push('\'');
            rest = &rest[1..];
        }
        parts.push(name);
    }
    if parts.is_empty() { vec![path.to_owned()] } else { parts }
}

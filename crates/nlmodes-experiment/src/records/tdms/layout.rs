//! Where the numbers of a segment lie.

use std::io::{Read, Seek, SeekFrom};

use super::{some_bytes, wrong};
use crate::records::RecordError;

/// Bytes of numbers that are in memory at once.
const BUFFER: u64 = 1 << 22;

/// Order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ByteOrder {
    Little,
    Big,
}

/// Order of the numbers of a segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// One channel after the other.
    Contiguous,
    /// A number of each channel, again and again.
    Interleaved,
    /// As a device delivers them.
    Device,
}

/// Type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DataType {
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
    F32,
    F64,
}

impl DataType {
    /// By its number in a file.
    pub fn of(kind: u32) -> Option<Self> {
        use DataType::{F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};
        let plain = [I8, I16, I32, I64, U8, U16, U32, U64, F32, F64];
        // With a unit they are the same.
        match kind {
            1..=10 => plain.get(kind as usize - 1).copied(),
            0x19 => Some(F32),
            0x1A => Some(F64),
            0x21 => Some(U8),
            _ => None,
        }
    }

    /// By its number in the scaler of a device.
    pub fn of_daqmx(kind: u32) -> Option<Self> {
        use DataType::{F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};
        [U8, I8, U16, I16, U32, I32, U64, I64, F32, F64].get(kind as usize).copied()
    }

    /// Bytes of a number.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The number of so many bytes.
    pub fn value(self, bytes: &[u8], order: ByteOrder) -> f64 {
        let mut own = [0; 8];
        let size = self.size().min(bytes.len());
        own[..size].copy_from_slice(&bytes[..size]);
        if order == ByteOrder::Big {
            own[..size].reverse();
        }
        let [a, b, c, d, ..] = own;
        match self {
            Self::I8 => f64::from(a as i8),
            Self::I16 => f64::from(i16::from_le_bytes([a, b])),
            Self::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Self::I64 => i64::from_le_bytes(own) as f64,
            Self::U8 => f64::from(a),
            Self::U16 => f64::from(u16::from_le_bytes([a, b])),
            Self::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Self::U64 => u64::from_le_bytes(own) as f64,
            Self::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Self::F64 => f64::from_le_bytes(own),
        }
    }
}

/// The number of a channel in the buffer of a device.
#[derive(Debug, Clone, PartialEq)]
pub struct Scaler {
    pub of: DataType,
    pub buffer: usize,
    /// Bytes from the beginning of a sample of the buffer.
    pub offset: usize,
    /// Number of its scale.
    pub scale: u32,
}

/// Numbers of a channel in each chunk of a segment.
#[derive(Debug, Clone, PartialEq)]
pub enum Index {
    Plain { of: DataType, count: u64 },
    Device { scaler: Scaler, widths: Vec<usize>, count: u64 },
}

impl Index {
    fn count(&self) -> u64 {
        match self {
            Self::Plain { count, .. } | Self::Device { count, .. } => *count,
        }
    }

    fn size(&self) -> u64 {
        self.data_type().size() as u64
    }

    fn data_type(&self) -> DataType {
        match self {
            Self::Plain { of, .. } => *of,
            Self::Device { scaler, .. } => scaler.of,
        }
    }

    /// Number of the scale of a device's numbers.
    pub fn scaler(&self) -> Option<u32> {
        if let Self::Device { scaler, .. } = self { Some(scaler.scale) } else { None }
    }
}

/// Rows of numbers within a chunk.
struct Rows {
    first: u64,
    stride: u64,
    count: u64,
    /// Channels with the place of their number in a row.
    members: Vec<(usize, usize, DataType)>,
}

/// A chunk: what a segment repeats to its end.
pub struct Chunk {
    rows: Vec<Rows>,
    bytes: u64,
    order: ByteOrder,
    at: u64,
}

impl Chunk {
    /// Of the channels of a segment in their order; `at` is its first byte.
    ///
    /// # Errors
    /// [`RecordError::Tdms`] for channels that cannot lie beside each other in this way.
    pub fn new(indices: &[Index], layout: Layout, order: ByteOrder, at: u64) -> Result<Self, RecordError> {
        let rows = match layout {
            Layout::Contiguous => contiguous(indices),
            Layout::Interleaved => interleaved(indices, at)?,
            Layout::Device => of_device(indices, at)?,
        };
        let bytes = rows.iter().map(|rows| rows.stride.saturating_mul(rows.count)).fold(0, u64::saturating_add);
        Ok(Self { rows, bytes, order, at })
    }

    /// Adds the numbers of the bytes from `data` to `end` to those of the channels: whole chunks, and of the last one
    /// what is there.
    ///
    /// # Errors
    /// [`RecordError`] if the file ends before.
    pub fn read(
        &self,
        source: &mut (impl Read + Seek),
        [data, end]: [u64; 2],
        values: &mut [Vec<f64>],
    ) -> Result<(), RecordError> {
        let mut begin = data;
        while begin < end && self.bytes > 0 {
            for rows in self.rows.iter().filter(|rows| rows.stride > 0 && !rows.members.is_empty()) {
                let first = begin.saturating_add(rows.first);
                let count = rows.count.min(end.saturating_sub(first) / rows.stride);
                self.rows(source, first, rows, count, values)?;
            }
            begin = begin.saturating_add(self.bytes);
        }
        Ok(())
    }

    fn rows(
        &self,
        source: &mut (impl Read + Seek),
        first: u64,
        rows: &Rows,
        count: u64,
        values: &mut [Vec<f64>],
    ) -> Result<(), RecordError> {
        source.seek(SeekFrom::Start(first))?;
        let mut left = count;
        while left > 0 {
            let taken = left.min((BUFFER / rows.stride).max(1));
            let bytes = some_bytes(source, taken * rows.stride, self.at)?;
            for row in bytes.chunks_exact(rows.stride as usize) {
                for (channel, offset, of) in &rows.members {
                    values[*channel].push(of.value(&row[*offset..], self.order));
                }
            }
            left -= taken;
        }
        Ok(())
    }
}

fn contiguous(indices: &[Index]) -> Vec<Rows> {
    let mut first = 0_u64;
    let mut all = Vec::new();
    for (channel, index) in indices.iter().enumerate() {
        let (stride, count, of) = (index.size(), index.count(), index.data_type());
        all.push(Rows { first, stride, count, members: vec![(channel, 0, of)] });
        first = first.saturating_add(stride.saturating_mul(count));
    }
    all
}

fn interleaved(indices: &[Index], at: u64) -> Result<Vec<Rows>, RecordError> {
    let Some(count) = indices.first().map(Index::count) else { return Ok(vec![]) };
    if indices.iter().any(|index| index.count() != count) {
        return wrong(at, "interleaved channels have different numbers of samples");
    }
    let (mut stride, mut members) = (0, Vec::new());
    for (channel, index) in indices.iter().enumerate() {
        members.push((channel, stride as usize, index.data_type()));
        stride += index.size();
    }
    Ok(vec![Rows { first: 0, stride, count, members }])
}

/// Rows of each buffer of a device.
fn of_device(indices: &[Index], at: u64) -> Result<Vec<Rows>, RecordError> {
    let Some(Index::Device { widths, count, .. }) = indices.first() else {
        return wrong(at, "the numbers of a device without the widths of its buffers");
    };
    let mut first = 0_u64;
    let mut all = Vec::new();
    for width in widths {
        let stride = *width as u64;
        all.push(Rows { first, stride, count: *count, members: vec![] });
        first = first.saturating_add(stride.saturating_mul(*count));
    }
    for (channel, index) in indices.iter().enumerate() {
        let Index::Device { scaler, widths: own, count: own_count } = index else {
            return wrong(at, "channels of a device among others");
        };
        let end = scaler.offset.saturating_add(scaler.of.size());
        let fits = own == widths && own_count == count && widths.get(scaler.buffer).is_some_and(|width| end <= *width);
        match all.get_mut(scaler.buffer).filter(|_| fits) {
            Some(rows) => rows.members.push((channel, scaler.offset, scaler.of)),
            None => return wrong(at, "a channel lies outside of the buffers of its device"),
        }
    }
    Ok(all)
}

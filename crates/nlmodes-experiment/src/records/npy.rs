//! NumPy arrays.

use std::io::{Cursor, Read, Write};

use npyz::{AutoSerialize, DType, Deserialize, NpyFile, Order, WriterBuilder};

use crate::records::limits::{MAX_BYTES, MAX_CHANNELS};
use crate::records::{Column, Record, RecordError, RecordTable};

/// Most bytes of the text that describes an array.
const MAX_HEADER: usize = 4096;

/// Reads an array of numbers, samples × channels (or channels × samples: there are always more samples), or the samples
/// of one channel. The channels have no names and no sampling rate.
///
/// # Errors
/// [`RecordError::Npy`] and what limits there are.
pub fn read_npy(source: impl Read) -> Result<RecordTable, RecordError> {
    // As much as a header has, and then the numbers as they come.
    let mut begin = Vec::new();
    let mut source = source.take(MAX_BYTES + 1);
    source.by_ref().take(MAX_HEADER as u64 + 12).read_to_end(&mut begin)?;
    check_header(&begin).map_err(refuse)?;
    let file = NpyFile::new(Cursor::new(begin).chain(source)).map_err(|error| refuse(error.to_string()))?;
    let (shape, order) = (file.shape().to_vec(), file.order());
    let (rows, columns) = match shape.as_slice() {
        [rows] => (*rows as usize, 1),
        [rows, columns] => (*rows as usize, *columns as usize),
        _ => return Err(refuse(format!("an array of {} dimensions, not of samples × channels", shape.len()))),
    };
    let by_rows = rows >= columns;
    let (samples, channels) = if by_rows { (rows, columns) } else { (columns, rows) };
    if channels > MAX_CHANNELS {
        return Err(RecordError::TooManyChannels { found: channels, limit: MAX_CHANNELS });
    }
    if samples < 2 || channels == 0 {
        return Err(RecordError::Empty { samples: if channels == 0 { 0 } else { samples } });
    }
    let size = if let DType::Plain(kind) = file.dtype() { kind.num_bytes().unwrap_or(1) as u64 } else { 1 };
    if (samples as u64).saturating_mul(channels as u64).saturating_mul(size) > MAX_BYTES {
        return Err(RecordError::TooLarge { limit: MAX_BYTES });
    }
    // Neighbours in memory belong to one channel where rows are channels in C order, or columns are in Fortran order.
    let together = by_rows == (order == Order::Fortran);
    let mut columns: Vec<Column> = (0..channels).map(|c| Column::new((c + 1).to_string(), vec![])).collect();
    numbers(file, |i, x| columns[if together { i / samples } else { i % channels }].values.push(x))?;
    Ok(RecordTable { columns, named: false })
}

/// Accepts only headers of plain arrays: the parser after it recurses over brackets and multiplies lengths unchecked.
fn check_header(bytes: &[u8]) -> Result<(), String> {
    let start = if bytes.get(6) == Some(&1) { 10 } else { 12 };
    let claimed = bytes.get(8..start).unwrap_or_default().iter().rev().fold(0_usize, |n, b| (n << 8) | usize::from(*b));
    if claimed > MAX_HEADER && bytes.len() > MAX_HEADER {
        return Err(format!("its header has {claimed} bytes, {MAX_HEADER} are read"));
    }
    let Some(text) = bytes.get(start..).filter(|rest| claimed <= rest.len()).map(|rest| &rest[..claimed]) else {
        return Err("it ends within its header, or is no NumPy file at all".into());
    };
    let count = |wanted: &[u8]| text.iter().filter(|b| wanted.contains(b)).count();
    if count(b"[") > 0 || count(b"(") > 1 || count(b"{") > 1 {
        return Err("it holds records of several fields, or its header is damaged; expected a plain array".into());
    }
    // With so few digits no product of lengths leaves 64 bits.
    if count(b"0123456789") > 18 { Err("its shape is too large".into()) } else { Ok(()) }
}

/// Passes each number with its place to `take`.
fn numbers<R: Read>(file: NpyFile<R>, take: impl FnMut(usize, f64)) -> Result<(), RecordError> {
    let DType::Plain(kind) = file.dtype() else { return Err(refuse("its elements are not plain numbers")) };
    match kind.to_string().trim_start_matches(['<', '>', '|', '=']) {
        "f8" => convert::<f64, R>(file, take, |x| x),
        "f4" => convert::<f32, R>(file, take, f64::from),
        "i1" => convert::<i8, R>(file, take, f64::from),
        "u1" => convert::<u8, R>(file, take, f64::from),
        "i2" => convert::<i16, R>(file, take, f64::from),
        "u2" => convert::<u16, R>(file, take, f64::from),
        "i4" => convert::<i32, R>(file, take, f64::from),
        "u4" => convert::<u32, R>(file, take, f64::from),
        "i8" => convert::<i64, R>(file, take, |x| x as f64),
        other => Err(refuse(format!("its elements are of type {other}, not real numbers"))),
    }
}

fn convert<T: Deserialize, R: Read>(
    file: NpyFile<R>,
    mut take: impl FnMut(usize, f64),
    to: impl Fn(T) -> f64,
) -> Result<(), RecordError> {
    let data = file.data::<T>().map_err(|error| refuse(error.to_string()))?;
    // Memory is allocated as the numbers are read, whatever the header claims.
    for (i, x) in data.enumerate() {
        take(i, to(x.map_err(|error| refuse(format!("it ends after {i} numbers: {error}")))?));
    }
    Ok(())
}

fn refuse(message: impl Into<String>) -> RecordError {
    RecordError::Npy { message: message.into() }
}

/// Writes a record in SI units as an array of 64-bit numbers, samples × channels.
///
/// # Errors
/// [`RecordError`] if the stream cannot be written.
pub fn write_npy(target: impl Write, record: &Record) -> Result<(), RecordError> {
    use npyz::NpyWriter;
    let shape = [record.n_samples() as u64, record.channels.len() as u64];
    let options = npyz::WriteOptions::new().dtype(f64::default_dtype()).shape(&shape);
    let mut writer: NpyWriter<f64, _> = options.writer(target).begin_nd()?;
    for j in 0..record.n_samples() {
        writer.extend(record.samples.iter().map(|samples| samples[j]))?;
    }
    Ok(writer.finish()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::{Channel, Quantity, Role};

    #[test]
    fn what_is_written_comes_back() {
        let channel = |name: &str| Channel::new(name, Quantity::Force, Role::Excitation, None);
        let channels = [channel("a"), channel("b")];
        let record = Record::new("r", 8.0)
            .with(channels[0].clone(), vec![1.0, 2.0, -0.1])
            .with(channels[1].clone(), vec![4.0, 5.0, 6.0]);
        let mut bytes = Vec::new();
        write_npy(&mut bytes, &record).unwrap();
        let back = read_npy(&bytes[..]).unwrap().into_record("r", &channels, Some(8.0)).unwrap();
        assert_eq!(back, record);
        let alone = read_npy(&bytes[..]).unwrap().into_record("r", &channels[..1], Some(8.0));
        assert!(matches!(alone, Err(RecordError::ChannelCount { found: 2, described: 1 })));
        let no_rate = read_npy(&bytes[..]).unwrap().into_record("r", &channels, None);
        assert!(matches!(no_rate, Err(RecordError::NoRate)));
    }

    #[test]
    fn arrays_without_two_samples_are_refused_with_what_they_have() {
        for (shape, found) in [(vec![0], 0), (vec![1], 1), (vec![0, 3], 0), (vec![3, 0], 0), (vec![1, 1], 1)] {
            let mut bytes = Vec::new();
            let options = npyz::WriteOptions::new().default_dtype().shape(&shape);
            let mut writer = options.writer(&mut bytes).begin_nd().unwrap();
            writer.extend((0..shape.iter().product()).map(|x| x as f64)).unwrap();
            writer.finish().unwrap();
            let refused = read_npy(&bytes[..]);
            assert!(
                matches!(refused, Err(RecordError::Empty { samples }) if samples == found),
                "{shape:?}: {refused:?}"
            );
        }
    }

    #[test]
    fn both_orders_and_both_orientations_are_read() {
        let array = |shape: [u64; 2], order: Order| {
            let mut bytes = Vec::new();
            let options = npyz::WriteOptions::new().dtype("<i2".parse().map(DType::Plain).unwrap());
            let mut writer = options.shape(&shape).order(order).writer(&mut bytes).begin_nd().unwrap();
            writer.extend(0..6_i16).unwrap();
            writer.finish().unwrap();
            read_npy(&bytes[..]).unwrap().columns.into_iter().map(|column| column.values).collect::<Vec<_>>()
        };
        let interleaved = [vec![0.0, 2.0, 4.0], vec![1.0, 3.0, 5.0]];
        let together = [vec![0.0, 1.0, 2.0], vec![3.0, 4.0, 5.0]];
        assert_eq!(array([3, 2], Order::C), interleaved);
        assert_eq!(array([3, 2], Order::Fortran), together);
        assert_eq!(array([2, 3], Order::C), together);
        assert_eq!(array([2, 3], Order::Fortran), interleaved);
    }
}

//! TDMS files of LabVIEW, FlexLogger and DIAdem: segments with a list of objects, and numbers channel by channel,
//! interleaved, or as a device delivers them (DAQmx).

mod layout;
mod metadata;
mod scale;

use std::collections::HashMap;
use std::io::{Read, Seek, SeekFrom};

use self::layout::{Chunk, Index};
use self::metadata::{Cursor, Object, Property, Segment};
use self::scale::Scales;
use crate::records::limits::MAX_CHANNELS;
use crate::records::{Column, Declared, RecordError, RecordTable, SampleRate, Start};

/// A channel as its segments add to it.
#[derive(Debug, Clone, Default)]
struct Gathered {
    properties: HashMap<String, Property>,
    index: Option<Index>,
    values: Vec<f64>,
}

/// Reads all channels of numbers of a TDMS file, each under `group/channel` or its own name. Sampling rate, start and
/// unit are those of the properties `wf_increment`, `wf_start_offset` and `unit_string`; linear and polynomial scales
/// are applied.
///
/// # Errors
/// [`RecordError::Tdms`] with the byte, for what is malformed and for scales of other kinds, and what limits there are.
pub fn read_tdms(mut source: impl Read + Seek) -> Result<RecordTable, RecordError> {
    let length = source.seek(SeekFrom::End(0))?;
    let (mut order, mut channels): (Vec<String>, HashMap<String, Gathered>) = (Vec::new(), HashMap::new());
    let (mut at, mut present): (u64, Vec<String>) = (0, Vec::new());
    while at < length {
        source.seek(SeekFrom::Start(at))?;
        let segment = Segment::read(&mut source, at, length)?;
        if segment.renews_objects {
            present.clear();
        }
        for object in segment.objects {
            let gathered = channels.entry(object.path.clone()).or_insert_with(|| {
                order.push(object.path.clone());
                Gathered::default()
            });
            take(gathered, &object, at)?;
            present.retain(|path| *path != object.path || !matches!(object.index, metadata::RawIndex::None));
            if !matches!(object.index, metadata::RawIndex::None) && !present.contains(&object.path) {
                present.push(object.path);
            }
        }
        if order.len() > MAX_CHANNELS {
            return Err(RecordError::TooManyChannels { found: order.len(), limit: MAX_CHANNELS });
        }
        if segment.has_data {
            let indices: Vec<Index> = present.iter().filter_map(|path| channels[path].index.clone()).collect();
            let chunk = Chunk::new(&indices, segment.layout, segment.order, at)?;
            let mut taken = |path| channels.get_mut(path).map_or_else(Vec::new, |own| std::mem::take(&mut own.values));
            let mut values: Vec<Vec<f64>> = present.iter().map(&mut taken).collect();
            chunk.read(&mut source, [segment.data, segment.end], &mut values)?;
            for (path, values) in present.iter().zip(values) {
                channels.entry(path.clone()).or_default().values = values;
            }
        }
        at = segment.end;
    }
    table(order, channels)
}

/// What a segment says of an object.
fn take(gathered: &mut Gathered, object: &Object, at: u64) -> Result<(), RecordError> {
    gathered.properties.extend(object.properties.iter().cloned());
    match &object.index {
        metadata::RawIndex::None => {}
        metadata::RawIndex::AsBefore if gathered.index.is_some() => {}
        metadata::RawIndex::AsBefore => {
            let message = format!("{} has the layout of an earlier segment, but there is none", object.path);
            return Err(RecordError::Tdms { byte: at, message });
        }
        metadata::RawIndex::New(index) => gathered.index = Some(index.clone()),
    }
    Ok(())
}

fn table(order: Vec<String>, mut channels: HashMap<String, Gathered>) -> Result<RecordTable, RecordError> {
    let mut columns = Vec::new();
    for path in order {
        let Some(gathered) = channels.remove(&path).filter(|gathered| !gathered.values.is_empty()) else { continue };
        columns.push(column(&path, gathered)?);
    }
    if columns.is_empty() {
        return Err(RecordError::Empty { samples: 0 });
    }
    Ok(RecordTable { columns, named: true })
}

fn column(path: &str, gathered: Gathered) -> Result<Column, RecordError> {
    let Gathered { properties, index, mut values } = gathered;
    let parts = metadata::parts(path);
    let number = |name: &str| properties.get(name).and_then(Property::number);
    Scales::new(&properties, index.as_ref().and_then(Index::scaler), &parts.join("/"))?.apply(&mut values);
    let rate = number("wf_increment").filter(|step| *step > 0.0 && step.is_finite());
    let start = number("wf_start_offset").filter(|at| at.is_finite());
    let unit = properties.get("unit_string").and_then(Property::text).unwrap_or_default().to_owned();
    Ok(Column {
        aliases: parts.last().filter(|_| parts.len() > 1).cloned().into_iter().collect(),
        // A step is stored as a double.
        rate: rate.map(|step| SampleRate { hz: 1.0 / step, relative_error: f64::EPSILON }),
        start: start.map(|at| Start { at, rounding: f64::EPSILON * at.abs() }),
        declared: Declared { unit, ..Declared::default() },
        ..Column::new(parts.join("/"), values)
    })
}

/// What is malformed at a byte.
fn wrong<T>(byte: u64, message: impl Into<String>) -> Result<T, RecordError> {
    Err(RecordError::Tdms { byte, message: message.into() })
}

/// The next bytes, of which so many must be there.
fn some_bytes(source: &mut impl Read, count: u64, byte: u64) -> Result<Vec<u8>, RecordError> {
    let mut bytes = Vec::new();
    source.take(count).read_to_end(&mut bytes)?;
    if bytes.len() as u64 == count { Ok(bytes) } else { wrong(byte, "the file ends within a segment") }
}

/// A cursor over bytes that were read at a place of the file.
fn cursor(bytes: &[u8], order: layout::ByteOrder, byte: u64) -> Cursor<'_> {
    Cursor { bytes, at: 0, order, byte }
}

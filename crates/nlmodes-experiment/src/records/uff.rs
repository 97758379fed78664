//! Universal File Format, dataset 58 (function at nodal degree of freedom), as text and as binary (58b).
//!
//! A file is a sequence of datasets between lines with only `−1`. Dataset 58 has eleven header lines of fixed-width
//! fields and then the ordinates: real or complex, in single or double precision, over an even or an uneven abscissa;
//! in 58b these are binary, in either byte order. All of these are read and written. The units of dataset 164 apply to
//! the functions after it; datasets of other types are skipped.

mod bytes;
mod dataset;
mod error;
mod header;
mod lines;
mod read;
mod text;
mod units;
mod write;

pub use dataset::{Abscissa, Axis, ByteOrder, Dataset58, Node, Ordinates, Precision, Storage};
pub use error::UffError;
pub use read::read_uff58;
pub use write::write_uff58;

use std::io::{Read, Write};

use crate::records::limits::{MAX_CHANNELS, read_all};
use crate::records::{
    Column, Declared, DeclaredQuantity, Quantity, Record, RecordError, RecordTable, SampleRate, Start, TimeAxis, unit,
};

/// Abscissa of time, in the codes of the format.
const TIME: i32 = 17;

/// Reads the time records of a Universal File. The name of a column is the first identification line of its dataset, or
/// where that is empty the next one, the label of its ordinate, or the name of its response entity; all of them, and
/// `node:direction`, find it. Start, quantity and unit of a column are those of its header.
///
/// # Errors
/// [`UffError`] for a file that is not sound, or that holds something else than real functions of time.
pub fn read_uff(source: impl Read) -> Result<RecordTable, RecordError> {
    let datasets = read_uff58(&read_all(source)?)?;
    if datasets.len() > MAX_CHANNELS {
        return Err(RecordError::TooManyChannels { found: datasets.len(), limit: MAX_CHANNELS });
    }
    let columns = datasets.into_iter().map(column).collect::<Result<_, _>>()?;
    Ok(RecordTable { columns, named: true })
}

fn column(dataset: Dataset58) -> Result<Column, RecordError> {
    let mut names = dataset.names();
    // At least its node and direction name a dataset.
    let name = names.remove(0);
    let Ordinates::Real(values) = dataset.ordinates else {
        return Err(UffError::NotATimeRecord { name, reason: "its ordinates are complex" }.into());
    };
    if !matches!(dataset.abscissa_axis.kind, 0 | TIME) {
        return Err(UffError::NotATimeRecord { name, reason: "its abscissa is not time" }.into());
    }
    let seconds = seconds(&name, &dataset.abscissa_axis.unit)?;
    let declared = Declared {
        quantity: quantity(dataset.ordinate_axis.kind),
        unit: dataset.ordinate_axis.unit,
        system: dataset.units,
    };
    let mut column = Column { aliases: names, declared, ..Column::new(name.clone(), values) };
    match dataset.abscissa {
        Abscissa::Even { first, step, rounding, first_rounding } if step > 0.0 => {
            column.rate = Some(SampleRate::of_interval(step * seconds, rounding * seconds));
            column.start = Some(Start { at: first * seconds, rounding: first_rounding * seconds });
        }
        Abscissa::Even { step, .. } => return Err(UffError::Step { name, step }.into()),
        Abscissa::Uneven { values, rounding } => {
            let times: Vec<f64> = values.iter().map(|t| t * seconds).collect();
            let largest = values.iter().fold(0.0, |largest: f64, t| largest.max(t.abs()));
            let first = values.first().copied().unwrap_or_default();
            // Digits are significant ones: those of a small value are finer.
            let own = if largest > 0.0 { rounding * first.abs() / largest } else { rounding };
            TimeAxis::new(&times, rounding * seconds, own * seconds)?.put(&mut column);
        }
    }
    Ok(column)
}

/// Seconds in the unit of an abscissa; one where it has none.
fn seconds(name: &str, text: &str) -> Result<f64, UffError> {
    let is_none = ["", "none", "unknown", "n/a", "-", "time"].contains(&text.trim().to_lowercase().as_str());
    let refuse = || UffError::TimeUnit { name: name.to_owned(), unit: text.to_owned() };
    if is_none { Ok(1.0) } else { unit::seconds(text).ok_or_else(refuse) }
}

/// The quantity of a code of the format.
fn quantity(kind: i32) -> DeclaredQuantity {
    match kind {
        8 => DeclaredQuantity::Known(Quantity::Displacement),
        11 => DeclaredQuantity::Known(Quantity::Velocity),
        12 => DeclaredQuantity::Known(Quantity::Acceleration),
        9 | 13 => DeclaredQuantity::Known(Quantity::Force),
        2 => DeclaredQuantity::Other("stress"),
        3 => DeclaredQuantity::Other("strain"),
        5 => DeclaredQuantity::Other("temperature"),
        6 => DeclaredQuantity::Other("heat flux"),
        15 => DeclaredQuantity::Other("pressure"),
        16 => DeclaredQuantity::Other("mass"),
        17 => DeclaredQuantity::Other("time"),
        18 => DeclaredQuantity::Other("frequency"),
        19 => DeclaredQuantity::Other("revolutions"),
        20 => DeclaredQuantity::Other("order"),
        _ => DeclaredQuantity::Unknown,
    }
}

/// Writes the channels of a record in SI units, a dataset each, in double precision.
///
/// The sampling interval is a header field of six digits. If it needs more, a reader uses a rate given by the user, or
/// that of the header with a relative error of 5e-6.
///
/// # Errors
/// [`RecordError`] if the stream cannot be written.
pub fn write_uff(mut target: impl Write, record: &Record, storage: Storage) -> Result<(), RecordError> {
    for (channel, samples) in record.channels.iter().zip(&record.samples) {
        let mut dataset = Dataset58::real(samples.clone(), Abscissa::even(0.0, 1.0 / record.sample_rate));
        dataset.identification[0].clone_from(&channel.name);
        dataset.identification[1].clone_from(&record.name);
        dataset.response.entity.clone_from(&channel.name);
        dataset.abscissa_axis = Axis { kind: TIME, label: "Time".into(), unit: "s".into(), ..Axis::default() };
        let unit = channel.quantity.si_unit().into();
        dataset.ordinate_axis =
            Axis { kind: kind(channel.quantity), label: channel.name.clone(), unit, ..Axis::default() };
        write_uff58(&mut target, &dataset, storage, Precision::Double)?;
    }
    Ok(())
}

/// Code of the quantity in the format.
fn kind(quantity: Quantity) -> i32 {
    match quantity {
        Quantity::Displacement => 8,
        Quantity::Velocity => 11,
        Quantity::Acceleration => 12,
        Quantity::Force => 13,
        Quantity::Phase => 1,
    }
}

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::records::{Quantity, UffError};

/// Why there is no record to work with.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordError {
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The stream cannot be read or written.
    #[error("the record cannot be read or written: {0}")]
    Stream(#[from] io::Error),
    /// No reader for files of this kind.
    #[error(
        "files with the ending \"{extension}\" are not records; known are .csv, .uff, .unv, .wav, .npy, .tdms, \
         .mat and .h5"
    )]
    Extension {
        /// Ending of the name.
        extension: String,
    },
    /// The file is larger than records are.
    #[error("the file has more than {limit} bytes, too many for one record")]
    TooLarge {
        /// Limit, bytes.
        limit: u64,
    },
    /// The file holds too many channels.
    #[error("the file has {found} channels, more than the {limit} that are read")]
    TooManyChannels {
        /// Channels of the file.
        found: usize,
        /// Limit.
        limit: usize,
    },
    /// Bytes that no text has.
    #[error("line {line}: the byte 0x{byte:02X} does not belong in a text table; is this a binary file, or UTF-16?")]
    NotText {
        /// Line, from 1.
        line: usize,
        /// The byte.
        byte: u8,
    },
    /// Line ends of several systems.
    #[error("line {line} ends with {found}, the lines before it with {expected}: two files run together?")]
    MixedLineEnds {
        /// Line, from 1.
        line: usize,
        /// Its end.
        found: &'static str,
        /// The end of the first line.
        expected: &'static str,
    },
    /// A row has another number of fields than the header.
    #[error(
        "line {line} has {found} fields, the header has {expected}{}",
        if *decimal_commas { "; commas as decimal signs? write decimal points" } else { "; is the file cut off?" }
    )]
    Fields {
        /// Line, from 1.
        line: u64,
        /// Fields of the line.
        found: usize,
        /// Columns of the header.
        expected: usize,
        /// Whether decimal commas explain it.
        decimal_commas: bool,
    },
    /// A number with a decimal comma.
    #[error("line {line}, column \"{column}\": \"{text}\" has a comma as decimal sign; write a decimal point")]
    DecimalComma {
        /// Line, from 1.
        line: u64,
        /// Name of the column.
        column: String,
        /// The actual contents.
        text: String,
    },
    /// No number where one is expected.
    #[error("line {line}, column \"{column}\": \"{text}\" is not a number")]
    NotANumber {
        /// Line, from 1.
        line: u64,
        /// Name of the column.
        column: String,
        /// The actual contents.
        text: String,
    },
    /// Something else in a text table.
    #[error("the table cannot be read: {message}")]
    Table {
        /// Message of the reader.
        message: String,
    },
    /// The header names a column twice, or none at all.
    #[error("the header names the column \"{name}\" {count} times")]
    Header {
        /// The name.
        name: String,
        /// Number of occurrences.
        count: usize,
    },
    /// Fewer than two samples.
    #[error("the record has {samples} samples; at least 2 are needed")]
    Empty {
        /// Samples found.
        samples: usize,
    },
    /// There is no such column.
    #[error("there is no column \"{name}\"; the file has: {columns}")]
    NoColumn {
        /// The name.
        name: String,
        /// The columns that are there.
        columns: String,
    },
    /// Several columns have this name.
    #[error(
        "\"{name}\" is the name of {count} columns of the file; name one by a name of its own; the file has: {columns}"
    )]
    Ambiguous {
        /// The name.
        name: String,
        /// How many.
        count: usize,
        /// The columns that are there, each with all of its names.
        columns: String,
    },
    /// A flag of segments that the file does not have.
    #[error("there is no channel \"{flag}\" that tells while a level is held; the file has: {columns}")]
    NoFlag {
        /// Its name in the scene.
        flag: String,
        /// The columns that are there, each with all of its names.
        columns: String,
    },
    /// No described channel is in the file.
    #[error("no channel of the scene is in the file: described are {described}; the file has: {columns}")]
    NoChannels {
        /// Names of the described channels.
        described: String,
        /// The columns that are there, each with all of its names.
        columns: String,
    },
    /// Two channels name one column.
    #[error("the channels \"{first}\" and \"{second}\" are one column of the file, under two of its names")]
    SameColumn {
        /// The first channel.
        first: String,
        /// The second one.
        second: String,
    },
    /// The file has another quantity for a channel.
    #[error("channel \"{channel}\": the file says that it measures {found}, the scene says {declared}")]
    QuantityDisagrees {
        /// Name of the channel.
        channel: String,
        /// According to the file.
        found: &'static str,
        /// According to the scene.
        declared: Quantity,
    },
    /// The file has another unit for a channel.
    #[error("channel \"{channel}\": the file says {header}, the scene says {quantity} in \"{declared}\"")]
    UnitDisagrees {
        /// Name of the channel.
        channel: String,
        /// According to the file.
        header: String,
        /// Unit of the scene.
        declared: String,
        /// Quantity of the scene.
        quantity: Quantity,
    },
    /// Channels begin at different instants, which are not known well enough.
    #[error(
        "channel \"{channel}\" begins at {start} s, \"{first}\" at {first_start} s, by the digits of the file ± \
            {rounding:e} s: \
         too few to put their samples side by side"
    )]
    StartsUncertain {
        /// The channel that begins last.
        channel: String,
        /// Its start, s.
        start: f64,
        /// The one that begins first.
        first: String,
        /// Its start, s.
        first_start: f64,
        /// Largest error of their difference, s.
        rounding: f64,
    },
    /// Channels of one file were not recorded at the same time.
    #[error("channel \"{channel}\" begins at {start} s, \"{first}\" at {first_start} s: they have no time in common")]
    NoCommonTime {
        /// The channel that begins last.
        channel: String,
        /// Its start, s.
        start: f64,
        /// The one that begins first.
        first: String,
        /// Its start, s.
        first_start: f64,
    },
    /// A file without names has another number of channels than are described.
    #[error("the file has {found} channels and no names, so they are taken in order, but {described} are described")]
    ChannelCount {
        /// Channels of the file.
        found: usize,
        /// Channels described.
        described: usize,
    },
    /// Time steps are not uniform.
    #[error(
        "sample {sample} stands {deviation:.3} sampling intervals from where an even time axis has it; samples lost or \
            a clock that drifts?"
    )]
    UnevenTime {
        /// Number of the sample, from 0.
        sample: usize,
        /// Deviation over the sampling interval.
        deviation: f64,
    },
    /// The sampling rate of the file is not the one that was declared.
    #[error(
        "sampling-rates-disagree: the file has {found} Hz, {declared} Hz are declared: {relative:.2e} relative, \
            {limit:.2e} are allowed"
    )]
    RateDisagrees {
        /// Declared, Hz.
        declared: f64,
        /// Of the file, Hz.
        found: f64,
        /// Relative difference.
        relative: f64,
        /// Largest one that is allowed.
        limit: f64,
    },
    /// Channels of one file differ in their sampling rate.
    #[error("sampling-rates-disagree: channel \"{first}\" has {first_hz} Hz, channel \"{other}\" {other_hz} Hz")]
    RatesDisagree {
        /// First channel.
        first: String,
        /// Its rate, Hz.
        first_hz: f64,
        /// The one that differs.
        other: String,
        /// Its rate, Hz.
        other_hz: f64,
    },
    /// No sampling rate is known.
    #[error("neither the file nor the description of the recording tells a sampling rate that is positive and finite")]
    NoRate,
    /// Channels of one file differ in length.
    #[error("channel \"{first}\" has {first_samples} samples, channel \"{other}\" {other_samples}")]
    LengthsDisagree {
        /// First channel.
        first: String,
        /// Its samples.
        first_samples: usize,
        /// The one that differs.
        other: String,
        /// Its samples.
        other_samples: usize,
    },
    /// A unit that does not measure the quantity.
    #[error("channel \"{channel}\": \"{unit}\" is not a unit of {quantity}; known are {known}")]
    Unit {
        /// Name of the channel.
        channel: String,
        /// The unit.
        unit: String,
        /// The quantity.
        quantity: Quantity,
        /// Units that are known.
        known: String,
    },
    /// Sensitivity or sign make no sense.
    #[error("channel \"{channel}\": sensitivity {sensitivity} and sign {sign} must be finite and not zero")]
    Sensitivity {
        /// Name of the channel.
        channel: String,
        /// Sensitivity.
        sensitivity: f64,
        /// Sign.
        sign: f64,
    },
    /// Not a sound Universal File.
    #[error(transparent)]
    Uff(#[from] UffError),
    /// A TDMS file that cannot be read.
    #[error("the TDMS file cannot be read at byte {byte}: {message}")]
    Tdms {
        /// Where, from 0.
        byte: u64,
        /// Why.
        message: String,
    },
    /// Not a sound WAV file.
    #[error("the WAV file cannot be read: {message}")]
    Wav {
        /// Why.
        message: String,
    },
    /// Not a sound NumPy file.
    #[error("the NumPy file cannot be read: {message}")]
    Npy {
        /// Why.
        message: String,
    },
}

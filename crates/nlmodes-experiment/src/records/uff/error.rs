use std::io;

use thiserror::Error;

/// Why a Universal File cannot be read or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum UffError {
    /// The stream cannot be written.
    #[error("the Universal File cannot be written: {0}")]
    Io(#[from] io::Error),
    /// Not a single dataset 58.
    #[error(
        "no dataset 58 in the file ({datasets} datasets of other types); a Universal File begins with a line \"    -1\""
    )]
    NoFunction {
        /// Datasets of other types.
        datasets: usize,
    },
    /// The header ends too early.
    #[error("line {line}: the header of a dataset 58 needs 11 lines, this one ends after {found}")]
    HeaderCutOff {
        /// Line where the dataset begins, from 1.
        line: usize,
        /// Lines that are there.
        found: usize,
    },
    /// A field that is not what the format has there.
    #[error("line {line}, columns {first} to {last}: \"{text}\" is not {expected}")]
    Field {
        /// Line, from 1.
        line: usize,
        /// First column, from 1.
        first: usize,
        /// Last column.
        last: usize,
        /// The actual contents.
        text: String,
        /// What is expected.
        expected: &'static str,
    },
    /// Fewer numbers than the header announces.
    #[error("line {line}: the header announces {announced} numbers, {found} follow; is the file cut off?")]
    CutOff {
        /// Line where the numbers begin, from 1.
        line: usize,
        /// Numbers announced.
        announced: usize,
        /// Numbers found.
        found: usize,
    },
    /// More numbers than the header announces.
    #[error("line {line}: the header announces {announced} numbers, more follow")]
    TooMany {
        /// Line where the numbers begin, from 1.
        line: usize,
        /// Numbers announced.
        announced: usize,
    },
    /// The line after the numbers is not the end mark.
    #[error(
        "line {line}: {bytes} bytes of numbers are not followed by the line \"    -1\"; wrong count or precision in \
            the header?"
    )]
    NoEnd {
        /// Line where the numbers begin, from 1.
        line: usize,
        /// Bytes that the header announces.
        bytes: usize,
    },
    /// Text that is not a number.
    #[error("line {line}: \"{text}\" is not a number{}", if *decimal_comma { "; write a decimal point" } else { "" })]
    NotANumber {
        /// Line, from 1.
        line: usize,
        /// The actual contents.
        text: String,
        /// Whether a decimal comma explains it.
        decimal_comma: bool,
    },
    /// Binary numbers in another format than IEEE 754.
    #[error("line {line}: binary numbers of format {format} are not read; 2 (IEEE 754) is")]
    FloatFormat {
        /// Line, from 1.
        line: usize,
        /// Code of the format: 1 DEC VMS, 3 IBM 5/370.
        format: i64,
    },
    /// The numbers make sense in the other byte order only.
    #[error("line {line}: the header says {declared} byte order, but the numbers make sense in the other one only")]
    ByteOrder {
        /// Line, from 1.
        line: usize,
        /// Value in the header.
        declared: &'static str,
    },
    /// A function that is not a record in time.
    #[error("dataset \"{name}\" is not a time record: {reason}")]
    NotATimeRecord {
        /// Name of the dataset.
        name: String,
        /// Why.
        reason: &'static str,
    },
    /// An abscissa in a unit that is no unit of time.
    #[error("dataset \"{name}\": \"{unit}\" is not a unit of time; known are s, ms, us, ns, min and h")]
    TimeUnit {
        /// Name of the dataset.
        name: String,
        /// The actual contents.
        unit: String,
    },
    /// A sampling interval that is not positive.
    #[error("dataset \"{name}\": the sampling interval {step} s is not positive")]
    Step {
        /// Name of the dataset.
        name: String,
        /// Sampling interval, s.
        step: f64,
    },
    /// What is to be written does not fit the format.
    #[error("an abscissa of {abscissa} values does not fit {ordinates} ordinates")]
    Lengths {
        /// Values of the abscissa.
        abscissa: usize,
        /// Ordinates.
        ordinates: usize,
    },
}

//! Text tables with named columns.

use std::io::{Read, Write};

use csv::{Reader, ReaderBuilder, StringRecord, Terminator, WriterBuilder};

use crate::records::limits::{MAX_CHANNELS, read_all};
use crate::records::sample_rate::Digits;
use crate::records::{Column, Declared, Record, RecordError, RecordTable, TimeAxis};

/// Name of the time column that is written.
pub const TIME_COLUMN: &str = "time_s";

/// Reads a table: a header with the names of the columns, then one row of numbers per sample. Columns are separated by
/// commas, semicolons or tabs; `nan` and an empty field mean a missing number. The time column (s) gives the sampling
/// rate and is not in the table.
///
/// # Errors
/// [`RecordError`]; each names the line. Line ends of one file must be alike, numbers have decimal points.
pub fn read_csv(source: impl Read, time_column: Option<&str>) -> Result<RecordTable, RecordError> {
    let bytes = read_all(source)?;
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&bytes);
    let end = line_end(bytes)?;
    let separator = separator(bytes);
    let mut reader = ReaderBuilder::new()
        .delimiter(separator)
        .terminator(if end == "CR" { Terminator::Any(b'\r') } else { Terminator::CRLF })
        .flexible(true)
        .from_reader(bytes);
    let names = header(&mut reader)?;
    let (mut columns, times) = rows(&mut reader, &names, time_column, separator)?;
    if let Some((values, rounding)) = times {
        let axis = TimeAxis::new(&values, rounding, rounding)?;
        columns.iter_mut().for_each(|column| axis.put(column));
    }
    Ok(RecordTable { columns, named: true })
}

/// The columns, and the time stamps with their rounding.
type Rows = (Vec<Column>, Option<(Vec<f64>, f64)>);

fn rows(reader: &mut Reader<&[u8]>, names: &[String], time: Option<&str>, separator: u8) -> Result<Rows, RecordError> {
    let time = time.map(|time| names.iter().position(|name| name == time).ok_or_else(|| no_column(time, names)));
    let time = time.transpose()?;
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
    let mut digits = Digits::default();
    let mut row = StringRecord::new();
    while reader.read_record(&mut row).map_err(|error| table(&error))? {
        let line = row.position().map_or(0, csv::Position::line);
        if row.len() != names.len() {
            let decimal_commas = separator == b',' && row.len() > names.len();
            return Err(RecordError::Fields { line, found: row.len(), expected: names.len(), decimal_commas });
        }
        for ((field, column), name) in row.iter().zip(&mut values).zip(names) {
            column.push(number(field, line, name)?);
        }
        if let Some(time) = time {
            digits.see(row[time].trim(), values[time].last().copied().unwrap_or(f64::NAN));
        }
    }
    let samples = values.first().map_or(0, Vec::len);
    if samples < 2 {
        return Err(RecordError::Empty { samples });
    }
    let times = time.map(|time| (values[time].clone(), digits.rounding()));
    let columns = names.iter().zip(values).enumerate().filter(|(i, _)| Some(*i) != time);
    let columns = columns.map(|(_, (name, values))| column(name, values));
    Ok((columns.collect(), times))
}

/// A column; its name may be followed by a unit in brackets.
fn column(name: &str, values: Vec<f64>) -> Column {
    let unit = name.strip_suffix([')', ']']).and_then(|name| Some(name.rsplit_once(['(', '['])?.1));
    let declared = Declared { unit: unit.unwrap_or_default().to_owned(), ..Declared::default() };
    Column { declared, ..Column::new(name, values) }
}

fn header(reader: &mut Reader<&[u8]>) -> Result<Vec<String>, RecordError> {
    let names = reader.headers().map_err(|error| table(&error))?;
    let names: Vec<String> = names.iter().map(|name| name.trim().to_owned()).collect();
    if names.len() > MAX_CHANNELS {
        return Err(RecordError::TooManyChannels { found: names.len(), limit: MAX_CHANNELS });
    }
    let count = |name: &String| names.iter().filter(|other| *other == name).count();
    match names.iter().find(|name| name.is_empty() || count(name) > 1) {
        Some(name) => Err(RecordError::Header { name: name.clone(), count: count(name) }),
        None if names.is_empty() => Err(RecordError::Empty { samples: 0 }),
        None => Ok(names),
    }
}

fn number(field: &str, line: u64, column: &str) -> Result<f64, RecordError> {
    let field = field.trim();
    if field.is_empty() {
        return Ok(f64::NAN);
    }
    field.parse().map_err(|_| {
        let (column, text) = (column.to_owned(), field.chars().take(40).collect::<String>());
        match field.replacen(',', ".", 1).parse::<f64>() {
            Ok(_) => RecordError::DecimalComma { line, column, text },
            Err(_) => RecordError::NotANumber { line, column, text },
        }
    })
}

/// The line end of the text; an error if it has several, or non-text bytes.
fn line_end(bytes: &[u8]) -> Result<&'static str, RecordError> {
    let (mut expected, mut line, mut at) = (None, 1, 0);
    while at < bytes.len() {
        let (found, width) = match (bytes[at], bytes.get(at + 1)) {
            (b'\r', Some(b'\n')) => ("CR LF", 2),
            (b'\r', _) => ("CR", 1),
            (b'\n', _) => ("LF", 1),
            (byte, _) if (byte < 0x20 && byte != b'\t') || byte >= 0xF8 => {
                return Err(RecordError::NotText { line, byte });
            }
            _ => {
                at += 1;
                continue;
            }
        };
        if *expected.get_or_insert(found) != found {
            return Err(RecordError::MixedLineEnds { line, found, expected: expected.unwrap_or(found) });
        }
        (line, at) = (line + 1, at + width);
    }
    Ok(expected.unwrap_or("LF"))
}

/// The most frequent separator in the first line.
fn separator(bytes: &[u8]) -> u8 {
    let first = bytes.split(|byte| matches!(byte, b'\n' | b'\r')).next().unwrap_or_default();
    let count = |separator: u8| first.iter().filter(|byte| **byte == separator).count();
    [b'\t', b';', b','].into_iter().max_by_key(|separator| count(*separator)).unwrap_or(b',')
}

fn no_column(name: &str, names: &[String]) -> RecordError {
    RecordError::NoColumn { name: name.to_owned(), columns: names.join(", ") }
}

fn table(error: &csv::Error) -> RecordError {
    RecordError::Table { message: error.to_string() }
}

/// Writes a record as a table in SI units, time first. `digits` is the number of significant digits; without one as
/// many as bring every number back exactly.
///
/// # Errors
/// [`RecordError`] if the stream cannot be written.
pub fn write_csv(target: impl Write, record: &Record, digits: Option<usize>) -> Result<(), RecordError> {
    let mut writer = WriterBuilder::new().from_writer(target);
    let names = std::iter::once(TIME_COLUMN).chain(record.channels.iter().map(|channel| channel.name.as_str()));
    writer.write_record(names).map_err(|error| table(&error))?;
    for j in 0..record.n_samples() {
        let time = j as f64 / record.sample_rate;
        let row = record.samples.iter().map(|samples| text(samples[j], digits));
        writer.write_record(std::iter::once(text(time, None)).chain(row)).map_err(|error| table(&error))?;
    }
    writer.flush()?;
    Ok(())
}

fn text(x: f64, digits: Option<usize>) -> String {
    match digits {
        Some(digits) => shortest(format!("{x:.*e}", digits.saturating_sub(1)).parse().unwrap_or(x)),
        None => shortest(x),
    }
}

/// The shorter one of the plain text and the one with a power of ten.
fn shortest(x: f64) -> String {
    let (plain, power) = (x.to_string(), format!("{x:e}"));
    if plain.len() <= power.len() { plain } else { power }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::{Channel, Quantity, Role};

    fn read(text: &str) -> Result<RecordTable, RecordError> {
        read_csv(text.as_bytes(), Some("t"))
    }

    #[test]
    fn what_is_written_comes_back() {
        let samples = vec![0.1, -2.5e-7, f64::NAN, 1e300];
        let force = Channel::new("f", Quantity::Force, Role::Excitation, None);
        let record = Record::new("r", 20_000.0).with(force.clone(), samples.clone());
        let mut bytes = Vec::new();
        write_csv(&mut bytes, &record, None).unwrap();
        let back = read_csv(&bytes[..], Some(TIME_COLUMN)).unwrap().into_record("r", &[force], Some(20_000.0)).unwrap();
        assert!(back.samples[0].iter().zip(&samples).all(|(a, b)| a.to_bits() == b.to_bits()));
        bytes.clear();
        write_csv(&mut bytes, &Record::new("r", 10.0).with(record.channels[0].clone(), vec![1.23456789, 2.0]), Some(4))
            .unwrap();
        assert_eq!(String::from_utf8(bytes).unwrap(), "time_s,f\n0,1.235\n0.1,2\n");
    }

    #[test]
    fn separators_and_line_ends_of_all_systems_are_read() {
        for (separator, end) in [(",", "\n"), (";", "\r\n"), ("\t", "\r"), (", ", "\n")] {
            let text = format!("\u{FEFF}t{separator}x{end}0{separator}1.5{end}0.1{separator}-2{end}");
            let table = read(&text).unwrap();
            assert_eq!(table.columns[0].values, [1.5, -2.0], "{text:?}");
            assert!((table.columns[0].rate.unwrap().hz - 10.0).abs() < 1e-12);
        }
    }

    #[test]
    fn each_malformed_table_has_its_own_error() {
        let said = |text: &str| read(text).unwrap_err().to_string();
        assert!(said("t,x\n0,1\r\n0.1,2\n").starts_with("line 2 ends with CR LF"));
        assert!(said("t;x\n0,0;1,5\n0,1;2\n").starts_with("line 2, column \"t\": \"0,0\" has a comma as decimal sign"));
        assert!(said("t,x\n0,0,1,5\n").contains("commas as decimal signs"));
        assert!(said("t,x\n0,1\n0.1\n").contains("cut off"));
        assert!(said("t,x\n0,one\n").ends_with("\"one\" is not a number"));
        assert!(said("t,x,x\n0,1,2\n").contains("\"x\" 2 times"));
        assert!(said("u,x\n0,1\n0.1,2\n").contains("no column \"t\"; the file has: u, x"));
        assert!(said("t,x\n0,1\n").contains("1 samples"));
        assert!(said("").contains("0 samples"));
        assert!(said("t,x\n0,1\n0.1,\0\n").contains("0x00"));
        assert!(said("t,x\n0,1\n0.1,2\n0.5,3\n").contains("time axis"));
    }
}

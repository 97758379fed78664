//! Files of records: those that the library of experiments reads, and arrays of MATLAB and HDF5.

use std::path::Path;

use nlmodes::experiment::records::{Column, Record, RecordError, RecordTable, Recording, TimeAxis};
use nlmodes_io::{Address, NumberArray, read_arrays};
use nlmodes_scene::RecordScene;

use crate::Failure;

/// Endings of files of arrays.
const ARRAYS: [&str; 3] = ["mat", "h5", "hdf5"];

/// The file of a record, and the array or structure within it, `run.mat#Tests{2}`.
fn address(scene: &RecordScene, name: &str) -> Address {
    let path = scene.base.join(name);
    // A name of its own may contain the sign.
    if path.exists() { Address { path, name: None } } else { Address::parse(name).within(&scene.base) }
}

fn holds_arrays(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    ending.is_some_and(|ending| ARRAYS.contains(&ending.as_str()))
}

/// Whether there is such a file, of a kind that can be read; it is not read.
///
/// # Errors
/// If there is none.
pub fn find(scene: &RecordScene, name: &str) -> Result<(), Failure> {
    let address = address(scene, name);
    if !holds_arrays(&address.path) {
        return Ok(Recording::find(&scene.base.join(name))?);
    }
    let io = |source| RecordError::Io { path: address.path.clone(), source };
    let file = std::fs::metadata(&address.path).map_err(io)?;
    if file.is_dir() { Err(io(std::io::ErrorKind::IsADirectory.into()).into()) } else { Ok(()) }
}

/// Reads a record, with its flags.
///
/// # Errors
/// If it cannot be read, or does not fit the channels of the scene.
pub fn read(scene: &RecordScene, name: &str, flags: &[&str]) -> Result<Record, Failure> {
    let (address, recording) = (address(scene, name), &scene.recording);
    if !holds_arrays(&address.path) {
        return Ok(recording.read_flagged(&scene.base.join(name), flags)?);
    }
    let mut table = table(read_arrays(&address)?);
    if let Some(time) = &recording.time_column {
        take_time(&mut table, time)?;
    }
    let name = address.path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    Ok(table.into_flagged_record(&name, &recording.channels, flags, recording.sample_rate)?)
}

/// The columns of arrays: a list is one, a matrix has one for each of its shorter side.
fn table(arrays: Vec<NumberArray>) -> RecordTable {
    let mut columns = Vec::new();
    for NumberArray { name, dimensions, values } in arrays {
        let last = name.rsplit('.').next().filter(|last| *last != name).map(str::to_owned);
        match dimensions[..] {
            [rows, channels] if rows > 1 && channels > 1 => {
                let by_columns = rows >= channels;
                for k in 0..rows.min(channels) {
                    let own = if by_columns {
                        values[k * rows..(k + 1) * rows].to_vec()
                    } else {
                        values.iter().skip(k).step_by(rows).copied().collect()
                    };
                    let place = if by_columns { format!("(:,{})", k + 1) } else { format!("({},:)", k + 1) };
                    let short = format!("{name}({})", k + 1);
                    let aliases = last.iter().map(|last| format!("{last}{place}")).chain([short]).collect();
                    columns.push(Column { aliases, ..Column::new(format!("{name}{place}"), own) });
                }
            }
            _ if values.len() > 1 && dimensions.iter().filter(|length| **length > 1).count() == 1 => {
                columns.push(Column { aliases: last.into_iter().collect(), ..Column::new(name, values) });
            }
            // Numbers by themselves, and arrays of more dimensions.
            _ => {}
        }
    }
    RecordTable { columns, named: true }
}

/// Takes the column of the time out of the table, and its sampling rate to the others of its length.
fn take_time(table: &mut RecordTable, time: &str) -> Result<(), RecordError> {
    let is_time = |column: &Column| column.name == time || column.aliases.iter().any(|alias| alias == time);
    let Some(at) = table.columns.iter().position(is_time) else {
        return Err(RecordError::NoColumn { name: time.to_owned(), columns: table.names() });
    };
    let times = table.columns.remove(at).values;
    let largest = times.iter().fold(0.0, |m: f64, t| m.max(t.abs()));
    let rounding = f64::EPSILON * largest;
    let axis = TimeAxis::new(&times, rounding, rounding)?;
    table.columns.iter_mut().filter(|column| column.values.len() == times.len()).for_each(|column| axis.put(column));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_become_columns_whichever_way_they_lie() {
        let array = |name: &str, dimensions: &[usize], values: &[f64]| NumberArray {
            name: name.into(),
            dimensions: dimensions.to_vec(),
            values: values.to_vec(),
        };
        let table = table(vec![
            array("run.force", &[3, 1], &[1.0, 2.0, 3.0]),
            array("run.x", &[3, 2], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
            array("y", &[2, 3], &[1.0, 4.0, 2.0, 5.0, 3.0, 6.0]),
            array("fs", &[1, 1], &[100.0]),
        ]);
        let found: Vec<(&str, &[f64])> =
            table.columns.iter().map(|column| (column.name.as_str(), column.values.as_slice())).collect();
        let (up, down) = ([1.0, 2.0, 3.0].as_slice(), [4.0, 5.0, 6.0].as_slice());
        assert_eq!(
            found,
            [("run.force", up), ("run.x(:,1)", up), ("run.x(:,2)", down), ("y(1,:)", up), ("y(2,:)", down)]
        );
        assert_eq!(table.columns[0].aliases, ["force"]);
        assert_eq!(table.columns[2].aliases, ["x(:,2)", "run.x(2)"]);
    }
}

use super::harmonics::write_numbers;
use crate::ReportError;
use crate::output::replace_file;
use npyz::WriterBuilder;
use npyz::npz::NpzWriter;
use std::io::{self, Seek, Write};
use std::path::Path;

/// Writes the states from which exact motions that are even in time start, as a NumPy archive.
///
/// | array | shape | type |
/// | --- | --- | --- |
/// | `omega` | points | float64, rad/s |
/// | `displacement` | points × coordinates | float64, m or rad; all velocities are zero |
///
/// # Errors
/// [`ReportError::Io`] if the file cannot be written.
pub fn write_starts(path: impl AsRef<Path>, omega: &[f64], displacement: &[Vec<f64>]) -> Result<(), ReportError> {
    replace_file(path.as_ref(), |file| {
        let mut archive = NpzWriter::new(file);
        write_numbers(&mut archive, "omega", omega)?;
        write_rows(&mut archive, displacement)?;
        archive.zip_writer().finish().map(drop).map_err(io::Error::from)
    })
}

fn write_rows<W: Write + Seek>(archive: &mut NpzWriter<W>, rows: &[Vec<f64>]) -> io::Result<()> {
    let shape = [rows.len() as u64, rows.first().map_or(0, Vec::len) as u64];
    let options = archive.array::<f64>("displacement", Default::default())?;
    let mut array = options.default_dtype().shape(&shape).begin_nd()?;
    array.extend(rows.iter().flatten().copied())?;
    array.finish()
}

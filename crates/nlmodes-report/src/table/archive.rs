//! NumPy archives: arrays one after the other, none compressed.

use npyz::npz::{NpzWriter, file_name_from_array_name};
use npyz::zip::write::FileOptions;
use npyz::zip::{CompressionMethod, DateTime};
use npyz::{AutoSerialize, DType, TypeStr, WriteOptions, WriterBuilder};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use crate::ReportError;
use crate::output::{Output, replace_file};

/// Bytes written to the archive at once: each call has an overhead.
const BUFFER: usize = 1 << 16;

/// Not compressed: floating-point numbers hardly compress, and it took longer than the computation.
fn stored() -> FileOptions {
    // The same results give the same archive, whenever they are written.
    let options = FileOptions::default().last_modified_time(DateTime::default());
    options.compression_method(CompressionMethod::Stored).large_file(true)
}

/// Writes an archive of what `arrays` puts into it; an existing file is replaced atomically.
///
/// # Errors
/// [`ReportError::Io`] if it cannot be written.
pub(super) fn write_archive(
    path: &Path,
    arrays: impl FnOnce(&mut Archive<'_>) -> io::Result<()>,
) -> Result<(), ReportError> {
    replace_file(path, |file| {
        let mut archive = NpzWriter::new(file);
        arrays(&mut archive)?;
        archive.zip_writer().finish().map(drop).map_err(io::Error::from)
    })
}

/// An archive in a file.
pub(super) type Archive<'a> = NpzWriter<&'a mut Output<BufWriter<File>>>;

/// An array of any shape, row by row.
pub(super) fn write_array<T: AutoSerialize>(
    archive: &mut Archive<'_>,
    name: &str,
    shape: &[usize],
    values: impl Iterator<Item = T>,
) -> io::Result<()> {
    archive.zip_writer().start_file(file_name_from_array_name(name), stored())?;
    let mut buffered = BufWriter::with_capacity(BUFFER, archive.zip_writer());
    let shape: Vec<u64> = shape.iter().map(|n| *n as u64).collect();
    let options = WriteOptions::<T>::new().default_dtype().shape(&shape).writer(&mut buffered);
    let mut array = options.begin_nd()?;
    array.extend(values)?;
    array.finish()?;
    buffered.flush()
}

/// A list of numbers.
pub(super) fn write_numbers(archive: &mut Archive<'_>, name: &str, values: &[f64]) -> io::Result<()> {
    write_array(archive, name, &[values.len()], values.iter().copied())
}

/// A list of numbers of points.
pub(super) fn write_integers(archive: &mut Archive<'_>, name: &str, values: &[usize]) -> io::Result<()> {
    // Counts of points fit.
    write_array(archive, name, &[values.len()], values.iter().map(|value| *value as i64))
}

/// Texts of NumPy's fixed width, that of the longest.
pub(super) fn write_texts(archive: &mut Archive<'_>, name: &str, texts: &[&str]) -> io::Result<()> {
    let longest = texts.iter().map(|text| text.chars().count()).max().unwrap_or(0).max(1);
    let text_type: TypeStr = format!("<U{longest}").parse().map_err(io::Error::other)?;
    let options = archive.array::<str>(name, stored())?;
    let mut array = options.dtype(DType::Plain(text_type)).shape(&[texts.len() as u64]).begin_nd()?;
    texts.iter().try_for_each(|text| array.push(text))?;
    array.finish()
}

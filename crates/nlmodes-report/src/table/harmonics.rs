use crate::ReportError;
use crate::output::replace_file;
use nlmodes_modal::ModalBranch;
use npyz::npz::{NpzWriter, file_name_from_array_name};
use npyz::{DType, TypeStr, WriteOptions, WriterBuilder};
use num_complex::Complex64;
use std::io::{self, BufWriter, Seek, Write};
use std::path::Path;

/// Bytes that go to the compressor at once.
const BUFFER: usize = 1 << 16;

/// Writes the motions of a branch as a NumPy archive, which `numpy.load` reads without `allow_pickle`.
///
/// | array | shape | type |
/// | --- | --- | --- |
/// | `omega` | points | float64, rad/s |
/// | `coefficients` | points × coordinates × (harmonics + 1) | complex128, eq. (7); zero where a point has fewer harmonics |
/// | `dof_position_m` | coordinates | float64 |
/// | `dof_kind` | coordinates | Unicode text |
///
/// # Errors
/// [`ReportError::CoefficientShape`] if a point has not the coordinates of the branch, [`ReportError::Io`] if the file cannot
/// be written.
pub fn write_harmonics(path: impl AsRef<Path>, branch: &ModalBranch) -> Result<(), ReportError> {
    let width = common_width(branch)?;
    replace_file(path.as_ref(), |file| {
        let mut archive = NpzWriter::new(file);
        let omega: Vec<f64> = branch.points.iter().map(|point| point.omega).collect();
        write_numbers(&mut archive, "omega", &omega)?;
        write_coefficients(&mut archive, branch, width)?;
        let positions: Vec<f64> = branch.coordinates.iter().map(|coordinate| coordinate.position).collect();
        write_numbers(&mut archive, "dof_position_m", &positions)?;
        let kinds: Vec<&str> = branch.coordinates.iter().map(|coordinate| coordinate.kind.as_str()).collect();
        write_texts(&mut archive, "dof_kind", &kinds)?;
        archive.zip_writer().finish().map(drop).map_err(io::Error::from)
    })
}

/// Harmonics + 1 of the point that has most; 1 for a branch without points.
fn common_width(branch: &ModalBranch) -> Result<usize, ReportError> {
    let width = branch.points.iter().map(|point| point.coefficients.n_harmonics() + 1).max().unwrap_or(1);
    let expected = (branch.coordinates.len(), width);
    for (index, point) in branch.points.iter().enumerate() {
        let found = (point.coefficients.n_coordinates(), point.coefficients.n_harmonics() + 1);
        if found.0 != expected.0 {
            return Err(ReportError::CoefficientShape { point: index, found, expected });
        }
    }
    Ok(width)
}

fn write_coefficients<W: Write + Seek>(
    archive: &mut NpzWriter<W>,
    branch: &ModalBranch,
    width: usize,
) -> io::Result<()> {
    let n_coordinates = branch.coordinates.len();
    let shape = [branch.points.len() as u64, n_coordinates as u64, width as u64];
    archive.zip_writer().start_file(file_name_from_array_name("coefficients"), Default::default())?;
    // The compressor takes its time for each call, however little it is given.
    let mut buffered = BufWriter::with_capacity(BUFFER, archive.zip_writer());
    let options = WriteOptions::<Complex64>::new().default_dtype().shape(&shape).writer(&mut buffered);
    let mut array = options.begin_nd()?;
    for point in &branch.points {
        for d in 0..n_coordinates {
            let own = point.coefficients.of(d).iter().copied();
            array.extend(own.chain(std::iter::repeat(Complex64::default())).take(width))?;
        }
    }
    array.finish()?;
    buffered.flush()
}

pub(super) fn write_numbers<W: Write + Seek>(archive: &mut NpzWriter<W>, name: &str, values: &[f64]) -> io::Result<()> {
    let options = archive.array::<f64>(name, Default::default())?;
    let mut array = options.default_dtype().shape(&[values.len() as u64]).begin_nd()?;
    array.extend(values.iter().copied())?;
    array.finish()
}

/// Texts of NumPy's fixed width, that of the longest.
fn write_texts<W: Write + Seek>(archive: &mut NpzWriter<W>, name: &str, texts: &[&str]) -> io::Result<()> {
    let longest = texts.iter().map(|text| text.chars().count()).max().unwrap_or(0).max(1);
    let text_type: TypeStr = format!("<U{longest}").parse().map_err(io::Error::other)?;
    let options = archive.array::<str>(name, Default::default())?;
    let mut array = options.dtype(DType::Plain(text_type)).shape(&[texts.len() as u64]).begin_nd()?;
    texts.iter().try_for_each(|text| array.push(text))?;
    array.finish()
}

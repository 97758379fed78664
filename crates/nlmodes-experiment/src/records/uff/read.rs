use num_complex::Complex64;

use crate::records::sample_rate::rounding;
use crate::records::uff::header::Line;
use crate::records::uff::lines::{Lines, is_mark};
use crate::records::uff::{
    Abscissa, ByteOrder, Dataset58, Ordinates, Precision, Storage, UffError, bytes, text, units,
};

/// Header lines of a dataset 58, without the one that holds its type.
const HEADER_LINES: usize = 11;

/// Reads all functions of a Universal File, text and binary mixed as they come.
///
/// # Errors
/// [`UffError`]; each names the line.
pub fn read_uff58(file: &[u8]) -> Result<Vec<Dataset58>, UffError> {
    let mut lines = Lines::new(file);
    let mut functions = Vec::new();
    let (mut others, mut system) = (0, None);
    while let Some(line) = lines.next() {
        if !is_mark(line) {
            continue;
        }
        let Some(kind) = lines.next() else { break };
        let kind = Line { bytes: kind, number: lines.number - 1 };
        match storage(kind)? {
            Some(binary) => {
                let units = system.clone();
                functions.push(Dataset58 { units, ..function(&mut lines, binary)? });
            }
            None => {
                others += 1;
                let content: Vec<&[u8]> = std::iter::from_fn(|| lines.next().filter(|line| !is_mark(line))).collect();
                if kind.text(0, 6) == "164" {
                    system = units::read(&content);
                }
            }
        }
    }
    if functions.is_empty() { Err(UffError::NoFunction { datasets: others }) } else { Ok(functions) }
}

/// How a dataset 58 stores its numbers; `None` for one of another type.
fn storage(line: Line<'_>) -> Result<Option<Storage>, UffError> {
    if line.text(0, 6) != "58" {
        return Ok(None);
    }
    if !line.text(6, 7).eq_ignore_ascii_case("b") {
        return Ok(Some(Storage::Text));
    }
    let order = match line.integer(7, 13)? {
        1 => ByteOrder::Little,
        2 => ByteOrder::Big,
        _ => return Err(line.refuse(7, 13, "1 (little-endian) or 2 (big-endian)")),
    };
    match line.integer(13, 19)? {
        2 => {}
        format => return Err(UffError::FloatFormat { line: line.number, format }),
    }
    if line.integer(19, 31)? != HEADER_LINES as i64 {
        return Err(line.refuse(19, 31, "11, the number of header lines of a dataset 58"));
    }
    Ok(Some(Storage::Binary(order)))
}

/// Description of the numbers in the header.
struct Layout {
    precision: Precision,
    complex: bool,
    uneven: bool,
    n_values: usize,
}

fn function(lines: &mut Lines<'_>, storage: Storage) -> Result<Dataset58, UffError> {
    let begin = lines.number;
    let mut header = Vec::with_capacity(HEADER_LINES);
    for found in 0..HEADER_LINES {
        let number = lines.number;
        let bytes = lines.next().ok_or(UffError::HeaderCutOff { line: begin, found })?;
        header.push(Line { bytes, number });
    }
    let layout = layout(header[6])?;
    let mut dataset = described(&header)?;
    let numbers = match storage {
        Storage::Text => {
            let widths = text::widths(layout.precision, layout.complex, layout.uneven);
            text::read(lines, &widths, layout.announced(begin)?)?
        }
        Storage::Binary(order) => binary(lines, &layout, order)?,
    };
    let (values, abscissa) = layout.split(&numbers);
    if let Some(values) = abscissa {
        let digits = match (storage, layout.precision) {
            (Storage::Text, _) => 5e-6,
            (Storage::Binary(_), Precision::Single) => f64::from(f32::EPSILON),
            (Storage::Binary(_), Precision::Double) => 0.0,
        };
        let largest = values.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        dataset.abscissa = Abscissa::Uneven { values, rounding: digits * largest };
    }
    dataset.ordinates = values;
    Ok(dataset)
}

fn layout(line: Line<'_>) -> Result<Layout, UffError> {
    let (precision, complex) = match line.integer(0, 10)? {
        2 => (Precision::Single, false),
        4 => (Precision::Double, false),
        5 => (Precision::Single, true),
        6 => (Precision::Double, true),
        _ => return Err(line.refuse(0, 10, "a type of ordinates: 2, 4, 5 or 6")),
    };
    let n_values = usize::try_from(line.integer(10, 20)?).map_err(|_| line.refuse(10, 20, "a number of values"))?;
    let uneven = match line.integer(20, 30)? {
        0 => true,
        1 => false,
        _ => return Err(line.refuse(20, 30, "0 (uneven abscissa) or 1 (even)")),
    };
    Ok(Layout { precision, complex, uneven, n_values })
}

fn described(header: &[Line<'_>]) -> Result<Dataset58, UffError> {
    let (kind, data) = (header[5], header[6]);
    let step = Abscissa::Even {
        first: data.number(30, 43)?,
        step: data.number(43, 56)?,
        rounding: field_rounding(&data.text(43, 56), data.number(43, 56)?),
        first_rounding: start_rounding(&data.text(30, 43), data.number(30, 43)?),
    };
    let [response, reference] = kind.nodes()?;
    Ok(Dataset58 {
        identification: std::array::from_fn(|i| header[i].text(0, 80)),
        function_type: kind.small(0, 5)?,
        function: kind.small(5, 15)?,
        version: kind.small(15, 20)?,
        load_case: kind.small(20, 30)?,
        response,
        reference,
        z: data.number(56, 69)?,
        abscissa_axis: header[7].axis()?,
        ordinate_axis: header[8].axis()?,
        denominator_axis: header[9].axis()?,
        z_axis: header[10].axis()?,
        ..Dataset58::real(vec![], step)
    })
}

/// Rounding error of the first value: zero is what a clock begins with, and is meant.
fn start_rounding(text: &str, first: f64) -> f64 {
    if first == 0.0 { 0.0 } else { field_rounding(text, first) }
}

/// Rounding error of a number in a field of six digits, possibly without trailing zeros.
fn field_rounding(text: &str, number: f64) -> f64 {
    let six_digits = 0.5 * 10f64.powf(number.abs().log10().floor() - 5.0);
    if six_digits > 0.0 { rounding(text).min(six_digits) } else { rounding(text) }
}

impl Layout {
    /// Numbers of a value.
    fn width(&self) -> usize {
        usize::from(self.uneven) + if self.complex { 2 } else { 1 }
    }

    /// Numbers of the dataset.
    fn announced(&self, line: usize) -> Result<usize, UffError> {
        let too_many = UffError::CutOff { line, announced: self.n_values, found: 0 };
        self.n_values.checked_mul(self.width()).ok_or(too_many)
    }

    /// Ordinates, and the abscissa if given value by value.
    fn split(&self, numbers: &[f64]) -> (Ordinates, Option<Vec<f64>>) {
        let values = || numbers.chunks_exact(self.width());
        let from = usize::from(self.uneven);
        let ordinates = if self.complex {
            Ordinates::Complex(values().map(|value| Complex64::new(value[from], value[from + 1])).collect())
        } else {
            Ordinates::Real(values().map(|value| value[from]).collect())
        };
        (ordinates, self.uneven.then(|| values().map(|value| value[0]).collect()))
    }
}

/// Reads binary numbers and the end mark after them.
fn binary(lines: &mut Lines<'_>, layout: &Layout, order: ByteOrder) -> Result<Vec<f64>, UffError> {
    let line = lines.number;
    let announced = layout.announced(line)?;
    let size = layout.precision.size();
    let rest = lines.rest();
    let cut_off = UffError::CutOff { line, announced, found: rest.len() / size };
    // The length follows from count and precision; the header's own field for it is wrong in many files.
    let length = announced.checked_mul(size).filter(|length| *length <= rest.len()).ok_or(cut_off)?;
    let numbers = &rest[..length];
    lines.skip(length);
    let mark = lines.next().map(|line| if line.is_empty() { lines.next().unwrap_or_default() } else { line });
    match mark {
        Some(mark) if is_mark(mark) => {}
        Some(_) => return Err(UffError::NoEnd { line, bytes: length }),
        None => return Err(UffError::CutOff { line, announced, found: announced }),
    }
    if bytes::is_swapped(numbers, layout.precision, order) {
        return Err(UffError::ByteOrder { line, declared: order.name() });
    }
    Ok(bytes::decode(numbers, layout.precision, order))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A field of six digits is rounded in the sixth, even if a writer drops trailing zeros, unless it has more digits.
    #[test]
    fn a_step_is_rounded_in_its_sixth_digit_or_finer() {
        for (text, step, expected) in [
            ("5.00000E-05", 5e-5, 5e-11),
            ("5.E-05", 5e-5, 5e-11),
            ("0.25", 0.25, 5e-7),
            ("1.00000E+00", 1.0, 5e-6),
            ("12", 12.0, 5e-5),
            ("1.9531250E-05", 1.953_125e-5, 5e-13),
        ] {
            let found = field_rounding(text, step);
            assert!((found / expected - 1.0).abs() < 1e-9, "{text}: {found:e}");
        }
        assert_eq!(field_rounding("0.", 0.0), 0.5, "no step has no digits but those that stand there");
    }
}

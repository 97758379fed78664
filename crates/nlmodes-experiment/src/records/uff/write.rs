use std::fmt::Write as _;
use std::io::Write;

use crate::records::uff::{
    Abscissa, Axis, ByteOrder, Dataset58, Node, Ordinates, Precision, Storage, UffError, bytes, text,
};

/// Letters of a line of numbers.
const LINE: usize = 80;

/// Writes one function with its marks.
///
/// As text an abscissa that is uneven has six digits; header fields have six digits always.
///
/// # Errors
/// [`UffError::Lengths`] if abscissa and ordinates differ in length, [`UffError::Io`].
pub fn write_uff58(
    target: &mut impl Write,
    dataset: &Dataset58,
    storage: Storage,
    precision: Precision,
) -> Result<(), UffError> {
    let numbers = numbers(dataset)?;
    let uneven = matches!(dataset.abscissa, Abscissa::Uneven { .. });
    let complex = matches!(dataset.ordinates, Ordinates::Complex(_));
    write!(target, "{:>6}\n{:>6}", -1, 58)?;
    match storage {
        Storage::Text => writeln!(target, "{:74}", "")?,
        Storage::Binary(order) => {
            let length = numbers.len() * precision.size();
            let order = if order == ByteOrder::Little { 1 } else { 2 };
            writeln!(target, "b{order:>6}{:>6}{:>12}{length:>12}{:>6}{:>6}{:>12}{:>12}", 2, 11, 0, 0, 0, 0)?;
        }
    }
    target.write_all(header(dataset, precision, complex, uneven).as_bytes())?;
    match storage {
        Storage::Text => {
            target.write_all(lines(&numbers, &text::widths(precision, complex, uneven)).as_bytes())?;
        }
        Storage::Binary(order) => target.write_all(&bytes::encode(numbers, precision, order))?,
    }
    writeln!(target, "{:>6}", -1)?;
    Ok(())
}

/// Abscissa and ordinates in the order of the file.
fn numbers(dataset: &Dataset58) -> Result<Vec<f64>, UffError> {
    let ordinates: Vec<Vec<f64>> = match &dataset.ordinates {
        Ordinates::Real(values) => values.iter().map(|x| vec![*x]).collect(),
        Ordinates::Complex(values) => values.iter().map(|z| vec![z.re, z.im]).collect(),
    };
    match &dataset.abscissa {
        Abscissa::Even { .. } => Ok(ordinates.concat()),
        Abscissa::Uneven { values, .. } if values.len() == ordinates.len() => {
            Ok(values.iter().zip(ordinates).flat_map(|(x, y)| std::iter::once(*x).chain(y)).collect())
        }
        Abscissa::Uneven { values, .. } => {
            Err(UffError::Lengths { abscissa: values.len(), ordinates: ordinates.len() })
        }
    }
}

fn header(dataset: &Dataset58, precision: Precision, complex: bool, uneven: bool) -> String {
    let kind = match (precision, complex) {
        (Precision::Single, false) => 2,
        (Precision::Double, false) => 4,
        (Precision::Single, true) => 5,
        (Precision::Double, true) => 6,
    };
    let (first, step) = match dataset.abscissa {
        Abscissa::Even { first, step, .. } => (first, step),
        Abscissa::Uneven { .. } => (0.0, 0.0),
    };
    let mut lines: Vec<String> = dataset.identification.iter().map(|line| format!("{:<80}", cut(line, 80))).collect();
    lines.push(format!(
        "{:>5}{:>10}{:>5}{:>10} {} {}",
        dataset.function_type,
        dataset.function,
        dataset.version,
        dataset.load_case,
        node(&dataset.response),
        node(&dataset.reference)
    ));
    lines.push(format!(
        "{kind:>10}{:>10}{:>10}{}{}{}",
        dataset.ordinates.len(),
        u8::from(!uneven),
        exponential(first, 13),
        exponential(step, 13),
        exponential(dataset.z, 13)
    ));
    let axes = [&dataset.abscissa_axis, &dataset.ordinate_axis, &dataset.denominator_axis, &dataset.z_axis];
    lines.extend(axes.map(axis));
    lines.join("\n") + "\n"
}

fn node(node: &Node) -> String {
    format!("{:<10}{:>10}{:>4}", cut(&node.entity, 10), node.node, node.direction)
}

fn axis(axis: &Axis) -> String {
    let [length, force, temperature] = axis.exponents;
    format!(
        "{:>10}{length:>5}{force:>5}{temperature:>5} {:<20} {:<20}",
        axis.kind,
        cut(&axis.label, 20),
        cut(&axis.unit, 20)
    )
}

/// The beginning of a text, without letters that a line of ASCII cannot hold.
fn cut(text: &str, letters: usize) -> String {
    text.chars().map(|c| if c.is_ascii_graphic() || c == ' ' { c } else { '?' }).take(letters).collect()
}

/// Whole values to lines of at most 80 letters.
fn lines(numbers: &[f64], widths: &[usize]) -> String {
    let value: usize = widths.iter().sum();
    let per_line = (LINE / value).max(1) * widths.len();
    let mut text = String::new();
    for line in numbers.chunks(per_line) {
        for (x, width) in line.iter().zip(widths.iter().cycle()) {
            text.push_str(&exponential(*x, *width));
        }
        text.push('\n');
    }
    text
}

/// A number with an exponent of at least two digits, as Fortran's E13.5 and E20.12.
fn exponential(x: f64, width: usize) -> String {
    let digits = if width == 13 { 5 } else { 12 };
    let plain = format!("{x:.digits$e}");
    let mut text = String::new();
    match plain.split_once('e') {
        Some((mantissa, exponent)) => {
            let (sign, size) = match exponent.strip_prefix('-') {
                Some(size) => ('-', size),
                None => ('+', exponent),
            };
            // Writing to a string cannot fail.
            let _ = write!(text, "{mantissa}e{sign}{size:0>2}");
        }
        None => text = plain,
    }
    format!("{text:>width$}")
}

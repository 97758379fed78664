//! MATLAB files of version 5, uncompressed: the part of the format needed for results.
//!
//! A file is a header of 128 bytes and elements: type, length, bytes up to a multiple of eight. Arrays are elements of
//! elements: flags with the class, dimensions, name, numbers column by column.

use num_complex::Complex64;

const INT8: u32 = 1;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;

const CELL_CLASS: u32 = 1;
const STRUCTURE_CLASS: u32 = 2;
const CHARACTER_CLASS: u32 = 4;
const DOUBLE_CLASS: u32 = 6;
const COMPLEX: u32 = 0x0800;

/// Length of a field's name with the zero at its end.
const FIELD_NAME: usize = 32;

/// A value of MATLAB.
pub(super) enum Value {
    /// Numbers column by column, and their imaginary parts, if any.
    Numbers { shape: Vec<usize>, real: Vec<f64>, imaginary: Option<Vec<f64>> },
    /// A column of text cells.
    Texts(Vec<String>),
    /// A structure; names are shorter than 32 letters.
    Structure(Vec<(&'static str, Value)>),
}

impl Value {
    /// A column of numbers.
    pub fn column(values: impl Iterator<Item = f64>) -> Self {
        let real: Vec<f64> = values.collect();
        Self::Numbers { shape: vec![real.len(), 1], real, imaginary: None }
    }

    /// Numbers that come row by row, the last index fastest.
    pub fn rows(shape: &[usize], values: impl Iterator<Item = f64>) -> Self {
        Self::Numbers { shape: shape.to_vec(), real: by_columns(shape, values), imaginary: None }
    }

    /// Complex numbers that come row by row.
    pub fn complex_rows(shape: &[usize], values: impl Iterator<Item = Complex64>) -> Self {
        let (real, imaginary): (Vec<f64>, Vec<f64>) = values.map(|z| (z.re, z.im)).unzip();
        Self::Numbers {
            shape: shape.to_vec(),
            real: by_columns(shape, real.into_iter()),
            imaginary: Some(by_columns(shape, imaginary.into_iter())),
        }
    }

    fn element(&self, name: &str) -> Vec<u8> {
        let mut inner = Vec::new();
        match self {
            Self::Numbers { shape, real, imaginary } => {
                let complex = if imaginary.is_some() { COMPLEX } else { 0 };
                head(&mut inner, DOUBLE_CLASS | complex, shape, name);
                for part in std::iter::once(real).chain(imaginary) {
                    let bytes: Vec<u8> = part.iter().flat_map(|value| value.to_le_bytes()).collect();
                    push(&mut inner, DOUBLE, &bytes);
                }
            }
            Self::Texts(texts) => {
                head(&mut inner, CELL_CLASS, &[texts.len(), 1], name);
                texts.iter().for_each(|text| inner.extend(characters(text)));
            }
            Self::Structure(fields) => {
                head(&mut inner, STRUCTURE_CLASS, &[1, 1], name);
                // A small element: type and length in four bytes, four bytes of data.
                inner.extend((4 << 16 | INT32).to_le_bytes());
                inner.extend((FIELD_NAME as u32).to_le_bytes());
                let mut names = vec![0; FIELD_NAME * fields.len()];
                for (place, (field, _)) in names.chunks_mut(FIELD_NAME).zip(fields) {
                    place.iter_mut().zip(field.bytes().take(FIELD_NAME - 1)).for_each(|(to, from)| *to = from);
                }
                push(&mut inner, INT8, &names);
                fields.iter().for_each(|(_, value)| inner.extend(value.element("")));
            }
        }
        let mut element = Vec::with_capacity(inner.len() + 8);
        push(&mut element, MATRIX, &inner);
        element
    }
}

/// A file of these variables.
pub(super) fn file(variables: &[(&str, Value)]) -> Vec<u8> {
    let mut header = [b' '; 128];
    let text = concat!("MATLAB 5.0 MAT-file, written by nlmodes ", env!("CARGO_PKG_VERSION"));
    header.iter_mut().zip(text.bytes()).for_each(|(to, from)| *to = from);
    header[116..124].fill(0);
    header[124..].copy_from_slice(&[0x00, 0x01, b'I', b'M']);
    variables.iter().fold(header.to_vec(), |mut bytes, (name, value)| {
        bytes.extend(value.element(name));
        bytes
    })
}

/// Flags, dimensions and name of an array.
fn head(bytes: &mut Vec<u8>, class: u32, shape: &[usize], name: &str) {
    push(bytes, UINT32, &[class.to_le_bytes(), [0; 4]].concat());
    let shape: Vec<u8> = shape.iter().flat_map(|n| (*n as i32).to_le_bytes()).collect();
    push(bytes, INT32, &shape);
    push(bytes, INT8, name.as_bytes());
}

/// A text as an array without a name.
fn characters(text: &str) -> Vec<u8> {
    let units: Vec<u16> = text.encode_utf16().collect();
    let mut inner = Vec::new();
    head(&mut inner, CHARACTER_CLASS, &[usize::from(!units.is_empty()), units.len()], "");
    push(&mut inner, UINT16, &units.iter().flat_map(|unit| unit.to_le_bytes()).collect::<Vec<u8>>());
    let mut element = Vec::new();
    push(&mut element, MATRIX, &inner);
    element
}

/// An element with its padding.
fn push(bytes: &mut Vec<u8>, kind: u32, data: &[u8]) {
    bytes.extend(kind.to_le_bytes());
    bytes.extend((data.len() as u32).to_le_bytes());
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
}

/// From the last index fastest to the first index fastest.
fn by_columns(shape: &[usize], values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut found = vec![0.0; shape.iter().product()];
    let mut index = vec![0; shape.len()];
    for value in values {
        let place = index.iter().zip(shape).rev().fold(0, |place, (i, n)| place * n + i);
        found[place] = value;
        for (i, n) in index.iter_mut().zip(shape).rev() {
            *i += 1;
            if *i < *n {
                break;
            }
            *i = 0;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_index_is_the_fastest_in_the_file() {
        let rows = (0..24).map(f64::from);
        let found = by_columns(&[2, 3, 4], rows);
        for (i, j, k) in (0..2).flat_map(|i| (0..3).flat_map(move |j| (0..4).map(move |k| (i, j, k)))) {
            assert_eq!(found[i + 2 * (j + 3 * k)], (4 * (3 * i + j) + k) as f64);
        }
    }
}

//! Series of numbers for the script, as text of a third of the length of digits.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde::Serialize;

use super::number::rounded;

/// Largest whole number in which a value is expressed.
const FULL_SCALE: f64 = 32_000.0;
/// Represents NaN.
const NOTHING: i16 = i16::MIN;
/// Range of numbers representable in 32 bits with all digits.
const SIZES: std::ops::RangeInclusive<f64> = 1e-30..=1e30;

/// A factor and whole numbers of 16 bits, lowest byte first, in base64.
#[derive(Debug, Serialize)]
pub(super) struct Packed(f64, String);

impl Packed {
    pub fn new(values: &[f64]) -> Self {
        let scale = scale(values.iter().copied());
        Self(scale, text(values.iter().map(|value| whole(*value, scale).to_le_bytes())))
    }
}

/// Rows of equal length with one factor: the factor, the length, and the concatenated rows.
#[derive(Debug, Serialize)]
pub(super) struct PackedRows(f64, usize, String);

impl PackedRows {
    /// Shorter rows are padded with zeros; common trailing zeros are omitted.
    pub fn new(rows: &[Vec<f64>], scale: f64) -> Self {
        let whole: Vec<Vec<i16>> =
            rows.iter().map(|row| row.iter().map(|value| whole(*value, scale)).collect()).collect();
        let used = |row: &Vec<i16>| row.iter().rposition(|value| *value != 0).map_or(0, |last| last + 1);
        let width = whole.iter().map(used).max().unwrap_or(0);
        let padded =
            |row: &Vec<i16>| (0..width).map(|n| row.get(n).copied().unwrap_or(0).to_le_bytes()).collect::<Vec<_>>();
        Self(scale, width, text(whole.iter().flat_map(padded)))
    }

    /// The numbers again.
    #[cfg(test)]
    pub fn values(&self) -> Vec<Vec<f64>> {
        let bytes = BASE64_STANDARD.decode(&self.2).unwrap();
        let number = |b: &[u8]| f64::from(i16::from_le_bytes([b[0], b[1]])) * self.0;
        bytes.chunks(2 * self.1.max(1)).map(|row| row.chunks(2).map(number).collect()).collect()
    }

    /// Whether all numbers are zero.
    pub fn is_zero(&self) -> bool {
        self.1 == 0
    }
}

/// A column: numbers of 32 bits, lowest byte first, in base64, if representable; otherwise unchanged.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub(super) enum Column {
    /// NaN if missing.
    Short(String),
    Long(Vec<f64>),
}

impl Column {
    pub fn new(values: Vec<f64>) -> Self {
        if values.iter().all(|v| *v == 0.0 || !v.is_finite() || SIZES.contains(&v.abs())) {
            return Self::Short(text(
                values.iter().map(|v| (if v.is_finite() { *v as f32 } else { f32::NAN }).to_le_bytes()),
            ));
        }
        Self::Long(values.into_iter().map(|v| rounded(v, 7)).collect())
    }
}

fn text<const N: usize>(numbers: impl Iterator<Item = [u8; N]>) -> String {
    BASE64_STANDARD.encode(numbers.flatten().collect::<Vec<u8>>())
}

/// The unit of one integer, such that the largest value fits.
pub(super) fn scale(values: impl Iterator<Item = f64>) -> f64 {
    let largest = values.filter(|value| value.is_finite()).fold(0.0, |m: f64, value| m.max(value.abs()));
    if largest > 0.0 { rounded(largest / FULL_SCALE, 8) } else { 1.0 }
}

fn whole(value: f64, scale: f64) -> i16 {
    // Within ±32 001 by the choice of the scale; a factor that underflows to zero means that all values are invisible.
    let number = (value / scale).round();
    if number.is_finite() { number as i16 } else { NOTHING }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(text: &str) -> Vec<u8> {
        BASE64_STANDARD.decode(text).unwrap()
    }

    #[test]
    fn whole_numbers_stand_for_their_values_whatever_the_unit() {
        for unit in [1.0, 1e-9, 3e7] {
            let values = [0.0, 1.0, -0.25, f64::NAN, 0.123_456].map(|v| v * unit);
            let Packed(scale, text) = Packed::new(&values);
            let found: Vec<i16> = bytes(&text).chunks(2).map(|b| i16::from_le_bytes([b[0], b[1]])).collect();
            assert_eq!(found[3], NOTHING);
            for (k, value) in values.iter().enumerate().filter(|(_, value)| value.is_finite()) {
                assert!((f64::from(found[k]) * scale - value).abs() < 2e-5 * unit, "{value}");
            }
        }
    }

    #[test]
    fn rows_end_in_zeros_and_columns_keep_what_32_bits_do_not_hold() {
        let PackedRows(_, width, text) = PackedRows::new(&[vec![1.0, 0.5, 0.0], Vec::new(), vec![0.25]], 1e-4);
        let found: Vec<i16> = bytes(&text).chunks(2).map(|b| i16::from_le_bytes([b[0], b[1]])).collect();
        assert_eq!((width, found), (2, vec![10_000, 5_000, 0, 0, 2_500, 0]));
        assert!(PackedRows::new(&[vec![0.0], Vec::new()], 1.0).is_zero());
        let Column::Short(text) = Column::new(vec![0.0, 287.880_1, f64::INFINITY]) else { panic!("fits") };
        let found: Vec<f32> = bytes(&text).chunks(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        assert!(found[0] == 0.0 && found[1] == 287.880_1_f32 && found[2].is_nan());
        assert!(matches!(Column::new(vec![1.0, 1e-40]), Column::Long(_)));
    }
}

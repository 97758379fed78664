//! Dataset 164: the units of all numbers of a file.

use crate::records::UnitSystem;
use crate::records::uff::header::{Line, parse};

/// Columns of a factor.
const WIDTH: usize = 25;

/// Reads the lines of the dataset: code and name, then the factors of length, force and temperature, by which numbers
/// of the file are divided to be in SI. `None` where they are not there.
pub fn read(lines: &[&[u8]]) -> Option<UnitSystem> {
    let [head, factors, ..] = lines else { return None };
    let line = |bytes| Line { bytes, number: 0 };
    let words = line(factors).text(0, factors.len());
    let spaced: Vec<f64> = words.split_whitespace().map_while(parse).collect();
    // Numbers of Fortran may touch.
    let fixed = || (0..2).filter_map(|i| parse(&line(factors).text(WIDTH * i, WIDTH * (i + 1)))).collect();
    let numbers: Vec<f64> = if spaced.len() >= 2 { spaced } else { fixed() };
    let [length, force, ..] = numbers[..] else { return None };
    let is_sound = |x: f64| x > 0.0 && x.is_finite();
    (is_sound(length) && is_sound(force)).then(|| UnitSystem { name: line(head).text(10, 30), length, force })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_read_as_fortran_writes_them() {
        let head = b"        10mm (newton)                  2";
        let touching = b"  1.00000000000000000D+03  1.00000000000000000D+00  1.00000000000000000D+00";
        let found = read(&[head, touching, b"  2.73149999999999977D+02"]).unwrap();
        assert_eq!((found.name.as_str(), found.length, found.force), ("mm (newton)", 1e3, 1.0));
        let dense = b"-1.0000000000000000000D+03-1.00000000000000000000D+0";
        assert!(read(&[head, dense]).is_none() && read(&[head]).is_none());
    }
}

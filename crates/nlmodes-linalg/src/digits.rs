use std::fmt;

/// How many significant digits the entries of a matrix were written with, and so what their last one leaves open.
///
/// ```
/// use nlmodes_linalg::Digits;
/// let written = [1.234567891e5, -3.141592653e-2, 2.718281828, 5.772156649e3];
/// assert_eq!(Digits::of(written), Digits::Decimal(10));
/// // Half a unit of the tenth digit is at most so much off, 1/√3 of it in the root of the mean square.
/// assert!((Digits::Decimal(10).deviation(1.234567891e5) - 0.5e-4 / 3_f64.sqrt()).abs() < 1e-19);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Digits {
    /// So many decimal digits, as texts have them.
    Decimal(u32),
    /// So many binary ones: 53 in double precision, 24 in single.
    Binary(u32),
}

/// Values that are taken as a sample of a matrix.
const SAMPLE: usize = 4096;
/// With fewer different values nothing can be seen: they may be round numbers.
const DIFFERENT: usize = 4;
/// Fewer decimal digits are written by nobody but by those who mean them exactly.
const FEWEST: u32 = 4;
/// More decimal digits cannot be distinguished from those of double precision.
const MOST: u32 = 14;
/// Values below this share of the largest are what was left where others cancelled: they have few digits by chance.
const LEFT_OVER: f64 = 1e-12;
/// Digits below the longest number of a text from which on a number is a round one.
const ROUND: u32 = 4;
/// Binary digits up to which a number that is not whole is exact: one with as many decimal digits has more of them.
const EXACT: u32 = 40;
/// Binary digits of single precision, and those that most numbers in it need.
const SINGLE: [u32; 2] = [24, 23];

impl Digits {
    /// Those of `f64`.
    pub const DOUBLE: Self = Self::Binary(f64::MANTISSA_DIGITS);

    /// The digits that these values show: those of the longest number, if most of the others are as long, as in numbers
    /// that were cut off there. It does not matter which file they come from, nor whether they went through another one
    /// or another power of ten; zeros that a text left away at the end are none.
    ///
    /// Round numbers, which are what they are, show nothing: they have all digits of double precision.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let values = sample(values);
        if values.len() < DIFFERENT {
            return Self::DOUBLE;
        }
        let bits: Vec<u32> = values.iter().map(|v| binary(*v)).collect();
        let long = bits.iter().filter(|bits| **bits >= SINGLE[1]).count();
        if bits.iter().all(|bits| *bits <= SINGLE[0]) && 2 * long >= bits.len() {
            return Self::Binary(SINGLE[0]);
        }
        // Decimals that were cut off somewhere seldom are halves, quarters or eighths.
        let mut broken = values.iter().zip(&bits).filter(|(v, _)| v.fract() != 0.0).map(|(_, bits)| *bits).peekable();
        if broken.peek().is_some() && broken.all(|bits| bits <= EXACT) {
            return Self::DOUBLE;
        }
        let Some(digits) = values.iter().map(|v| decimal(*v)).collect::<Option<Vec<u32>>>() else {
            return Self::DOUBLE;
        };
        let most = digits.iter().copied().max().unwrap_or(0);
        let long = digits.iter().filter(|digits| **digits == most).count();
        let ragged = digits.iter().filter(|digits| **digits + ROUND > most).count();
        if most < FEWEST || 2 * long < ragged { Self::DOUBLE } else { Self::Decimal(most) }
    }

    /// Root of the mean square of what is cut off `value`: half a unit of the last digit over √3.
    pub fn deviation(self, value: f64) -> f64 {
        if value == 0.0 || !value.is_finite() {
            return 0.0;
        }
        let unit = match self {
            Self::Decimal(digits) => 10f64.powi(value.abs().log10().floor() as i32 + 1 - digits as i32),
            Self::Binary(digits) => 2f64.powi(value.abs().log2().floor() as i32 + 1 - digits as i32),
        };
        0.5 * unit / 3f64.sqrt()
    }
}

impl fmt::Display for Digits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Decimal(digits) => write!(f, "{digits} digits"),
            Self::Binary(24) => write!(f, "single precision"),
            Self::Binary(53) => write!(f, "double precision"),
            Self::Binary(digits) => write!(f, "{digits} binary digits"),
        }
    }
}

/// The nearest double with this many decimal digits, so that its shortest text is short; the value itself if it is not
/// finite.
pub fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

/// Sizes that differ, of values evenly taken from all.
fn sample(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let (mut kept, mut step, mut passed) = (Vec::new(), 1, 0);
    for value in values.into_iter().map(f64::abs).filter(|v| *v > 0.0 && v.is_normal()) {
        if passed % step == 0 {
            kept.push(value);
        }
        passed += 1;
        if kept.len() >= 2 * SAMPLE {
            kept = kept.into_iter().step_by(2).collect();
            step *= 2;
        }
    }
    kept.sort_by(f64::total_cmp);
    kept.dedup();
    let least = LEFT_OVER * kept.last().copied().unwrap_or(0.0);
    kept.retain(|value| *value > least);
    kept
}

/// Binary digits that a value needs.
fn binary(value: f64) -> u32 {
    let fraction = value.to_bits() & ((1 << (f64::MANTISSA_DIGITS - 1)) - 1);
    if fraction == 0 { 1 } else { f64::MANTISSA_DIGITS - fraction.trailing_zeros() }
}

/// Decimal digits that a value needs, up to [`MOST`] and the rounding of a product; none if it needs more.
fn decimal(value: f64) -> Option<u32> {
    let text = format!("{value:.*e}", MOST as usize - 1);
    let near: f64 = text.parse().ok()?;
    if (near - value).abs() > 2.0 * f64::EPSILON * value {
        return None;
    }
    let mantissa = text.split('e').next()?.trim_end_matches('0');
    Some(mantissa.bytes().filter(u8::is_ascii_digit).count() as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Irregular numbers over some decades.
    fn numbers() -> impl Iterator<Item = f64> {
        (1..200).map(|k| (k as f64 * 0.754_877_666_246_69).fract() * 10f64.powi(k % 9 - 2) * (-1f64).powi(k))
    }

    #[test]
    fn digits_of_texts_are_those_that_were_written_in_any_unit() {
        for digits in [4_u32, 5, 6, 7, 8, 10, 12, 14] {
            for unit in [1.0, 1e3, 1e-6, 1e9] {
                let written = numbers().map(|v| unit * format!("{v:.*e}", digits as usize - 1).parse::<f64>().unwrap());
                assert_eq!(Digits::of(written), Digits::Decimal(digits), "{unit}");
            }
        }
        assert_eq!(Digits::of(numbers().map(|v| f64::from(v as f32))), Digits::Binary(24));
        assert_eq!(Digits::of(numbers()), Digits::DOUBLE);
    }

    #[test]
    fn round_numbers_are_exact() {
        for exact in [&[2.0, -1.0, 1.0][..], &[1.5, -0.5, 12.25, 3.0, 7.0], &[0.0], &[]] {
            assert_eq!(Digits::of(exact.iter().copied()), Digits::DOUBLE);
        }
        // What is left where numbers in single precision cancel has few binary digits, and does not count.
        let left_over = (1..300).map(|k| f64::from(k) * 2f64.powi(-60));
        assert_eq!(Digits::of(numbers().map(|v| f64::from(v as f32)).chain(left_over)), Digits::Binary(24));
        // One number with more digits than the others does not make these rounded ones.
        let steel = [6.99972e6, 3.49986e6, 2.33324e6, 1.399944e7, 1.16662e6, 4.66648e6];
        assert_eq!(Digits::of(steel), Digits::DOUBLE);
        // A beam of equal elements, whose stiffness has short binary fractions.
        let beam = [5980078.125, 11960156.25, 159468.75, 318937.5, 5670.0, 2835.0, 11340.0];
        assert_eq!(Digits::of(beam), Digits::DOUBLE);
    }

    #[test]
    fn what_is_cut_off_has_the_deviation_that_is_said() {
        for (digits, cut) in [
            (Digits::Decimal(6), &(|v: f64| format!("{v:.5e}").parse().unwrap()) as &dyn Fn(f64) -> f64),
            (Digits::Binary(24), &|v| f64::from(v as f32)),
        ] {
            let squares = numbers().map(|v| ((cut(v) - v) / digits.deviation(v)).powi(2));
            let mean = squares.sum::<f64>() / numbers().count() as f64;
            assert!((mean - 1.0).abs() < 0.2, "{mean}");
        }
        assert_eq!(Digits::DOUBLE.deviation(0.0), 0.0);
    }
}

//! Units of axes: the multiple of an SI unit in which the numbers are easy to read.

/// A multiple of an SI unit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Unit {
    /// As in the axis label: `mm`, `kN`.
    pub symbol: String,
    /// Number of multiples in one SI unit.
    pub per_si: f64,
}

const SMALL: [(i32, &str); 4] = [(0, ""), (-3, "m"), (-6, "µ"), (-9, "n")];
const LARGE: [(i32, &str); 4] = [(0, ""), (3, "k"), (6, "M"), (9, "G")];

impl Unit {
    /// The unit itself, times a power of a thousand if the numbers would be long: `10³ m/s²`.
    pub fn plain(symbol: &str, largest: f64) -> Self {
        match thousands(largest) {
            Some(exponent @ (-3 | 3 | 6 | 9)) => {
                Self { symbol: format!("10{} {symbol}", superscript(exponent)), per_si: 10f64.powi(-exponent) }
            }
            _ => Self { symbol: symbol.into(), per_si: 1.0 },
        }
    }

    /// Prefixed to be smaller if the numbers are small: lengths, times, velocities.
    pub fn fine(symbol: &str, largest: f64) -> Self {
        Self::prefixed(symbol, thousands(largest), &SMALL)
    }

    /// Prefixed to be larger if the numbers are large: forces.
    pub fn coarse(symbol: &str, largest: f64) -> Self {
        Self::prefixed(symbol, thousands(largest), &LARGE)
    }

    /// Prefixed either way: impulses.
    pub fn both(symbol: &str, largest: f64) -> Self {
        if largest < 1.0 { Self::fine(symbol, largest) } else { Self::coarse(symbol, largest) }
    }

    fn prefixed(symbol: &str, exponent: Option<i32>, prefixes: &[(i32, &str)]) -> Self {
        let found = prefixes.iter().find(|(power, _)| Some(*power) == exponent);
        let (power, prefix) = found.copied().unwrap_or((0, ""));
        Self { symbol: format!("{prefix}{symbol}"), per_si: 10f64.powi(-power) }
    }
}

/// Exponent, a multiple of three, of the power of ten that scales `largest` to 0.2 … 200.
fn thousands(largest: f64) -> Option<i32> {
    let decades = (largest.abs() / 0.2).log10();
    decades.is_finite().then(|| 3 * (decades / 3.0).floor() as i32)
}

/// An integer in superscript digits.
pub(crate) fn superscript(exponent: i32) -> String {
    let raised = |digit: char| match digit {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '0' => '⁰',
        // The others are contiguous: ⁴ … ⁹.
        other => char::from_u32('⁴' as u32 + (other as u32 - '4' as u32)).unwrap_or(other),
    };
    exponent.to_string().chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prefix_brings_the_numbers_near_one() {
        assert_eq!(Unit::fine("m", 1.03e-3).symbol, "mm");
        assert_eq!(Unit::fine("s", 0.0165).per_si, 1000.0);
        assert_eq!(Unit::fine("m", 0.5).symbol, "m");
        assert_eq!(Unit::fine("m", 20.0).symbol, "m");
        assert_eq!(Unit::coarse("N", 1.2e9).symbol, "GN");
        assert_eq!(Unit::plain("m/s²", 4.0e4).symbol, "10³ m/s²");
    }

    #[test]
    fn values_without_a_size_keep_the_unit() {
        for largest in [0.0, f64::NAN, f64::INFINITY] {
            assert_eq!(Unit::fine("m", largest), Unit { symbol: "m".into(), per_si: 1.0 });
        }
    }

    #[test]
    fn exponents_are_raised() {
        assert_eq!(superscript(-10), "⁻¹⁰");
        assert_eq!(superscript(2456789), "²⁴⁵⁶⁷⁸⁹");
        assert_eq!(superscript(13), "¹³");
    }
}

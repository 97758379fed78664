//! Numbers: rounded for the script, and in readable form.

use crate::unit::superscript;

/// The nearest double with this many decimal digits, so that its shortest form is short.
pub(super) fn rounded(value: f64, digits: usize) -> f64 {
    let text = format!("{value:.*e}", digits.saturating_sub(1));
    text.parse().unwrap_or(value)
}

/// With this many significant digits: `4.97`, `1.24×10⁹`; a dash if not finite.
pub(super) fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    if value == 0.0 {
        return "0".into();
    }
    let exponential = format!("{value:.*e}", digits.saturating_sub(1));
    let (mantissa, exponent) = exponential.split_once('e').unwrap_or((&exponential, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let text = if (-3..5).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{mantissa}×10{}", superscript(exponent))
    };
    text.replace('-', "−")
}

/// An angular frequency in rad/s, as hertz.
pub(super) fn hertz(omega: f64) -> String {
    significant(omega / std::f64::consts::TAU, 7)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_say_what_they_are() {
        assert_eq!(significant(60.786607272, 7), "60.78661");
        assert_eq!(significant(-1.5e8, 3), "−1.50×10⁸");
        assert_eq!(significant(99_999.7, 5), "1.0000×10⁵");
        assert_eq!(significant(0.00123, 2), "0.0012");
        assert_eq!(significant(f64::NAN, 4), "–");
        assert_eq!(significant(0.0, 4), "0");
    }

    #[test]
    fn rounding_keeps_the_digits_that_were_asked_for() {
        let value = 60.786_607_272_015_31;
        assert_eq!(rounded(value, 10), 60.786_607_27);
        assert!(rounded(f64::NAN, 5).is_nan() && rounded(f64::INFINITY, 5).is_infinite());
        assert_eq!(rounded(0.0, 5), 0.0);
    }
}

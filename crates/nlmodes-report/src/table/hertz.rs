use std::f64::consts::TAU;

/// The frequency of an angular frequency, `ω/2π` in Hz, to the 15 digits of a double: a given frequency is reproduced
/// exactly, 22.829 and not 22.828999999999997.
pub fn hertz(omega: f64) -> f64 {
    let hertz = omega / TAU;
    format!("{hertz:.14e}").parse().unwrap_or(hertz)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequencies_that_were_given_come_back_and_others_differ_by_rounding() {
        let given = (1..20_000).map(|k| f64::from(k) * 1e-3).collect::<Vec<_>>();
        let changed = given.iter().filter(|hz| *hz * TAU / TAU != **hz).count();
        assert!(changed > 100, "so many are lost by the division: {changed}");
        for given in given.into_iter().map(|hz| format!("{hz:.3}").parse::<f64>().unwrap()) {
            assert_eq!(hertz(given * TAU), given);
        }
        // Half of the 15th digit, and the rounding of the division.
        let omega = 123.456_789_012_345_67;
        assert!((hertz(omega) * TAU / omega - 1.0).abs() < 5e-15 + f64::EPSILON);
        assert!(hertz(f64::NAN).is_nan() && hertz(0.0) == 0.0);
    }
}

use crate::records::{RecordError, time_axis};

/// Relative difference of sampling rates that counts as agreement.
const AGREEMENT: f64 = 1e-6;

/// A sampling rate, and how exactly it is known: headers and time columns are written with few digits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SampleRate {
    /// Rate, Hz.
    pub hz: f64,
    /// Largest relative error that the digits leave with which it was written.
    pub relative_error: f64,
}

impl SampleRate {
    /// A rate that is known exactly.
    pub fn exact(hz: f64) -> Self {
        Self { hz, relative_error: 0.0 }
    }

    /// Of a sampling interval (s) that was written with the given rounding error (s).
    pub fn of_interval(interval: f64, rounding: f64) -> Self {
        Self { hz: 1.0 / interval, relative_error: (rounding / interval).abs() }
    }

    /// Of time stamps (s), each with the given rounding error (s): of all of them, so that rounding counts little.
    ///
    /// # Errors
    /// [`RecordError::Empty`] with fewer than two, [`RecordError::UnevenTime`] if they are not uniform.
    pub fn of_times(times: &[f64], rounding: f64) -> Result<Self, RecordError> {
        let (interval, relative_error) = time_axis::interval(times, rounding)?;
        Ok(Self { hz: 1.0 / interval, relative_error })
    }

    /// The declared rate if this one agrees with it to 1e-6 and the digits it was written with.
    ///
    /// # Errors
    /// [`RecordError::RateDisagrees`].
    pub fn agree(self, declared: f64) -> Result<f64, RecordError> {
        let relative = (self.hz / declared - 1.0).abs();
        let limit = AGREEMENT + self.relative_error;
        // The limit itself counts as agreement, whatever its last bit.
        if relative <= limit * (1.0 + 1e-9) {
            return Ok(declared);
        }
        Err(RecordError::RateDisagrees { declared, found: self.hz, relative, limit })
    }
}

/// Half a unit of the last written digit of a number.
pub fn rounding(text: &str) -> f64 {
    let (mantissa, exponent) = text.split_once(['e', 'E', 'd', 'D']).unwrap_or((text, "0"));
    let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.trim_end().len());
    let exponent = exponent.trim().parse::<i32>().unwrap_or(0);
    0.5 * 10f64.powi(exponent.saturating_sub(decimals as i32))
}

/// Decimals and significant digits of a column of numbers: the maximum, since some writers drop trailing zeros.
#[derive(Debug, Clone, Copy)]
pub struct Digits {
    finest: f64,
    significant: i32,
    largest: f64,
}

impl Default for Digits {
    fn default() -> Self {
        Self { finest: f64::INFINITY, significant: 0, largest: 0.0 }
    }
}

impl Digits {
    /// Processes a number of the column as written.
    pub fn see(&mut self, text: &str, value: f64) {
        self.finest = self.finest.min(rounding(text));
        let mantissa = text.split(['e', 'E', 'd', 'D']).next().unwrap_or_default();
        let digits = mantissa.chars().filter(char::is_ascii_digit).skip_while(|digit| *digit == '0').count();
        self.significant = self.significant.max(i32::try_from(digits).unwrap_or(i32::MAX));
        if value.is_finite() {
            self.largest = self.largest.max(value.abs());
        }
    }

    /// Rounding error of the number in which it is largest: a fixed number of decimals, or of significant digits.
    pub fn rounding(&self) -> f64 {
        let decade = if self.largest > 0.0 { self.largest.log10().floor() as i32 + 1 } else { 0 };
        let by_significant = 0.5 * 10f64.powi(decade.saturating_sub(self.significant));
        if self.significant > 0 { self.finest.max(by_significant) } else { self.finest }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_agree_to_a_millionth_and_the_digits_they_were_written_with() {
        assert_eq!(SampleRate::exact(20_000.0).agree(20_000.0 * (1.0 + 9e-7)).unwrap(), 20_000.0 * (1.0 + 9e-7));
        assert!(SampleRate::exact(20_000.0).agree(20_000.1).is_err());
        // 1/51200 s with six digits.
        let written = SampleRate::of_interval(1.95313e-5, rounding("1.95313e-05"));
        assert!((written.hz / 51_200.0 - 1.0).abs() > 1e-6);
        assert_eq!(written.agree(51_200.0).unwrap(), 51_200.0);
        assert!(written.agree(51_201.0).is_err());
    }

    #[test]
    fn lost_samples_and_standing_clocks_are_seen() {
        let mut times: Vec<f64> = (0..1000).map(|j| (j as f64 / 48_000.0 * 1e6).round() * 1e-6).collect();
        let rate = SampleRate::of_times(&times, rounding("0.000021")).unwrap();
        assert_eq!(rate.agree(48_000.0).unwrap(), 48_000.0);
        times.remove(500);
        assert!(matches!(SampleRate::of_times(&times, 5e-7), Err(RecordError::UnevenTime { .. })));
        assert!(SampleRate::of_times(&[1.0, 1.0, 1.0], 0.0).is_err());
        assert!(SampleRate::of_times(&[0.0, f64::NAN, 1.0], 0.0).is_err());
        assert!(SampleRate::of_times(&[0.0], 0.0).is_err());
    }

    #[test]
    fn the_last_digit_is_counted() {
        assert!((rounding("0.00005") - 5e-6).abs() < 1e-20);
        assert!((rounding(" 5.00000e-05") - 5e-11).abs() < 1e-24);
        assert_eq!(rounding("12"), 0.5);
        let column = |texts: &[&str]| {
            let mut digits = Digits::default();
            texts.iter().for_each(|text| digits.see(text, text.parse().unwrap()));
            digits.rounding()
        };
        // Three decimals; six significant digits; zeros dropped at the end.
        assert!((column(&["0.000", "0.001", "12.345"]) - 5e-4).abs() < 1e-15);
        assert!((column(&["0", "0.000200", "12.3456"]) - 5e-5).abs() < 1e-15);
        assert!((column(&["0", "0.0002", "0.5", "0.9999"]) - 5e-5).abs() < 1e-15);
    }
}

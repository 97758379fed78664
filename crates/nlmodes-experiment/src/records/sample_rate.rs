use crate::records::RecordError;

/// Relative difference of sampling rates that counts as agreement.
const AGREEMENT: f64 = 1e-6;
/// A time stamp may stand this share of the sampling interval off an even axis, beside the rounding of its text.
const JITTER: f64 = 0.1;

/// A sampling rate, and how exactly it is known: headers and time columns are written with few digits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SampleRate {
    /// Rate, Hz.
    pub hz: f64,
    /// Relative error from the digits with which it was written.
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

    /// Of time stamps (s), each with the given rounding error (s).
    ///
    /// # Errors
    /// [`RecordError::Empty`] with fewer than two, [`RecordError::UnevenTime`] if they do not go on evenly.
    pub fn of_times(times: &[f64], rounding: f64) -> Result<Self, RecordError> {
        let n = times.len();
        let [Some(first), Some(last)] = [times.first(), times.last()] else {
            return Err(RecordError::Empty { samples: n });
        };
        if n < 2 {
            return Err(RecordError::Empty { samples: n });
        }
        let interval = (last - first) / (n - 1) as f64;
        // NaN and a time that stands still or runs back fail here too.
        let allowed = JITTER + 2.0 * rounding / interval.abs();
        let deviation = |j: usize| ((times[j] - first) / interval - j as f64).abs();
        let uneven = (0..n).find(|j| deviation(*j).is_nan() || deviation(*j) > allowed);
        if !(interval > 0.0 && interval.is_finite()) || uneven.is_some() {
            let sample = uneven.unwrap_or(n - 1);
            return Err(RecordError::UnevenTime { sample, deviation: deviation(sample) });
        }
        Ok(Self { hz: 1.0 / interval, relative_error: 2.0 * rounding / (last - first) })
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

/// Half a unit of the last digit of a number as it is written.
pub fn rounding(text: &str) -> f64 {
    let (mantissa, exponent) = text.split_once(['e', 'E', 'd', 'D']).unwrap_or((text, "0"));
    let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.trim_end().len());
    let exponent = exponent.trim().parse::<i32>().unwrap_or(0);
    0.5 * 10f64.powi(exponent.saturating_sub(decimals as i32))
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
    }
}

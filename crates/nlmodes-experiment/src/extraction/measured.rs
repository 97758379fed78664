/// A figure with its standard error from repeated periods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// The figure, from all periods together.
    pub value: f64,
    /// Standard error of the mean of the single periods; NaN with fewer than two.
    pub uncertainty: f64,
}

impl Measured {
    /// The figure of all periods with those of single ones.
    pub fn new(value: f64, repeated: &[f64]) -> Self {
        Self { value, uncertainty: spread(repeated) / (repeated.len() as f64).sqrt() }
    }

    /// An angle (rad): single ones are taken on the branch next to it.
    pub fn angle(value: f64, repeated: &[f64]) -> Self {
        let near: Vec<f64> = repeated.iter().map(|angle| value + wrapped(angle - value)).collect();
        Self::new(value, &near)
    }

    /// The figure with a further standard error, which all periods share.
    #[must_use]
    pub fn and(self, error: f64) -> Self {
        Self { uncertainty: self.uncertainty.hypot(error), ..self }
    }

    /// The figure in another unit.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self { value: self.value * factor, uncertainty: self.uncertainty * factor.abs() }
    }
}

/// Standard deviation of one of the values; NaN with fewer than two.
pub fn spread(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    if n < 2.0 {
        return f64::NAN;
    }
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt()
}

/// The angle between −π and π.
pub fn wrapped(angle: f64) -> f64 {
    angle - std::f64::consts::TAU * (angle / std::f64::consts::TAU).round()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_standard_error_is_that_of_the_mean() {
        let measured = Measured::new(2.0, &[1.0, 2.0, 3.0, 2.0]);
        assert!((measured.uncertainty - (2.0f64 / 3.0).sqrt() / 2.0).abs() < 1e-15);
        assert!(Measured::new(2.0, &[2.0]).uncertainty.is_nan());
        let angle = Measured::angle(3.13, &[3.13, -3.15]);
        assert!(angle.uncertainty < 0.01, "{angle:?}");
    }
}

//! Mean, standard deviation and quantiles.

use serde::Serialize;

/// Probabilities of the quantiles.
const SHARES: [f64; 7] = [0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99];

/// Mean, standard deviation and quantiles of values.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spread {
    /// Number of values.
    pub count: usize,
    /// Mean.
    pub mean: f64,
    /// Standard error of the mean of independent values; smaller in fact for points of a Sobol' sequence or Latin
    /// hypercube.
    pub mean_error: f64,
    /// Standard deviation, of n − 1.
    pub std: f64,
    /// Its standard error of independent values, from their fourth moment.
    pub std_error: f64,
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// Probabilities and quantiles.
    pub quantiles: Vec<[f64; 2]>,
}

impl Spread {
    /// Statistics of these values; `None` if there are none.
    pub fn new(values: &[f64]) -> Option<Self> {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (n, min, max) = (values.len() as f64, *sorted.first()?, *sorted.last()?);
        // About the midpoint of the range, to avoid cancellation if the scatter is small.
        let middle = 0.5 * (min + max);
        let mean = middle + values.iter().map(|x| x - middle).sum::<f64>() / n;
        let power = |k: i32| values.iter().map(|x| (x - mean).powi(k)).sum::<f64>();
        let squares = power(2);
        let std = if n > 1.0 { (squares / (n - 1.0)).sqrt() } else { f64::NAN };
        // Of the variance it is √((m₄ − (n − 3)/(n − 1) σ⁴)/n).
        let of_variance = ((power(4) / n - (n - 3.0) / (n - 1.0) * std.powi(4)) / n).max(0.0).sqrt();
        let std_error = if std > 0.0 { of_variance / (2.0 * std) } else { 0.0 };
        let quantiles = SHARES.iter().map(|share| [*share, quantile(&sorted, *share)]).collect();
        let (count, mean_error) = (values.len(), std / n.sqrt());
        Some(Self { count, mean, mean_error, std, std_error, min, max, quantiles })
    }
}

/// The quantile of sorted values, by linear interpolation between two of them (type 7 of Hyndman and Fan, as NumPy).
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = share * last as f64;
    let below = (place as usize).min(last);
    let above = (below + 1).min(last);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_those_of_numpy() {
        // np.mean, np.std(ddof=1) and np.quantile of [3, 1, 4, 1, 5, 9, 2, 6].
        let spread = Spread::new(&[3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0]).unwrap();
        assert_eq!((spread.count, spread.min, spread.max), (8, 1.0, 9.0));
        assert!((spread.mean - 3.875).abs() < 1e-15 && (spread.std - 2.748376143938713).abs() < 1e-14);
        let wanted = [1.0, 1.0, 1.75, 3.5, 5.25, 7.949999999999999, 8.79];
        for ([_, value], wanted) in spread.quantiles.iter().zip(wanted) {
            assert!((value - wanted).abs() < 1e-12, "{value} {wanted}");
        }
        assert_eq!(Spread::new(&[]), None);
        // Of n values on two points the deviation is known exactly: the fourth moment is the square of the variance.
        let even = Spread::new(&[1.0, 2.0].repeat(500)).unwrap();
        assert!(even.std_error < 0.05 * even.std / 1000f64.sqrt(), "{}", even.std_error);
        let uniform = Spread::new(&(0..1000).map(f64::from).collect::<Vec<_>>()).unwrap();
        // √((9/5 − 1)/(4 n)) of it for a uniform distribution.
        assert!((uniform.std_error / uniform.std - (0.2f64 / 1000.0).sqrt()).abs() < 1e-4, "{}", uniform.std_error);
    }
}

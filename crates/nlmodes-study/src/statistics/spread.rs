//! Mean, deviation and quantiles.

use serde::Serialize;

/// Shares of all values below the quantiles that are given.
const SHARES: [f64; 7] = [0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99];

/// Mean, deviation and quantiles of values.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spread {
    /// Number of values.
    pub count: usize,
    /// Mean.
    pub mean: f64,
    /// Standard error of the mean of so many independent values; points of a Sobol' sequence or Latin hypercube come
    /// closer.
    pub mean_error: f64,
    /// Standard deviation, of n − 1.
    pub std: f64,
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// Shares and the values below which they lie.
    pub quantiles: Vec<[f64; 2]>,
}

impl Spread {
    /// Of these values; nothing where there is none.
    pub fn new(values: &[f64]) -> Option<Self> {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (n, min, max) = (values.len() as f64, *sorted.first()?, *sorted.last()?);
        // About the middle of the range, so that nothing is lost where the spread is small.
        let middle = 0.5 * (min + max);
        let mean = middle + values.iter().map(|x| x - middle).sum::<f64>() / n;
        let squares: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
        let std = if n > 1.0 { (squares / (n - 1.0)).sqrt() } else { f64::NAN };
        let quantiles = SHARES.iter().map(|share| [*share, quantile(&sorted, *share)]).collect();
        Some(Self { count: values.len(), mean, mean_error: std / n.sqrt(), std, min, max, quantiles })
    }
}

/// The value below which a share of sorted values lies, between two of them on the line through them (type 7 of Hyndman
/// and Fan, as NumPy).
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
    }
}

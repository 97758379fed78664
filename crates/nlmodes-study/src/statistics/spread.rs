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
        let squares: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
        let std = if n > 1.0 { (squares / (n - 1.0)).sqrt() } else { f64::NAN };
        let quantiles = SHARES.iter().map(|share| [*share, quantile(&sorted, *share)]).collect();
        Some(Self { count: values.len(), mean, mean_error: std / n.sqrt(), std, min, max, quantiles })
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
    }
}

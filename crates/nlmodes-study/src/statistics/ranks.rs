//! Rank correlations.

use serde::Serialize;

/// A rank correlation with its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Correlation {
    /// Spearman's coefficient: 1 if the quantity increases monotonically with the variable, −1 if it decreases.
    pub rho: f64,
    /// The 95 % confidence interval.
    pub interval: [f64; 2],
}

/// Spearman's rank correlation of pairs, with shared ranks for equal values. `None` for fewer than four, or if one side
/// is constant.
///
/// The interval is Fisher's, with the variance (1 + ρ²/2)/(n − 3) of Bonett and Wright, Psychometrika 65 (2000) 23-28.
pub fn rank_correlation(pairs: &[[f64; 2]]) -> Option<Correlation> {
    let n = pairs.len() as f64;
    if n < 4.0 {
        return None;
    }
    let [x, y] = [0, 1].map(|side| ranks(&pairs.iter().map(|pair| pair[side]).collect::<Vec<_>>()));
    let middle = 0.5 * (n - 1.0);
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - middle) * (b - middle)).sum::<f64>();
    let scale = (product(&x, &x) * product(&y, &y)).sqrt();
    if scale == 0.0 {
        return None;
    }
    let rho = (product(&x, &y) / scale).clamp(-1.0, 1.0);
    let half = 1.959963984540054 * ((1.0 + 0.5 * rho * rho) / (n - 3.0)).sqrt();
    let interval = if rho.abs() < 1.0 { [rho.atanh() - half, rho.atanh() + half].map(f64::tanh) } else { [rho; 2] };
    Some(Correlation { rho, interval })
}

/// Ranks from 0; equal values have their mean rank.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    let mut from = 0;
    while from < order.len() {
        let same = order[from..].iter().take_while(|k| values[**k] == values[order[from]]).count().max(1);
        let rank = from as f64 + 0.5 * (same as f64 - 1.0);
        order[from..from + same].iter().for_each(|k| ranks[*k] = rank);
        from += same;
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_are_those_of_scipy() {
        // scipy.stats.spearmanr of these pairs, with ties.
        let pairs = [[1.0, 2.0], [2.0, 1.0], [3.0, 4.0], [4.0, 3.0], [5.0, 6.0], [5.0, 5.0], [7.0, 7.0]];
        let found = rank_correlation(&pairs).unwrap();
        assert!((found.rho - 0.9189562119494703).abs() < 1e-12, "{}", found.rho);
        assert!(found.interval[0] < found.rho && found.rho < found.interval[1] && found.interval[1] < 1.0);
    }

    #[test]
    fn monotonic_is_one_and_constant_is_nothing() {
        let cubes: Vec<[f64; 2]> = (0..20).map(|k| [f64::from(k), -f64::from(k).powi(3)]).collect();
        assert_eq!(rank_correlation(&cubes).unwrap().rho, -1.0);
        assert_eq!(rank_correlation(&[[1.0, 2.0]; 10]), None);
        assert_eq!(rank_correlation(&cubes[..3]), None);
    }
}

//! Distributions, as maps from uniform numbers in the unit interval.

use statrs::distribution::{ContinuousCDF, Normal};

/// A probability distribution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Distribution {
    /// Uniform between two limits.
    Uniform {
        /// Lower limit.
        low: f64,
        /// Upper limit.
        high: f64,
    },
    /// Log-uniform between two positive limits.
    LogUniform {
        /// Lower limit.
        low: f64,
        /// Upper limit.
        high: f64,
    },
    /// Normal, truncated at limits that may be infinite.
    Normal {
        /// Mean before truncation.
        mean: f64,
        /// Standard deviation before truncation.
        std: f64,
        /// Lower limit.
        min: f64,
        /// Upper limit.
        max: f64,
    },
    /// Lognormal.
    LogNormal {
        /// Mean of the quantity itself.
        mean: f64,
        /// Standard deviation of the quantity itself.
        std: f64,
    },
}

impl Distribution {
    /// The value below which the fraction `u` of all values lies, `0 < u < 1`: the inverse of the cumulative
    /// distribution function.
    pub fn quantile(self, u: f64) -> f64 {
        match self {
            Self::Uniform { low, high } => low + u * (high - low),
            Self::LogUniform { low, high } => low * (high / low).powf(u),
            Self::Normal { mean, std, min, max } => {
                let [below, above] = [min, max].map(|limit| share_below((limit - mean) / std));
                (mean + std * standard_normal(below + u * (above - below))).clamp(min, max)
            }
            Self::LogNormal { mean, std } => {
                let variance = (std / mean).powi(2).ln_1p();
                (mean.ln() - 0.5 * variance + variance.sqrt() * standard_normal(u)).exp()
            }
        }
    }
}

/// The standard normal distribution; unit variance is always valid.
fn standard() -> Normal {
    Normal::standard()
}

fn standard_normal(u: f64) -> f64 {
    standard().inverse_cdf(u)
}

fn share_below(x: f64) -> f64 {
    match x {
        f64::INFINITY => 1.0,
        f64::NEG_INFINITY => 0.0,
        x => standard().cdf(x),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means over many quantiles at the midpoints of equal strata.
    fn moments(distribution: Distribution) -> [f64; 2] {
        let n = 200_000;
        let values: Vec<f64> = (0..n).map(|k| distribution.quantile((f64::from(k) + 0.5) / f64::from(n))).collect();
        let mean = values.iter().sum::<f64>() / f64::from(n);
        let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / f64::from(n);
        [mean, variance.sqrt()]
    }

    #[test]
    fn mean_and_deviation_are_those_that_were_asked_for() {
        let endless = Distribution::Normal { mean: 3.0, std: 0.5, min: f64::NEG_INFINITY, max: f64::INFINITY };
        let [mean, std] = moments(endless);
        assert!((mean - 3.0).abs() < 1e-9 && (std - 0.5).abs() < 1e-4, "{mean} {std}");
        let [mean, std] = moments(Distribution::LogNormal { mean: 1e-3, std: 2e-4 });
        assert!((mean / 1e-3 - 1.0).abs() < 1e-5 && (std / 2e-4 - 1.0).abs() < 1e-3, "{mean} {std}");
        let [mean, std] = moments(Distribution::Uniform { low: -1.0, high: 3.0 });
        assert!((mean - 1.0).abs() < 1e-9 && (std - 4.0 / 12f64.sqrt()).abs() < 1e-6);
        // ∫ x dx / (x ln 100) from 1 to 100.
        let [mean, _] = moments(Distribution::LogUniform { low: 1.0, high: 100.0 });
        assert!((mean - 99.0 / 100f64.ln()).abs() < 1e-6, "{mean}");
    }

    #[test]
    fn quantiles_of_the_normal_distribution_are_those_of_tables() {
        let normal = Distribution::Normal { mean: 0.0, std: 1.0, min: f64::NEG_INFINITY, max: f64::INFINITY };
        // Abramowitz and Stegun, table 26.5, and the quantile of one in a million.
        for (u, x) in [(0.975, 1.959963984540054), (0.5, 0.0), (0.05, -1.6448536269514722), (1e-6, -4.753424308822899)]
        {
            assert!((normal.quantile(u) - x).abs() < 1e-9, "{u} {}", normal.quantile(u));
        }
    }

    #[test]
    fn a_distribution_that_is_cut_off_stays_within_its_limits_and_keeps_its_shape() {
        let cut = Distribution::Normal { mean: 0.0, std: 1.0, min: 0.0, max: f64::INFINITY };
        // Half normal: mean √(2/π), variance 1 − 2/π.
        let [mean, std] = moments(cut);
        let exact = (2.0 / std::f64::consts::PI).sqrt();
        assert!((mean - exact).abs() < 1e-5 && (std * std - (1.0 - exact * exact)).abs() < 1e-4, "{mean} {std}");
        assert!((0..1000).all(|k| cut.quantile(f64::from(k) / 1000.0 + 5e-4) >= 0.0));
    }
}

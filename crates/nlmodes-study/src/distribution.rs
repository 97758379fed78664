//! Distributions, as maps from uniform numbers in the unit interval.

use statrs::distribution::{Continuous, ContinuousCDF, Normal};

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

/// Mean and standard deviation of a variable, and how far it goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// The mean, at which it is differentiated.
    pub mean: f64,
    /// The standard deviation; of values that are listed that of equally likely ones.
    pub std: f64,
    /// Lower and upper end of the box.
    pub ends: [f64; 2],
}

impl Distribution {
    /// Its moments; where it has no limits of its own, the box ends this many standard deviations from the mean, of the
    /// logarithm where that is the normal one.
    pub fn moments(self, deviations: f64) -> Tolerance {
        match self {
            Self::Uniform { low, high } => {
                Tolerance { mean: 0.5 * (low + high), std: (high - low) / 12f64.sqrt(), ends: [low, high] }
            }
            Self::LogUniform { low, high } => {
                let span = (high / low).ln();
                let mean = (high - low) / span;
                // E[x²] − E[x]², without the difference of two numbers that hardly differ.
                let square = mean * (0.5 * (low + high) - mean);
                Tolerance { mean, std: square.max(0.0).sqrt(), ends: [low, high] }
            }
            Self::Normal { mean, std, min, max } => {
                let [a, b] = [min, max].map(|limit| (limit - mean) / std);
                let share = share_below(b) - share_below(a);
                let [at_a, at_b] = [a, b].map(|x| standard().pdf(x));
                let weighted = |x: f64, density: f64| if x.is_finite() { x * density } else { 0.0 };
                let moved = (at_a - at_b) / share;
                let variance = 1.0 + (weighted(a, at_a) - weighted(b, at_b)) / share - moved * moved;
                Tolerance {
                    mean: mean + std * moved,
                    std: std * variance.max(0.0).sqrt(),
                    ends: [(mean - deviations * std).max(min), (mean + deviations * std).min(max)],
                }
            }
            Self::LogNormal { mean, std } => {
                let variance = (std / mean).powi(2).ln_1p();
                let at = |x: f64| (mean.ln() - 0.5 * variance + variance.sqrt() * x).exp();
                Tolerance { mean, std, ends: [at(-deviations), at(deviations)] }
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
    fn moments_are_those_of_many_quantiles_and_boxes_end_at_limits_or_so_many_deviations_away() {
        let normal = |min, max| Distribution::Normal { mean: 3.0, std: 0.5, min, max };
        for distribution in [
            Distribution::Uniform { low: -1.0, high: 3.0 },
            Distribution::LogUniform { low: 1.0, high: 100.0 },
            Distribution::LogUniform { low: 1.0, high: 1.01 },
            normal(f64::NEG_INFINITY, f64::INFINITY),
            normal(2.8, f64::INFINITY),
            normal(2.8, 3.1),
            Distribution::LogNormal { mean: 1e-3, std: 2e-4 },
        ] {
            let ([mean, std], own) = (moments(distribution), distribution.moments(3.0));
            assert!((own.mean / mean - 1.0).abs() < 1e-5, "{distribution:?}: {} {mean}", own.mean);
            assert!((own.std / std - 1.0).abs() < 1e-3, "{distribution:?}: {} {std}", own.std);
        }
        assert_eq!(normal(f64::NEG_INFINITY, f64::INFINITY).moments(2.0).ends, [2.0, 4.0]);
        assert_eq!(normal(2.8, f64::INFINITY).moments(2.0).ends, [2.8, 4.0]);
        let [low, high] = Distribution::LogNormal { mean: 1.0, std: 0.1 }.moments(3.0).ends;
        assert!((low * high * (1.0 + 0.01) - 1.0).abs() < 1e-12 && high > 1.3);
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

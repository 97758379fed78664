//! All branches overlaid, and their percentiles.

use crate::statistics::quantile;

/// Number of energies at which percentiles are evaluated.
const PLACES: usize = 80;
/// The percentiles, as shares.
pub const SHARES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// A branch as drawn on the page.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// Number of its case.
    pub case: usize,
    /// Averaged kinetic energy relative to that at grazing.
    pub energy_ratio: Vec<f64>,
    /// Frequency, Hz.
    pub frequency_hz: Vec<f64>,
}

impl Drawn {
    /// The points with finite coordinates.
    pub fn new(case: usize, energy_ratio: Option<&[f64]>, frequency_hz: Option<&[f64]>) -> Self {
        let points = energy_ratio.unwrap_or_default().iter().zip(frequency_hz.unwrap_or_default());
        let (energy_ratio, frequency_hz) = points.filter(|(x, y)| x.is_finite() && y.is_finite()).unzip();
        Self { case, energy_ratio, frequency_hz }
    }

    /// Frequency where the energy is first reached.
    fn at(&self, ratio: f64) -> Option<f64> {
        let holds = |w: &[f64]| (w[0] <= ratio && ratio <= w[1]) || (w[1] <= ratio && ratio <= w[0]);
        let k = self.energy_ratio.windows(2).position(holds)?;
        let (x, y) = (&self.energy_ratio[k..k + 2], &self.frequency_hz[k..k + 2]);
        let share = if x[1] == x[0] { 0.0 } else { (ratio - x[0]) / (x[1] - x[0]) };
        Some(y[0] + share * (y[1] - y[0]))
    }
}

/// Percentiles of the frequency at energies, of the branches that reach them first from below.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Band {
    /// Averaged kinetic energies relative to that at grazing.
    pub energy_ratio: Vec<f64>,
    /// For each of 5, 25, 50, 75 and 95 % the frequencies, Hz, below which this fraction of the branches is.
    pub frequency_hz: [Vec<f64>; 5],
}

impl Band {
    /// For these branches, as far as at least half of them extend.
    pub fn new(drawn: &[Drawn]) -> Self {
        let mut reached: Vec<f64> =
            drawn.iter().filter_map(|d| d.energy_ratio.iter().copied().reduce(f64::max)).collect();
        reached.sort_by(f64::total_cmp);
        let low = drawn.iter().filter_map(|d| d.energy_ratio.first().copied()).reduce(f64::max);
        let (Some(low), Some(high)) = (low, reached.get(reached.len() / 2).copied()) else { return Self::default() };
        if !(low > 0.0 && high > low) {
            return Self::default();
        }
        let mut band = Self::default();
        for k in 0..PLACES {
            let ratio = low * (high / low).powf(k as f64 / (PLACES - 1) as f64);
            let mut found: Vec<f64> = drawn.iter().filter_map(|drawn| drawn.at(ratio)).collect();
            if 2 * found.len() < drawn.len().max(2) {
                continue;
            }
            found.sort_by(f64::total_cmp);
            band.energy_ratio.push(ratio);
            for (line, share) in band.frequency_hz.iter_mut().zip(SHARES) {
                line.push(quantile(&found, share));
            }
        }
        band
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_of_straight_branches_are_straight() {
        // Frequencies 100 k + ratio for k = 0 … 100: the median is 50 · 100 + ratio.
        let drawn: Vec<Drawn> = (0..=100)
            .map(|k| Drawn::new(k, Some(&[1.0, 2.0, 5.0]), Some(&[1.0, 2.0, 5.0].map(|r| 100.0 * k as f64 + r))))
            .collect();
        let band = Band::new(&drawn);
        assert_eq!(band.energy_ratio.len(), PLACES);
        for (k, ratio) in band.energy_ratio.iter().enumerate() {
            for (share, line) in SHARES.iter().zip(&band.frequency_hz) {
                assert!((line[k] - (1e4 * share + ratio)).abs() < 1e-8, "{share} {ratio}");
            }
        }
    }
}

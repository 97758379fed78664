//! All branches overlaid, and their percentiles.

use crate::curve::{Curve, ENERGY_RATIO};
use crate::statistics::quantile;
use crate::study::Selected;

/// Number of energies at which percentiles are evaluated.
const PLACES: usize = 80;
/// The percentiles, as shares.
pub const SHARES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// A curve as drawn on the page: the frequency (Hz) over the energy relative to that at grazing or, of responses, the
/// amplitude of the first stop (m) over the frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// Number of its case.
    pub case: usize,
    /// What is drawn over.
    pub x: Vec<f64>,
    /// What is drawn.
    pub y: Vec<f64>,
    /// Whether it is a response.
    pub is_response: bool,
}

impl Drawn {
    /// The points with finite coordinates.
    pub fn new(case: usize, x: Option<&[f64]>, y: Option<&[f64]>) -> Self {
        let points = x.unwrap_or_default().iter().zip(y.unwrap_or_default());
        let (x, y) = points.filter(|(x, y)| x.is_finite() && y.is_finite()).unzip();
        Self { case, x, y, is_response: false }
    }

    /// The curves of a case: its branch, or its responses over the frequency.
    pub fn of(case: usize, curve: &Curve) -> Vec<Self> {
        if !curve.is_of_responses() {
            return vec![Self::new(case, curve.column(ENERGY_RATIO), curve.column("frequency_hz"))];
        }
        let response = |part: &Curve| {
            let amplitude: Option<Vec<f64>> =
                part.column("fundamental_m").map(|values| values.iter().map(|value| value.abs()).collect());
            let one = Self::new(case, part.column("frequency_hz"), amplitude.as_deref());
            Self { is_response: true, ..one }
        };
        curve.parts(Selected::default(), true).iter().map(response).collect()
    }

    /// All values at `x`, between points by the chord.
    fn all_at(&self, x: f64) -> impl Iterator<Item = f64> {
        let chord = move |(own, y): (&[f64], &[f64])| {
            let holds = (own[0] <= x && x <= own[1]) || (own[1] <= x && x <= own[0]);
            let share = if own[1] == own[0] { 0.0 } else { (x - own[0]) / (own[1] - own[0]) };
            holds.then(|| y[0] + share * (y[1] - y[0]))
        };
        self.x.windows(2).zip(self.y.windows(2)).filter_map(chord)
    }
}

/// Percentiles of what is drawn: of branches at energies, of those that reach them first from below; of responses those
/// of the largest amplitude that each case has at a frequency.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Band {
    /// What is drawn over.
    pub x: Vec<f64>,
    /// For each of 5, 25, 50, 75 and 95 % the values below which this fraction of the cases is.
    pub y: [Vec<f64>; 5],
    /// Of responses the envelope: the smallest and the largest amplitude that any case has at each frequency.
    pub envelope: Option<[Vec<f64>; 2]>,
}

impl Band {
    /// For these branches, as far as at least half of them extend.
    pub fn new(drawn: &[Drawn]) -> Self {
        if drawn.iter().any(|one| one.is_response) {
            return Self::of_responses(drawn);
        }
        let mut reached: Vec<f64> = drawn.iter().filter_map(|d| d.x.iter().copied().reduce(f64::max)).collect();
        reached.sort_by(f64::total_cmp);
        let low = drawn.iter().filter_map(|d| d.x.first().copied()).reduce(f64::max);
        let (Some(low), Some(high)) = (low, reached.get(reached.len() / 2).copied()) else { return Self::default() };
        if !(low > 0.0 && high > low) {
            return Self::default();
        }
        let mut band = Self::default();
        for k in 0..PLACES {
            let ratio = low * (high / low).powf(k as f64 / (PLACES - 1) as f64);
            band.take(ratio, drawn.iter().filter_map(|drawn| drawn.all_at(ratio).next()).collect(), drawn.len());
        }
        band
    }

    /// Of the largest amplitude of each case at frequencies within all windows.
    fn of_responses(drawn: &[Drawn]) -> Self {
        let mut cases: Vec<usize> = drawn.iter().map(|one| one.case).collect();
        cases.dedup();
        let all = || drawn.iter().flat_map(|one| one.x.iter().copied());
        let (Some(low), Some(high)) = (all().reduce(f64::min), all().reduce(f64::max)) else { return Self::default() };
        let mut band = Self { envelope: Some(Default::default()), ..Self::default() };
        for k in 0..=PLACES {
            let x = low + (high - low) * k as f64 / PLACES as f64;
            let of = |case: &usize| {
                let own = drawn.iter().filter(|one| one.case == *case);
                own.flat_map(|one| one.all_at(x)).reduce(f64::max)
            };
            band.take(x, cases.iter().filter_map(of).collect(), cases.len());
        }
        band
    }

    /// Takes what so many curves have at a place, unless fewer than half of them reach it.
    fn take(&mut self, x: f64, mut found: Vec<f64>, of: usize) {
        if 2 * found.len() < of.max(2) {
            return;
        }
        found.sort_by(f64::total_cmp);
        self.x.push(x);
        for (line, share) in self.y.iter_mut().zip(SHARES) {
            line.push(quantile(&found, share));
        }
        if let (Some([least, most]), Some(first), Some(last)) = (&mut self.envelope, found.first(), found.last()) {
            least.push(*first);
            most.push(*last);
        }
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
        assert_eq!(band.x.len(), PLACES);
        for (k, ratio) in band.x.iter().enumerate() {
            for (share, line) in SHARES.iter().zip(&band.y) {
                assert!((line[k] - (1e4 * share + ratio)).abs() < 1e-8, "{share} {ratio}");
            }
        }
    }
}

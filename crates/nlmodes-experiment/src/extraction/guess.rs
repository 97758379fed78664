//! A first guess of the frequency from spectra.

use std::ops::Range;

use nlmodes_modal::HarmonicBasis;

/// Lines count that are so many times the lower fifth of the spectrum: twelve times the median of noise.
const STANDS_OUT: f64 = 21.0;

/// Fewest periods of a record in which a line is one.
const FEWEST_LINES: usize = 2;

/// Sizes of the lines of a spectrum, from the mean on.
#[derive(Debug, Clone)]
pub struct Spectrum {
    size: Vec<f64>,
    n_samples: usize,
    floor: f64,
}

impl Spectrum {
    /// Of a signal without its mean, below a Hann window, which keeps slow trends from covering the peaks; `None` of
    /// too few samples.
    pub fn new(signal: &[f64]) -> Option<Self> {
        let n = signal.len();
        let hann = |j: usize| 0.5 - 0.5 * (std::f64::consts::TAU * (j as f64 + 0.5) / n as f64).cos();
        let mean = signal.iter().sum::<f64>() / n as f64;
        // The mean below the window too: none of it is left in the first lines.
        let left = signal.iter().enumerate().map(|(j, x)| (x - mean) * hann(j)).sum::<f64>();
        let mean = mean + 2.0 * left / n as f64;
        let windowed: Vec<f64> = signal.iter().enumerate().map(|(j, x)| (x - mean) * hann(j)).collect();
        let lines = n.checked_sub(1)? / 2;
        let mut spectrum = vec![num_complex::Complex64::default(); lines + 1];
        HarmonicBasis::new(lines, n).ok()?.analyze(&windowed, &mut spectrum);
        let size: Vec<f64> = spectrum.iter().map(|z| z.norm()).collect();
        let mut sorted = size.clone();
        sorted.sort_by(f64::total_cmp);
        let floor = STANDS_OUT * sorted[sorted.len() / 5];
        Some(Self { size, n_samples: n, floor })
    }

    /// Frequency of the largest peak among these lines, in cycles a sample, after `order` integrations in time; `None`
    /// where there is none. With `other` only peaks count that exceed the noise of both.
    pub fn peak(&self, lines: Range<usize>, order: u32, other: Option<&Self>) -> Option<f64> {
        let weighted = |k: usize| self.size[k] / (k as f64).powi(order as i32);
        let counts = |k: &usize| match other {
            None => self.size[*k] > 0.0,
            // Between two lines the larger one need not be the same.
            Some(other) => self.stands_out(*k) && (k.saturating_sub(1)..=k + 1).any(|near| other.stands_out(near)),
        };
        // What is integrated needs whole periods.
        let lines =
            lines.start.max(if order > 0 { FEWEST_LINES } else { 1 })..lines.end.min(self.size.len().saturating_sub(1));
        let peak = lines.filter(counts).max_by(|a, b| weighted(*a).total_cmp(&weighted(*b)))?;
        let [left, middle, right] = [peak - 1, peak, peak + 1].map(|k| self.size[k].max(f64::MIN_POSITIVE).ln());
        let bend = left - 2.0 * middle + right;
        let shift = if bend < 0.0 { 0.5 * (left - right) / bend } else { 0.0 };
        Some((peak as f64 + shift.clamp(-0.5, 0.5)) / self.n_samples as f64)
    }

    /// Whether a line is a peak above the noise.
    fn stands_out(&self, k: usize) -> bool {
        let near = |k: usize| self.size.get(k).copied().unwrap_or(0.0);
        let own = near(k);
        k > 0 && own > self.floor && own >= near(k - 1) && own >= near(k + 1)
    }

    /// The lines between two frequencies, in cycles a sample.
    pub fn lines(&self, from: f64, to: f64) -> Range<usize> {
        let n = self.n_samples as f64;
        (from * n).ceil().max(0.0) as usize..(to * n).floor().max(-1.0) as usize + 1
    }

    /// All lines.
    pub fn all(&self) -> Range<usize> {
        0..self.size.len()
    }
}

/// Frequency of the largest peak of a signal, in cycles a sample; `None` where there is none.
pub fn strongest_frequency(signal: &[f64]) -> Option<f64> {
    let spectrum = Spectrum::new(signal)?;
    spectrum.peak(spectrum.all(), 0, None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_found_between_the_lines() {
        for periods in [2.0, 2.4, 3.3, 20.7] {
            let n = 1000;
            let f = periods / f64::from(n);
            let wave = |j: i32| (std::f64::consts::TAU * f * f64::from(j) + 0.4).cos();
            let signal: Vec<f64> = (0..n).map(|j| 5.0 + wave(j)).collect();
            let found = strongest_frequency(&signal).unwrap();
            // The parabola through the logarithms of a Hann window's lines is off by 0.016 lines at most.
            assert!((found - f).abs() < 0.02 / f64::from(n), "{periods}: {}", found * f64::from(n));
        }
        assert_eq!(strongest_frequency(&[1.0; 50]), None);
        assert_eq!(strongest_frequency(&[]), None);
    }

    /// An acceleration whose sixth harmonic is five times its fundamental: as a displacement it is a seventh.
    #[test]
    fn a_peak_is_the_largest_one_after_its_integrations() {
        let (n, f) = (2000, 20.3 / 2000.0);
        let wave = |j: i32, order: f64| (std::f64::consts::TAU * order * f * f64::from(j)).cos();
        let signal: Vec<f64> = (0..n).map(|j| wave(j, 1.0) + 5.0 * wave(j, 6.0)).collect();
        let spectrum = Spectrum::new(&signal).unwrap();
        let lines = |order: u32| spectrum.peak(spectrum.all(), order, Some(&spectrum)).unwrap() / f;
        assert!((lines(0) - 6.0).abs() < 1e-2 && (lines(2) - 1.0).abs() < 1e-2, "{} {}", lines(0), lines(2));
        let force: Vec<f64> = (0..n).map(|j| wave(j, 6.0)).collect();
        let force = Spectrum::new(&force).unwrap();
        let both = spectrum.peak(spectrum.all(), 2, Some(&force)).unwrap() / f;
        assert!((both - 6.0).abs() < 1e-2, "only where there is a force: {both}");
        assert!(spectrum.peak(spectrum.lines(1.5 * f, 4.0 * f), 2, Some(&spectrum)).is_none());
    }
}

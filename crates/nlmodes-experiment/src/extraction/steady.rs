//! Intervals of a long record in which a level is held.

use std::f64::consts::TAU;
use std::ops::Range;

use num_complex::Complex64;

use crate::extraction::layout::Layout;
use crate::extraction::measured::wrapped;
use crate::extraction::{ExtractionError, ExtractionSettings, HarmonicFit, quality, window};
use crate::records::Record;

/// Periods of a block by which amplitude, phase and frequency are followed.
const BLOCK: usize = 4;
/// Share of the largest amplitude below which the drive counts as off.
const OFF: f64 = 0.02;
/// Standard deviations of the noise by which values of a level may differ.
const NOISE: f64 = 6.0;
/// Median of the magnitude of a normal variable over its standard deviation, times that of a second difference.
const SECOND_DIFFERENCE: f64 = 0.674_489_750_196_082 * 2.449_489_742_783_178;

/// What may change while a level is held, and how long it must be. What depends on noise may also scatter as it does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steadiness {
    /// Periods, at least, of a level; changes count within so many: 20.
    pub periods: usize,
    /// Change of the amplitudes of force and motion, relative: 5e-3.
    pub amplitude: f64,
    /// Change of the lag of the motion behind the force, degrees: 0.5.
    pub lag_deg: f64,
    /// Change of the frequency, relative: 2e-4.
    pub frequency: f64,
}

impl Default for Steadiness {
    fn default() -> Self {
        Self { periods: 20, amplitude: 5e-3, lag_deg: 0.5, frequency: 2e-4 }
    }
}

/// What a block of periods shows: logarithms of the amplitudes of force and motion, lag of the motion (rad), logarithm
/// of the frequency.
type Shown = [f64; 4];

/// The intervals of a record, as ranges of its samples, in which force, motion, the lag between them and the frequency
/// are steady; in their order, without the ramps between them. Without a force the motion alone counts.
///
/// # Errors
/// [`ExtractionError`] if no frequency is found at all.
pub fn steady_stretches(
    record: &Record,
    settings: &ExtractionSettings,
    steadiness: &Steadiness,
) -> Result<Vec<Range<usize>>, ExtractionError> {
    let mut findings = Vec::new();
    let usable = quality::usable(record, &mut findings);
    let layout = Layout::new(record, &usable);
    let motion = layout.motion(&findings)?;
    let omega = window::guess(record, &layout, settings, motion)?;
    let step = omega / record.sample_rate;
    let length = (BLOCK as f64 * TAU / step).round() as usize;
    let n = record.n_samples();
    let motion = &record.samples[motion][..n];
    let force = layout.force.map(|i| &record.samples[i][..n]);
    let shown = followed(motion, force, step, length)?;
    let blocks = steadiness.periods.div_ceil(BLOCK).max(2);
    let limits = [steadiness.amplitude, steadiness.amplitude, steadiness.lag_deg.to_radians(), steadiness.frequency];
    let ranges = steady(&shown, limits, blocks);
    Ok(ranges
        .into_iter()
        .map(|range| range.start * length..if range.end == shown.len() { n } else { range.end * length })
        .collect())
}

/// What each block of `length` samples shows; the frequency is followed from block to block, from one at which the
/// phase advances by `step`.
fn followed(
    motion: &[f64],
    force: Option<&[f64]>,
    step: f64,
    length: usize,
) -> Result<Vec<Option<Shown>>, ExtractionError> {
    let steps = local_steps(motion, step, length);
    let mut shown = Vec::with_capacity(steps.len());
    let mut before: Option<(f64, f64)> = None;
    for (k, own) in steps.iter().enumerate() {
        let block = k * length..(k + 1) * length;
        let fit = HarmonicFit::of_block(*own, length)?;
        let signals: Vec<&[f64]> = std::iter::once(motion).chain(force).map(|signal| &signal[block.clone()]).collect();
        let found: Vec<Complex64> = fit.coefficients(&signals).iter().map(|q| q[1]).collect();
        let (x, f) = (found[0], found.get(1).copied().unwrap_or(found[0]));
        // The phase at the middle of the block, and how far it should have come since the one before.
        let advanced = before.map(|(phase, step)| {
            let mean = 0.5 * (step + own);
            mean + wrapped(x.arg() - phase - mean * length as f64) / length as f64
        });
        before = Some((x.arg(), *own));
        let values = [f.norm().ln(), x.norm().ln(), (f / x).arg(), advanced.unwrap_or(*own).ln()];
        shown.push(values.iter().all(|value| value.is_finite()).then_some(values));
    }
    // The first block has none before it.
    let second = shown.get(1).copied().flatten();
    if let (Some(Some(first)), Some(second)) = (shown.first_mut(), second) {
        first[3] = second[3];
    }
    let largest = |i: usize| shown.iter().flatten().map(|values| values[i]).fold(f64::NEG_INFINITY, f64::max);
    let least = [0, 1].map(|i| largest(i) + OFF.ln());
    shown
        .iter_mut()
        .for_each(|values| *values = values.filter(|values| values[0] >= least[0] && values[1] >= least[1]));
    Ok(shown)
}

/// Advance of the phase from sample to sample in each block: from that of a fundamental below a Hann window, which
/// hides mean and harmonics.
fn local_steps(signal: &[f64], step: f64, length: usize) -> Vec<f64> {
    let half = length / 2;
    let hann = |j: usize| 0.5 - 0.5 * (TAU * (j as f64 + 0.5) / half as f64).cos();
    let windowed: Vec<Complex64> = (0..half).map(|j| Complex64::cis(-step * j as f64) * hann(j)).collect();
    let fundamental = |at: usize| -> Complex64 { windowed.iter().zip(&signal[at..]).map(|(w, x)| w * x).sum() };
    let own = |k: usize| {
        let [first, second] = [k * length, k * length + half].map(fundamental);
        let turned = wrapped((second / first).arg() - step * half as f64) / half as f64;
        if turned.is_finite() { (step + turned).max(0.5 * step) } else { step }
    };
    (0..signal.len() / length).map(own).collect()
}

/// Ranges of blocks within which no value leaves its limits, over any `blocks` of them; those next to a change are left
/// out.
fn steady(shown: &[Option<Shown>], limits: Shown, blocks: usize) -> Vec<Range<usize>> {
    let noise = [0, 1, 2, 3].map(|i| scatter(shown, i));
    let is_steady = |range: Range<usize>| {
        let values = &shown[range];
        values.iter().all(Option::is_some)
            && (0..4).all(|i| {
                let own = values.iter().flatten().map(|values| values[i]);
                let (low, high) = own.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
                high - low <= limits[i] + NOISE * noise[i]
            })
    };
    let mut ranges = Vec::new();
    let mut start = 0;
    while start + blocks <= shown.len() {
        if !is_steady(start..start + blocks) {
            start += 1;
            continue;
        }
        let mut end = start + blocks;
        while end < shown.len() && is_steady(end + 1 - blocks..end + 1) {
            end += 1;
        }
        let inner = start + usize::from(start > 0)..end - usize::from(end < shown.len());
        if inner.len() + 1 >= blocks {
            ranges.push(inner);
        }
        start = end;
    }
    ranges
}

/// Standard deviation of a value from block to block, from the median of its second differences, so that ramps have no
/// effect.
fn scatter(shown: &[Option<Shown>], i: usize) -> f64 {
    let second = |w: &[Option<Shown>]| Some((w[0]?[i] - 2.0 * w[1]?[i] + w[2]?[i]).abs());
    let mut sizes: Vec<f64> = shown.windows(3).filter_map(second).collect();
    sizes.sort_by(f64::total_cmp);
    sizes.get(sizes.len() / 2).map_or(0.0, |median| median / SECOND_DIFFERENCE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level(value: f64, blocks: usize) -> Vec<Option<Shown>> {
        // A scatter that repeats itself.
        (0..blocks).map(|k| Some([value + 1e-4 * ((k * 7) as f64).sin(), 0.0, 0.0, 0.0])).collect()
    }

    #[test]
    fn ramps_steps_and_pauses_part_levels() {
        let limits = [5e-3, 5e-3, 1e-2, 1e-4];
        let ramp: Vec<Option<Shown>> = (1..6).map(|k| Some([0.1 * f64::from(k), 0.0, 0.0, 0.0])).collect();
        let shown = [level(0.0, 12), ramp, level(0.6, 9), level(0.7, 8), vec![None; 3], level(0.0, 4)].concat();
        // A block beside each change is left out; the last level is too short.
        assert_eq!(steady(&shown, limits, 5), [0..11, 18..25, 27..33]);
        assert!(steady(&shown[..4], limits, 5).is_empty());
        // A drift of less than the limit over five blocks is a level, of more it is none.
        let drift = |rate: f64| (0..30).map(|k| Some([rate * f64::from(k), 0.0, 0.0, 0.0])).collect::<Vec<_>>();
        assert_eq!(steady(&drift(1e-3), limits, 5), std::slice::from_ref(&(0..30)));
        assert!(steady(&drift(1.5e-3), limits, 5).is_empty());
    }

    /// A frequency that steps by 3 %, with a mean and a third harmonic.
    #[test]
    fn the_frequency_is_followed_from_block_to_block() {
        let (step, n) = (TAU / 100.0, 40_000);
        let mut phase = 0.0;
        let steps = |j: usize| if j < n / 2 { step } else { 1.03 * step };
        let signal: Vec<f64> = (0..n)
            .map(|j| {
                phase += steps(j);
                0.4 + f64::cos(phase) + 0.3 * f64::cos(3.0 * phase)
            })
            .collect();
        let shown = followed(&signal, None, 1.01 * step, 396).unwrap();
        let at = |k: usize| shown[k].unwrap()[3].exp() / step;
        assert!((at(20) - 1.0).abs() < 1e-5 && (at(80) - 1.03).abs() < 1e-5, "{} {}", at(20), at(80));
    }
}

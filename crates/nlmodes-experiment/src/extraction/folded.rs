//! All periods of contact force and displacement laid over each other: the mean period, in whose noise that of the
//! force cell has the share of one over the square root of their number.

use num_complex::Complex64;

use crate::extraction::HarmonicFit;

/// Bins of a period at most.
const MOST_BINS: usize = 4096;
/// Standard errors of the mean period from which on a force is one.
const DETECTED: f64 = 5.0;
/// Errors of a mean displacement by which a stop yields …
const YIELDS: f64 = 20.0;
/// … and share of the gap.
const DEEP: f64 = 3e-3;
/// Share of the time in which a contact may be closed.
const MOST: f64 = 0.6;
/// Share of the peak below which a contact does not count.
const SHARE: f64 = 0.02;

/// Mean period of a contact, by the phase.
#[derive(Debug, Clone, Default)]
pub struct Folded {
    /// Phases, rad, ascending within a turn.
    pub phase: Vec<f64>,
    /// Force, N.
    pub force: Vec<f64>,
    /// Displacement toward the stop, m; empty without one.
    pub displacement: Vec<f64>,
    /// Standard error of a mean force, N.
    pub force_error: f64,
    /// Standard error of a mean displacement, m.
    pub displacement_error: f64,
}

/// A span of phases in which the contact is closed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closed {
    /// Phase of touching, rad.
    pub touching: f64,
    /// Phase of leaving, rad; behind that of touching, perhaps beyond the turn.
    pub leaving: f64,
}

impl Folded {
    /// Of samples of force and displacement toward the stop (empty without one), with the standard deviations of their
    /// noise.
    pub fn new(fit: &HarmonicFit, force: &[f64], displacement: &[f64], noise: [f64; 2]) -> Self {
        let turn = std::f64::consts::TAU;
        let step = fit.phase(1) - fit.phase(0);
        let n_bins = ((turn / step).round() as usize).clamp(1, MOST_BINS);
        let mut sums = vec![[0.0; 4]; n_bins];
        for (j, force) in force.iter().enumerate() {
            let phase = fit.phase(j).rem_euclid(turn);
            let sum = &mut sums[((phase / turn * n_bins as f64) as usize).min(n_bins - 1)];
            let x = displacement.get(j).copied().unwrap_or(0.0);
            [1.0, phase, *force, x].iter().zip(sum).for_each(|(x, sum)| *sum += x);
        }
        let filled: Vec<&[f64; 4]> = sums.iter().filter(|sum| sum[0] > 0.0).collect();
        let mean = |i: usize| filled.iter().map(|sum| sum[i] / sum[0]).collect::<Vec<f64>>();
        let per_bin = (force.len() as f64 / filled.len().max(1) as f64).max(1.0);
        Self {
            phase: mean(1),
            force: mean(2),
            displacement: if displacement.is_empty() { vec![] } else { mean(3) },
            force_error: noise[0] / per_bin.sqrt(),
            displacement_error: noise[1] / per_bin.sqrt(),
        }
    }

    /// Largest mean force, N.
    pub fn peak(&self) -> f64 {
        self.force.iter().copied().fold(0.0, f64::max)
    }

    /// Force from which on there is contact, N.
    pub fn threshold(&self) -> f64 {
        (DETECTED * self.force_error).max(SHARE * self.peak())
    }

    /// Whether the displacement goes measurably beyond a stop at this place (m), and is not there most of the time.
    pub fn yields(&self, stop: f64) -> bool {
        let depth = self.displacement.iter().map(|x| x - stop).fold(0.0, f64::max);
        let beyond = self.displacement.iter().filter(|x| **x > stop).count() as f64;
        let is_deep = depth > YIELDS * self.displacement_error && depth > DEEP * stop.abs();
        is_deep && beyond < MOST * self.displacement.len() as f64
    }

    /// Spans in which the displacement is beyond `stop` (m) and a force is there.
    pub fn beyond(&self, stop: f64) -> Vec<Closed> {
        let height: Vec<f64> = self.displacement.iter().map(|x| x - stop).collect();
        self.spans(&height, |i| height[i] > 0.0, false)
    }

    /// Spans in which the force is above its threshold, continued by straight lines to where it is zero.
    pub fn pressed(&self) -> Vec<Closed> {
        let threshold = self.threshold();
        self.spans(&self.force, |i| self.force[i] > threshold, true)
    }

    /// Spans of bins that are `closed`, whose ends are where `height` is zero: between the bins at either side, or,
    /// where `inward`, on the line through the outer two of them.
    fn spans(&self, height: &[f64], closed: impl Fn(usize) -> bool, inward: bool) -> Vec<Closed> {
        let n = height.len();
        let threshold = self.threshold();
        let Some(open) = (0..n).find(|i| !closed(*i)) else { return Vec::new() };
        let turn = std::f64::consts::TAU;
        let at = |i: usize| self.phase[i % n] + turn * (i / n) as f64;
        let zero = |outer: usize, inner: usize| {
            let (a, b) = (height[outer % n], height[inner % n]);
            at(outer) - a * (at(inner) - at(outer)) / (b - a)
        };
        let mut found = Vec::new();
        let mut i = open;
        while i < open + n {
            if !closed(i % n) {
                i += 1;
                continue;
            }
            let first = i;
            while closed(i % n) {
                i += 1;
            }
            let last = i - 1;
            let peak = (first..=last).map(|i| self.force[i % n]).fold(0.0, f64::max);
            if peak < threshold || last == first {
                continue;
            }
            let within =
                |x: f64, low: usize, high: usize| if x.is_finite() { x.clamp(at(low), at(high)) } else { at(low) };
            found.push(if inward {
                let touching = within(zero(first, first + 1), first - 1, first);
                Closed { touching, leaving: within(zero(last, last - 1), last, last + 1) }
            } else {
                Closed { touching: zero(first - 1, first), leaving: zero(last + 1, last) }
            });
        }
        found
    }

    /// Mean force at a phase, N: that of its bin.
    pub fn force_at(&self, phase: f64) -> f64 {
        let phase = phase.rem_euclid(std::f64::consts::TAU);
        let next = self.phase.partition_point(|own| *own < phase);
        let nearer = |i: usize| (self.phase[i] - phase).abs();
        match (next.checked_sub(1), self.phase.get(next)) {
            (Some(before), Some(_)) if nearer(before) < nearer(next) => self.force[before],
            (_, Some(_)) => self.force[next],
            (Some(before), None) => self.force[before],
            (None, None) => 0.0,
        }
    }

    /// Bins at least `margin` (rad) away from all spans.
    pub fn open_bins(&self, spans: &[Closed], margin: f64) -> Vec<usize> {
        let turn = std::f64::consts::TAU;
        let is_open = |phase: f64| {
            spans.iter().all(|span| {
                let from = span.touching - margin;
                (phase - from).rem_euclid(turn) > span.leaving - span.touching + 2.0 * margin
            })
        };
        (0..self.phase.len()).filter(|i| is_open(self.phase[*i])).collect()
    }
}

/// Harmonics with their noise taken out as far as they are known: each times `1 − e²/|F|²`, both averaged over its
/// neighbours, where `e` is its standard error.
pub fn without_noise(all: &[Complex64], squared_errors: &[f64]) -> Vec<f64> {
    const NEAR: usize = 3;
    const LEAST: f64 = 1.5;
    let n = all.len();
    let weight = |k: usize| {
        let near = k.saturating_sub(NEAR).max(1)..(k + NEAR + 1).min(n);
        let power: f64 = near.clone().map(|m| all[m].norm_sqr()).sum();
        let noise: f64 = near.map(|m| squared_errors[m]).sum();
        if power > LEAST * noise { 1.0 - noise / power } else { 0.0 }
    };
    (0..n).map(|k| if k == 0 { 1.0 } else { weight(k) }).collect()
}

/// Phase and height of the largest value of a sum of harmonics.
pub fn largest(harmonics: &[Complex64]) -> (f64, f64) {
    let at = |phase: f64| -> f64 {
        let turn = Complex64::cis(phase);
        let mut power = Complex64::new(1.0, 0.0);
        let mut sum = 0.0;
        for q in harmonics {
            sum += (q * power).re;
            power *= turn;
        }
        sum
    };
    let used = harmonics.iter().rposition(|q| q.norm_sqr() > 0.0).unwrap_or(0).max(1);
    let n = 8 * used;
    let width = std::f64::consts::TAU / n as f64;
    let (mut best, mut height) = (0.0, f64::NEG_INFINITY);
    for j in 0..n {
        let value = at(width * j as f64);
        if value > height {
            (best, height) = (width * j as f64, value);
        }
    }
    let (left, right) = (at(best - width), at(best + width));
    let bend = left - 2.0 * height + right;
    let shift = if bend < 0.0 { (0.5 * (left - right) / bend).clamp(-1.0, 1.0) } else { 0.0 };
    let top = best + shift * width;
    (top, at(top).max(height))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spring of 1000 N/m behind 0.8 in a unit sine: half of `2 acos 0.8` on either side of the top.
    #[test]
    fn closed_spans_are_where_the_displacement_is_beyond_the_stop() {
        let step = std::f64::consts::TAU / 97.3;
        let fit = HarmonicFit::new(3, step, 2000).unwrap();
        let x: Vec<f64> = (0..2000).map(|j| fit.phase(j).cos()).collect();
        let force: Vec<f64> = x.iter().map(|x| (1e3 * (x - 0.8)).max(0.0)).collect();
        let folded = Folded::new(&fit, &force, &x, [0.0, 0.0]);
        let half = 0.8_f64.acos();
        for (spans, tolerance) in [(folded.beyond(0.8), 2e-3), (folded.pressed(), 2e-2)] {
            assert_eq!(spans.len(), 1, "{spans:?}");
            assert!(((spans[0].leaving - spans[0].touching) / 2.0 - half).abs() < tolerance, "{spans:?} {half}");
            let middle = 0.5 * (spans[0].leaving + spans[0].touching);
            assert!((middle - std::f64::consts::TAU).abs() < tolerance, "{spans:?}");
            let open = folded.open_bins(&spans, 0.1);
            assert!(open.iter().all(|i| folded.phase[*i] > half && folded.phase[*i] < std::f64::consts::TAU - half));
        }
        assert!(folded.beyond(2.0).is_empty());
    }

    #[test]
    fn the_largest_value_of_harmonics_is_found_between_the_grid() {
        let harmonics = [Complex64::new(0.5, 0.0), Complex64::from_polar(2.0, 0.3)];
        let (phase, height) = largest(&harmonics);
        assert!(
            (height - 2.5).abs() < 1e-3
                && (phase.rem_euclid(std::f64::consts::TAU) - (std::f64::consts::TAU - 0.3)).abs() < 0.02
        );
        assert_eq!(without_noise(&harmonics, &[0.0, 0.0]), [1.0, 1.0]);
        assert_eq!(without_noise(&harmonics, &[0.0, 3.0]), [1.0, 0.0]);
    }
}

//! Samples at uneven instants, and their values at even ones.

use crate::records::{Column, RecordError, SampleRate, Start, time_axis};

/// Rounding of the stamps, over the mean interval, up to which they tell when each sample was taken.
const EXACT: f64 = 0.05;
/// Longest interval, in mean ones, that is bridged.
const LONGEST: f64 = 8.0;
/// Shortest interval, in mean ones.
const SHORTEST: f64 = 1e-3;
/// Samples through which a value between them goes …
const NODES: usize = 8;
/// … and fewer where intervals beside each other differ by more than this factor.
const FEWER: usize = 4;
const ALIKE: f64 = 5.0;

/// The time axis of columns, from stamps.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeAxis {
    rate: SampleRate,
    start: Start,
    /// Stamps that are not even, s.
    uneven: Option<Uneven>,
}

#[derive(Debug, Clone, PartialEq)]
struct Uneven {
    times: Vec<f64>,
    /// Largest deviation from an even axis, over the mean interval.
    deviation: f64,
}

impl TimeAxis {
    /// Of stamps (s), each rounded by at most `rounding`, beside that of the first one.
    ///
    /// Even stamps give the sampling rate. Uneven ones that are exact, in order and without long gaps give even
    /// instants at the mean rate, at which [`Self::put`] takes the columns.
    ///
    /// # Errors
    /// [`RecordError::Empty`] with fewer than two, [`RecordError::UnevenTime`] where they are of no use.
    pub fn new(times: &[f64], rounding: f64, of_first: f64) -> Result<Self, RecordError> {
        let start = Start { at: times.first().copied().unwrap_or(0.0), rounding: of_first };
        match SampleRate::of_times(times, rounding) {
            Ok(rate) => Ok(Self { rate, start, uneven: None }),
            Err(error) => Self::of_uneven(times, rounding, start).ok_or(error),
        }
    }

    fn of_uneven(times: &[f64], rounding: f64, start: Start) -> Option<Self> {
        let duration = times.last()? - times.first()?;
        let mean = duration / (times.len() - 1) as f64;
        let in_order = |pair: &[f64]| (SHORTEST * mean..LONGEST * mean).contains(&(pair[1] - pair[0]));
        let is_usable =
            times.len() > NODES && mean.is_finite() && rounding < EXACT * mean && times.windows(2).all(in_order);
        if !is_usable {
            return None;
        }
        let interval = time_axis::slope(times);
        let rate = SampleRate { hz: 1.0 / interval, relative_error: 2.0 * rounding / duration };
        let deviation = 0.5 * time_axis::span(times, interval).0 / interval;
        Some(Self { rate, start, uneven: Some(Uneven { times: times.to_vec(), deviation }) })
    }

    /// Gives a column its rate and start, and values at even instants.
    pub fn put(&self, column: &mut Column) {
        (column.rate, column.start) = (Some(self.rate), Some(self.start));
        let Some(uneven) = self.uneven.as_ref().filter(|uneven| uneven.times.len() == column.values.len()) else {
            return;
        };
        column.values = uneven.even(&column.values, self.rate.hz.recip());
        column.uneven = Some(uneven.deviation);
    }
}

impl Uneven {
    fn even(&self, values: &[f64], interval: f64) -> Vec<f64> {
        let times = &self.times;
        let last = times.len() - 1;
        let n = ((times[last] - times[0]) / interval * (1.0 + 1e-12)) as usize + 1;
        let mut at = 0;
        let value = |j: usize| {
            let t = (times[0] + j as f64 * interval).min(times[last]);
            while at + 2 < times.len() && times[at + 1] <= t {
                at += 1;
            }
            // What stands still does not swing between two samples: a switch stays one.
            if values[at] == values[at + 1] { values[at] } else { self.between(values, at, t) }
        };
        (0..n).map(value).collect()
    }

    /// Value of the polynomial through the samples about `t`, which is behind sample `at`.
    fn between(&self, values: &[f64], at: usize, t: f64) -> f64 {
        let nodes = |count: usize| {
            let first = (at + 1).saturating_sub(count / 2).min(self.times.len() - count);
            first..first + count
        };
        let intervals = self.times[nodes(NODES)].windows(2).map(|pair| pair[1] - pair[0]);
        let (least, most) = intervals.fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), x| (a.min(x), b.max(x)));
        let nodes = nodes(if most > ALIKE * least { FEWER } else { NODES });
        let mut sum = 0.0;
        for j in nodes.clone() {
            let others = nodes.clone().filter(|k| *k != j);
            let term = |k: usize| (t - self.times[k]) / (self.times[j] - self.times[k]);
            sum += values[j] * others.map(term).product::<f64>();
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Instants that are off by up to this share of an interval.
    fn jittered(n: usize, interval: f64, share: f64) -> Vec<f64> {
        let off = |j: usize| share * ((j * j) as f64 * 0.7).sin();
        (0..n).map(|j| interval * (j as f64 + off(j)) + 3.0).collect()
    }

    fn even(times: &[f64], of: impl Fn(f64) -> f64) -> (Column, f64) {
        let axis = TimeAxis::new(times, 1e-12, 1e-12).unwrap();
        let mut column = Column::new("x", times.iter().map(|t| of(*t)).collect());
        axis.put(&mut column);
        (column, axis.rate.hz)
    }

    /// A polynomial of the seventh degree comes back to rounding, a sine of 25 samples a period to a millionth; where
    /// intervals are so different that fewer samples are taken, to the fourth power of their distance.
    #[test]
    fn values_at_even_instants_are_those_of_the_signal() {
        for (share, error) in [(0.15, 2e-6), (0.3, 2e-6), (0.45, 3e-4)] {
            let times = jittered(400, 0.01, share);
            let wave = |t: f64| (25.0 * t).sin();
            let (column, hz) = even(&times, wave);
            let worst = column.values.iter().enumerate().map(|(j, x)| (x - wave(times[0] + j as f64 / hz)).abs());
            assert!(worst.fold(0.0, f64::max) < error, "{share}");
            assert!(column.uneven.is_some_and(|off| off > 0.5 * share && off < 1.5 * share), "{:?}", column.uneven);
            assert!((hz / 100.0 - 1.0).abs() < 1e-4 && column.values.len().abs_diff(400) <= 1, "{hz}");
        }
        let times = jittered(60, 0.01, 0.3);
        let power = |t: f64| (10.0 * (t - 3.3)).powi(7);
        let (column, hz) = even(&times, power);
        for (j, x) in column.values.iter().enumerate() {
            assert!((x - power(times[0] + j as f64 / hz)).abs() < 1e-9, "{j}");
        }
    }

    #[test]
    fn gaps_and_switches_are_bridged_without_swinging() {
        let mut times = jittered(500, 0.01, 0.0);
        times.drain(200..203);
        let (column, hz) = even(&times, |t| if t < 5.5 { 0.0 } else { 2.0 });
        assert!(column.values.iter().filter(|x| **x != 0.0 && **x != 2.0).count() <= 2);
        let at = column.values.iter().position(|x| *x != 0.0).unwrap();
        assert!((times[0] + at as f64 / hz - 5.5).abs() < 0.02);
    }

    #[test]
    fn stamps_that_are_coarse_out_of_order_or_far_apart_are_refused() {
        let refused = |times: &[f64], rounding: f64| {
            matches!(TimeAxis::new(times, rounding, rounding), Err(RecordError::UnevenTime { .. }))
        };
        let sound = jittered(300, 0.01, 0.3);
        assert!(!refused(&sound, 1e-6) && refused(&sound, 1e-3));
        let mut back = sound.clone();
        back.swap(100, 101);
        assert!(refused(&back, 1e-6));
        let mut apart = sound;
        apart.drain(100..130);
        assert!(refused(&apart, 1e-6));
        // An even axis stays as it is.
        let axis = TimeAxis::new(&jittered(300, 0.01, 0.0), 1e-9, 1e-9).unwrap();
        assert!(axis.uneven.is_none() && (axis.rate.hz - 100.0).abs() < 1e-6);
    }
}

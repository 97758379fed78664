//! The uniform time axis from time stamps with few digits.

use crate::records::RecordError;

/// A time stamp may deviate by this fraction of the sampling interval from a uniform axis, in addition to rounding.
const JITTER: f64 = 0.1;
/// Rounding below this share of the interval lets single intervals be judged.
const FINE: f64 = 0.125;
/// Most steps to a limit of the interval; each ends on a new pair of stamps, and few are needed.
const MAX_STEPS: usize = 60;
/// Share by which the golden section makes an interval shorter.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// Sampling interval with its largest relative error, from stamps that were each rounded by at most `rounding` (all in
/// s).
///
/// The interval is the slope of the line of least squares through all stamps, so that the rounding of each counts
/// little. Its error is no estimate but a bound: intervals beyond it need a stamp that is further off than rounding.
///
/// # Errors
/// [`RecordError::Empty`] with fewer than two, [`RecordError::UnevenTime`] at the position where they are not uniform.
pub fn interval(times: &[f64], rounding: f64) -> Result<(f64, f64), RecordError> {
    let n = times.len();
    if n < 2 {
        return Err(RecordError::Empty { samples: n });
    }
    let uneven = |(sample, deviation)| Err(RecordError::UnevenTime { sample, deviation });
    if let Some(sample) = times.iter().position(|t| !t.is_finite()) {
        return uneven((sample, f64::NAN));
    }
    let mut slope = slope(times);
    let allowed = |slope: f64| 2.0 * rounding.hypot(JITTER * slope);
    if !(slope > 0.0 && slope.is_finite()) {
        return uneven(irregular(times, slope, rounding));
    }
    if span(times, slope).0 > allowed(slope) {
        slope = narrowest(times, slope, 4.0 * allowed(slope) / n as f64);
        if span(times, slope).0 > allowed(slope) {
            return uneven(irregular(times, slope, rounding));
        }
    }
    let width = (2.0 * rounding).max(span(times, slope).0);
    let reach = 4.0 * width / (n - 1) as f64;
    let [low, high] = [-reach, reach].map(|reach| limit(times, slope + reach, width));
    Ok((slope, (high - slope).max(slope - low).max(0.0) / slope))
}

/// Slope of the line of least squares over the numbers of the stamps.
pub(super) fn slope(times: &[f64]) -> f64 {
    let centre = 0.5 * (times.len() - 1) as f64;
    let mean = times.iter().sum::<f64>() / times.len() as f64;
    let (mut square, mut product) = (0.0, 0.0);
    for (j, t) in times.iter().enumerate() {
        let u = j as f64 - centre;
        square += u * u;
        product += u * (t - mean);
    }
    product / square
}

/// Range of the stamps about a line of this slope, with the numbers of the lowest and the highest one.
pub(super) fn span(times: &[f64], slope: f64) -> (f64, usize, usize) {
    let rest = |j: usize| times[j] - times[0] - slope * j as f64;
    let (mut low, mut high) = (0, 0);
    for j in 1..times.len() {
        if rest(j) < rest(low) {
            low = j;
        }
        if rest(j) > rest(high) {
            high = j;
        }
    }
    (rest(high) - rest(low), low, high)
}

/// The slope within `reach` about which the stamps have the smallest range, which is convex in the slope.
fn narrowest(times: &[f64], slope: f64, reach: f64) -> f64 {
    let (mut low, mut high) = (slope - reach, slope + reach);
    for _ in 0..MAX_STEPS {
        let [a, b] = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
        if span(times, a).0 < span(times, b).0 { high = b } else { low = a }
    }
    0.5 * (low + high)
}

/// The slope at which the range of the stamps falls to `width`, from one at which it is larger: Newton's method on a
/// convex function, which does not step over the root.
fn limit(times: &[f64], mut slope: f64, width: f64) -> f64 {
    for _ in 0..MAX_STEPS {
        let (range, low, high) = span(times, slope);
        if range <= width || low == high {
            break;
        }
        let next = (times[high] - times[low] - width) / (high as f64 - low as f64);
        if next == slope {
            break;
        }
        slope = next;
    }
    slope
}

/// Where the stamps are not uniform, and by how many intervals: the first interval of another length; for stamps that
/// are too coarse for that, the step that explains most; otherwise the stamp with the largest deviation.
fn irregular(times: &[f64], slope: f64, rounding: f64) -> (usize, f64) {
    let mut intervals: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = intervals.len() / 2;
    let median = *intervals.select_nth_unstable_by(middle, f64::total_cmp).1;
    if median > 0.0 && rounding < FINE * median {
        let deviation = |j: usize| (times[j] - times[j - 1]) / median - 1.0;
        let other = (1..times.len()).find(|j| deviation(*j).abs() > JITTER + 4.0 * rounding / median);
        if let Some(sample) = other {
            return (sample, deviation(sample));
        }
        let (_, low, high) = span(times, slope);
        let rest = |j: usize| (times[j] - times[0] - slope * j as f64) / slope;
        return if rest(high).abs() >= rest(low).abs() { (high, rest(high)) } else { (low, rest(low)) };
    }
    step(times)
}

/// The step in the stamps that explains most of the deviation from their line: its first sample and its height relative
/// to the adjacent interval.
fn step(times: &[f64]) -> (usize, f64) {
    let (n, slope) = (times.len() as f64, slope(times));
    let (centre, mean) = (0.5 * (n - 1.0), times.iter().sum::<f64>() / n);
    let square = n * (n * n - 1.0) / 12.0;
    // Sums over the samples from k on: of what the line leaves, and of their numbers from the centre.
    let (mut rest, mut lever) = (0.0, 0.0);
    let (mut best, mut most) = ((times.len() - 1, f64::NAN), 0.0);
    for k in (1..times.len()).rev() {
        let u = k as f64 - centre;
        rest += times[k] - mean - slope * u;
        lever += u;
        let own = k as f64 * (n - k as f64) / n - lever * lever / square;
        if own > 1e-9 && rest * rest / own > most {
            most = rest * rest / own;
            let height = rest / own;
            best = (k, height / (slope - height * lever / square));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stamps rounded to this many decimals.
    fn stamps(rate: f64, n: usize, decimals: i32) -> Vec<f64> {
        let unit = 10f64.powi(decimals);
        (0..n).map(|j| (j as f64 / rate * unit).round() / unit).collect()
    }

    #[test]
    fn coarse_stamps_give_the_rate_within_its_bound() {
        for (rate, n) in [(5000.0, 10_000), (5000.0, 2_503), (20_000.0, 12_001), (4096.0, 999), (51_200.0, 70_000)] {
            for decimals in [3, 4, 5] {
                let (interval, error) = interval(&stamps(rate, n, decimals), 0.5 * 10f64.powi(-decimals)).unwrap();
                let miss = interval * rate - 1.0;
                assert!(miss.abs() <= error, "{rate} {n} {decimals}: {miss:e}, bound {error:e}");
                // Far better than from the first and the last stamp, which are each off by up to the rounding.
                let ends = 10f64.powi(-decimals) / (n as f64 / rate);
                assert!(miss.abs() < 0.05 * ends && error <= 1.002 * ends, "{rate} {n} {decimals}: {miss:e} {ends:e}");
            }
        }
    }

    #[test]
    fn a_lost_sample_is_named_where_it_is_lost() {
        for lost in [1, 77, 500, 990] {
            for (rate, decimals) in [(1000.0, 6), (48_000.0, 6), (5000.0, 9)] {
                let mut times = stamps(rate, 1000, decimals);
                times.remove(lost);
                let error = interval(&times, 0.5 * 10f64.powi(-decimals)).unwrap_err();
                let RecordError::UnevenTime { sample, deviation } = error else { panic!("{error}") };
                assert!(sample == lost && (deviation - 1.0).abs() < 0.1, "{lost}: {sample} {deviation}");
            }
        }
    }

    #[test]
    fn many_lost_samples_between_coarse_stamps_are_named_to_their_rounding() {
        let mut times = stamps(5000.0, 4000, 3);
        times.drain(777..797);
        let Err(RecordError::UnevenTime { sample, deviation }) = interval(&times, 5e-4) else { panic!() };
        assert!(sample.abs_diff(777) <= 5 && (deviation - 20.0).abs() < 1.0, "{sample} {deviation}");
    }

    /// Two neighbours in the middle that are rounded up and down by as much as there is: half of that more is no
    /// rounding.
    #[test]
    fn stamps_may_be_off_by_their_rounding_and_no_more() {
        for (unit, rounding) in [(1.0, 0.9), (1e-3, 2.0), (50.0, 1.0)] {
            let off = |j: usize, by: f64| {
                if j == 500 {
                    by
                } else if j == 501 {
                    -by
                } else {
                    0.0
                }
            };
            let with = |by: f64| -> Vec<f64> { (0..1000).map(|j| unit * (j as f64 + off(j, by * rounding))).collect() };
            assert!(interval(&with(0.95), unit * rounding).is_ok());
            let refused = interval(&with(1.15), unit * rounding);
            assert!(matches!(refused, Err(RecordError::UnevenTime { .. })), "{rounding}: {refused:?}");
        }
    }

    #[test]
    fn clocks_that_stand_or_run_back_are_refused_at_their_place() {
        let place = |times: &[f64]| match interval(times, 0.0) {
            Err(RecordError::UnevenTime { sample, .. }) => sample,
            other => panic!("{other:?}"),
        };
        assert_eq!(place(&[0.0, 0.1, 0.2, 0.2, 0.3, 0.4]), 3);
        assert_eq!(place(&[0.0, 0.1, f64::NAN, 0.3]), 2);
        place(&[1.0, 1.0, 1.0]);
        place(&[3.0, 2.0, 1.0]);
    }

    /// Intervals that grow from 0.95 to 1.05, none far from the median: the stamp furthest from the line is in the
    /// middle, 12.5 intervals early.
    #[test]
    fn a_clock_that_slows_down_is_refused_where_it_is_furthest_off() {
        for unit in [1.0, 1e-5] {
            let times: Vec<f64> =
                (0..=1000).map(f64::from).map(|j| unit * (0.95 + 0.05e-3 * j) * j + 7.0 * unit).collect();
            let Err(RecordError::UnevenTime { sample, deviation }) = interval(&times, 0.0) else { panic!() };
            assert!(sample.abs_diff(500) <= 2 && (deviation + 12.5).abs() < 0.1, "{sample} {deviation}");
        }
    }

    /// A line with a step is explained by it whole: place and height over the interval, of however few stamps.
    #[test]
    fn a_step_in_a_line_is_found_with_its_place_and_height() {
        for (n, interval) in [(5, 1.0), (8, 1e-3), (30, 0.25)] {
            for (k, height) in [(1, 3.0), (2, -0.4), (n - 2, 20.0), (n - 1, 0.7)] {
                let jump = |j: usize| if j >= k { height } else { 0.0 };
                let times: Vec<f64> = (0..n).map(|j| interval * (7.0 + j as f64 + jump(j))).collect();
                let (found, size) = step(&times);
                assert!(found == k && (size / height - 1.0).abs() < 1e-9, "{n} {k}: {found} {size}");
            }
        }
    }
}

//! Reduction of samples without visible loss.

/// Indices of the samples between which straight lines approximate each series to within `tolerance` of its largest
/// value (Ramer 1972, Douglas and Peucker 1973, with vertical distances); both ends are among them.
///
/// All series have the length of `time`, which ascends. Samples that are not finite are kept.
pub(super) fn knots(time: &[f64], series: &[&[f64]], tolerance: f64) -> Vec<usize> {
    let Some(last) = time.len().checked_sub(1) else { return Vec::new() };
    let sizes: Vec<f64> = series.iter().map(|values| largest(values)).collect();
    let (mut kept, mut distances) = (vec![false; time.len()], vec![0.0; time.len()]);
    (kept[0], kept[last]) = (true, true);
    let mut pieces = vec![(0, last)];
    while let Some((from, to)) = pieces.pop() {
        let inner = from + 1..to;
        let distances = &mut distances[inner.clone()];
        distances.fill(0.0);
        let length = time[to] - time[from];
        for (values, size) in series.iter().zip(&sizes) {
            let (start, slope) = (values[from], (values[to] - values[from]) / length);
            let samples = time[inner.clone()].iter().zip(&values[inner.clone()]);
            for (most, (t, value)) in distances.iter_mut().zip(samples) {
                let distance = (value - start - slope * (t - time[from])).abs() / size;
                // NaN is treated as far away.
                *most = if distance > *most || distance.is_nan() { distance } else { *most };
            }
        }
        let farthest = inner.zip(&*distances).max_by(|a, b| a.1.total_cmp(b.1));
        if let Some((k, _)) = farthest.filter(|(_, distance)| **distance > tolerance || distance.is_nan()) {
            kept[k] = true;
            pieces.extend([(from, k), (k, to)]);
        }
    }
    (0..=last).filter(|k| kept[*k]).collect()
}

/// Largest magnitude, 1 where there is none.
fn largest(values: &[f64]) -> f64 {
    let most = values.iter().filter(|value| value.is_finite()).fold(0.0, |m: f64, value| m.max(value.abs()));
    if most > 0.0 { most } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_lines_between_the_knots_miss_no_sample() {
        let time: Vec<f64> = (0..=2000).map(|k| f64::from(k) / 2000.0).collect();
        let wave: Vec<f64> = time.iter().map(|t| (6.0 * t).cos()).collect();
        // A contact of a hundredth of the time.
        let blow: Vec<f64> = time.iter().map(|t| (1.0 - (200.0 * (t - 0.31)).powi(2)).max(0.0)).collect();
        let chosen = knots(&time, &[&wave, &blow], 1e-3);
        assert!(chosen.len() < 120 && chosen[0] == 0 && chosen[chosen.len() - 1] == 2000, "{}", chosen.len());
        for series in [&wave, &blow] {
            for pair in chosen.windows(2) {
                let (a, b) = (pair[0], pair[1]);
                for k in a..=b {
                    let share = (k - a) as f64 / (b - a) as f64;
                    let line = series[a] + share * (series[b] - series[a]);
                    assert!((series[k] - line).abs() <= 1.001e-3, "{k}");
                }
            }
        }
    }

    #[test]
    fn one_straight_line_needs_its_ends_only_and_a_gap_is_kept() {
        let time = [0.0, 1.0, 2.0, 3.0, 4.0];
        assert_eq!(knots(&time, &[&[0.0, 1.0, 2.0, 3.0, 4.0]], 1e-6), [0, 4]);
        assert!(knots(&time, &[&[0.0, 1.0, f64::NAN, 3.0, 4.0]], 1e-6).contains(&2));
        assert!(knots(&[], &[], 1e-6).is_empty());
    }
}

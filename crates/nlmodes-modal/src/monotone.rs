//! Monotone cubic interpolation, without overshoot.

/// Slopes at values that follow each other at these steps: those of the parabola through three neighbours, limited so
/// that each piece is monotone (Steffen, *A simple method for monotonic interpolation in one dimension*, Astron.
/// Astrophys. 239, 1990).
///
/// As many slopes as `values`, one more than `steps`, whose entries are positive; in units of a value over those of a
/// step. A single value has the slope zero.
#[must_use]
pub fn monotone_slopes(values: &[f64], steps: &[f64]) -> Vec<f64> {
    let secants: Vec<f64> = values.windows(2).zip(steps).map(|(v, h)| (v[1] - v[0]) / h).collect();
    let Some(last) = secants.len().checked_sub(1) else { return vec![0.0; values.len()] };
    let at_end = |near: usize, next: usize| {
        let share = steps[near] / (steps[near] + steps[next]);
        let slope = secants[near] * (1.0 + share) - secants[next] * share;
        limited(slope, 2.0 * secants[near])
    };
    let inner = |k: usize| {
        let (before, after) = (secants[k - 1], secants[k]);
        let parabola = (before * steps[k] + after * steps[k - 1]) / (steps[k - 1] + steps[k]);
        if before * after <= 0.0 {
            0.0
        } else {
            limited(parabola, 2.0 * before.abs().min(after.abs()).copysign(before))
        }
    };
    (0..values.len())
        .map(|k| match k {
            _ if last == 0 => secants[0],
            0 => at_end(0, 1),
            k if k > last => at_end(last, last - 1),
            k => inner(k),
        })
        .collect()
}

/// The cubic between two values with these slopes, at the fraction `t` of the step, from 0 to 1.
#[must_use]
pub fn cubic(values: [f64; 2], slopes: [f64; 2], step: f64, t: f64) -> f64 {
    let s = 1.0 - t;
    let [a, d] = values;
    let (b, c) = (a + step / 3.0 * slopes[0], d - step / 3.0 * slopes[1]);
    s * s * s * a + 3.0 * s * s * t * b + 3.0 * s * t * t * c + t * t * t * d
}

/// `slope`, limited to `bound` in magnitude and to its sign.
fn limited(slope: f64, bound: f64) -> f64 {
    if slope * bound <= 0.0 { 0.0 } else { slope.abs().min(bound.abs()).copysign(bound) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_of_a_parabola_are_exact_at_uneven_steps_up_to_both_ends() {
        for [value, step] in [[1.0, 1.0], [1e-6, 1.0], [-3.0, 1e4]] {
            let places = [0.0, 1.0, 3.0, 4.5, 4.75];
            let steps: Vec<f64> = places.windows(2).map(|pair| step * (pair[1] - pair[0])).collect();
            let values = places.map(|t| value * (t * t + 10.0 * t + 3.0));
            for (slope, t) in monotone_slopes(&values, &steps).iter().zip(places) {
                assert!((slope / (value / step * (2.0 * t + 10.0)) - 1.0).abs() < 1e-12, "{slope} at {t}");
            }
        }
    }

    #[test]
    fn slopes_are_at_most_twice_those_of_the_pieces_beside_and_none_where_these_turn() {
        // Secants 1, 9 and −2: parabolas have the slopes −3 and 5 at the first two values, 3.5 at the third and −7.5 at
        // the last.
        assert_eq!(monotone_slopes(&[0.0, 1.0, 10.0, 8.0], &[1.0; 3]), [0.0, 2.0, 0.0, -4.0]);
        // Secants 8 and 1 over steps of 1 and 2.
        let slopes = monotone_slopes(&[0.0, 8.0, 10.0], &[1.0, 2.0]);
        assert!((slopes[0] - (8.0 + 7.0 / 3.0)).abs() < 1e-14 && slopes[1] == 2.0 && slopes[2] == 0.0, "{slopes:?}");
        assert_eq!(monotone_slopes(&[1.0, 4.0], &[2.0]), [1.5, 1.5]);
    }

    #[test]
    fn a_cubic_has_the_values_and_slopes_at_its_ends() {
        // 1 + 2 t − t² + 3 t³ over a step of 2.
        let value = |t: f64| 1.0 + 2.0 * t - t * t + 3.0 * t * t * t;
        let slope = |t: f64| 2.0 - 2.0 * t + 9.0 * t * t;
        for share in [0.0, 0.25, 0.5, 0.9, 1.0] {
            let found = cubic([value(0.0), value(2.0)], [slope(0.0), slope(2.0)], 2.0, share);
            assert!((found - value(2.0 * share)).abs() < 1e-13, "{share}: {found}");
        }
    }

    #[test]
    fn a_parabola_is_met_between_its_inner_points_and_one_value_has_no_slope() {
        let (values, steps) = ([1.0, 4.0, 9.0, 16.0], [1.0; 3]);
        let slopes = monotone_slopes(&values, &steps);
        assert!((cubic([values[1], values[2]], [slopes[1], slopes[2]], 1.0, 0.5) - 6.25).abs() < 1e-14);
        assert_eq!(monotone_slopes(&[3.0], &[]), [0.0]);
        assert_eq!(monotone_slopes(&[], &[]), [0.0; 0]);
    }
}

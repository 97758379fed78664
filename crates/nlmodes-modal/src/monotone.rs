//! Cubic interpolation that goes beyond no value.

/// Slopes at values that follow each other at these steps: those of the parabola through three neighbours, limited so that each piece is
/// monotone (Steffen, *A simple method for monotonic interpolation in one dimension*, Astron. Astrophys. 239, 1990).
///
/// As many slopes as `values`, one more than `steps`, whose entries are positive; in units of a value over those of a step. A single value has the slope zero.
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

/// The cubic between two values with these slopes, a share `t` of the step from the first, from 0 to 1.
#[must_use]
pub fn cubic(values: [f64; 2], slopes: [f64; 2], step: f64, t: f64) -> f64 {
    let s = 1.0 - t;
    let [a, d] = values;
    let (b, c) = (a + step / 3.0 * slopes[0], d - step / 3.0 * slopes[1]);
    s * s * s * a + 3.0 * s * s * t * b + 3.0 * s * t * t * c + t * t * t * d
}

/// `slope`, no steeper than `bound` and never of the other sign.
fn limited(slope: f64, bound: f64) -> f64 {
    if slope * bound <= 0.0 { 0.0 } else { slope.abs().min(bound.abs()).copysign(bound) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_met_between_its_inner_points_and_one_value_has_no_slope() {
        let (values, steps) = ([1.0, 4.0, 9.0, 16.0], [1.0; 3]);
        let slopes = monotone_slopes(&values, &steps);
        assert!((cubic([values[1], values[2]], [slopes[1], slopes[2]], 1.0, 0.5) - 6.25).abs() < 1e-14);
        assert_eq!(monotone_slopes(&[3.0], &[]), [0.0]);
        assert_eq!(monotone_slopes(&[], &[]), [0.0; 0]);
    }
}

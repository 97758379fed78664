//! A root within a bracket.

/// Point before `high` at which a function that is not negative at `low` becomes negative, by Newton's method
/// safeguarded by the bracket. `evaluate` returns the function and its slope.
pub(crate) fn falls_below_zero(mut evaluate: impl FnMut(f64) -> [f64; 2], mut low: f64, mut high: f64) -> f64 {
    let mut t = 0.5 * (low + high);
    for _ in 0..200 {
        let [value, slope] = evaluate(t);
        if value >= 0.0 {
            low = t;
        } else {
            high = t;
        }
        let newton = t - value / slope;
        if (newton - t).abs() <= f64::EPSILON * t.abs() && (low..=high).contains(&newton) {
            return newton;
        }
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if next == low || next == high {
            return next;
        }
        t = next;
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The root, and the number of function evaluations.
    fn root(f: impl Fn(f64) -> [f64; 2], low: f64, high: f64) -> (f64, usize) {
        let mut asked = 0;
        let counted = |t: f64| {
            asked += 1;
            assert!((low..=high).contains(&t), "{t}");
            f(t)
        };
        let found = falls_below_zero(counted, low, high);
        (found, asked)
    }

    #[test]
    fn roots_are_found_to_rounding_by_few_evaluations_wherever_they_are() {
        for at in [1e-3, 0.3, 0.5, 0.999] {
            // A line takes two, one step and one check, and one more if rounding matters for a small root; a sine
            // converges cubically.
            let (found, asked) = root(|t| [at - t, -1.0], 0.0, 1.0);
            assert!((found - at).abs() <= f64::EPSILON * at && asked <= 3, "{at}: {found}, {asked}");
            let (found, asked) = root(|t| [-(t - at).sin(), -(t - at).cos()], 0.0, 1.0);
            assert!((found - at).abs() <= 2.0 * f64::EPSILON * at && asked <= 6, "{at}: {found}, {asked}");
        }
    }

    #[test]
    fn where_newton_leaves_the_bracket_it_is_halved() {
        // A steep step with flat tails: Newton's method alone diverges from everywhere but the step.
        let step = |t: f64| [-(300.0 * (t - 0.123)).atan(), -300.0 / (1.0 + (300.0 * (t - 0.123)).powi(2))];
        let (found, asked) = root(step, 0.0, 1.0);
        // From 0.5 by some eight bisections to within 1/300 of the root, and then by Newton's method.
        assert!((found - 0.123).abs() < 1e-16 && asked <= 14, "{found}, {asked}");
        // A triple root: each step reduces the distance by a factor of two thirds, to 1e-16 after 90.
        let (found, asked) = root(|t| [-(t - 0.3).powi(3), -3.0 * (t - 0.3).powi(2)], 0.0, 1.0);
        assert!((found - 0.3).abs() < 1e-15 && asked < 95, "{found}, {asked}");
    }
}

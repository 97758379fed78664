//! Roots of functions of one variable.

/// Most evaluations.
const MOST: usize = 80;

/// A root of `f` between `a` and `b`, at which its values `fa`, `fb` have different signs, known to `width`:
/// Chandrupatla's method, which interpolates by an inverse quadratic where that is safe and halves the bracket where it
/// is not.
///
/// Reference: T. R. Chandrupatla, Advances in Engineering Software 28 (1997) 145-149,
/// doi:10.1016/S0965-9978(96)00051-8.
pub(crate) fn bracketed_root(
    mut f: impl FnMut(f64) -> f64,
    (a, fa): (f64, f64),
    (b, fb): (f64, f64),
    width: f64,
) -> f64 {
    let (mut x1, mut f1, mut x2, mut f2) = (b, fb, a, fa);
    let mut share = if fa == fb { 0.5 } else { fb / (fb - fa) };
    for _ in 0..MOST {
        let x = x1 + share * (x2 - x1);
        let fx = f(x);
        let (x3, f3) = if (fx > 0.0) == (f1 > 0.0) {
            (x1, f1)
        } else {
            let last = (x2, f2);
            (x2, f2) = (x1, f1);
            last
        };
        (x1, f1) = (x, fx);
        let least = 0.5 * width / (x2 - x1).abs();
        if f1 == 0.0 || least >= 0.5 {
            break;
        }
        let (xi, phi) = ((x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2));
        let safe = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
        share = if safe {
            f1 / (f2 - f1) * f3 / (f2 - f3) + (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2)
        } else {
            0.5
        };
        share = share.clamp(least, 1.0 - least);
    }
    if f1.abs() < f2.abs() { x1 } else { x2 }
}

#[cfg(test)]
mod tests {
    use super::bracketed_root;

    fn check(f: impl Fn(f64) -> f64, a: f64, b: f64, expected: f64, most: usize) {
        for [a, b] in [[a, b], [b, a]] {
            let (mut count, mut least) = (0, f(a).abs().min(f(b).abs()));
            let counted = |x: f64| {
                count += 1;
                least = least.min(f(x).abs());
                f(x)
            };
            let found = bracketed_root(counted, (a, f(a)), (b, f(b)), 1e-13);
            assert!((found - expected).abs() < 1e-12, "{found} for {expected}");
            assert!(count <= most, "{count} evaluations");
            // Of a function that rises or falls, nothing closer to zero was met.
            assert!(f(found).abs() <= least, "{:e}, but {least:e}", f(found));
        }
    }

    #[test]
    fn smooth_functions_take_ten_evaluations_and_steps_no_more_than_halving() {
        check(|x| x * x * x - 2.0, 0.0, 2.0, 2_f64.cbrt(), 12);
        check(|x| x.cos(), 1.0, 3.0, std::f64::consts::FRAC_PI_2, 10);
        check(|x| x.exp() - 1e3, 0.0, 10.0, 1e3_f64.ln(), 14);
        check(|x| if x < 0.7 { 1.0 } else { -1.0 }, 0.0, 2.0, 0.7, 50);
        check(|x| (x - 0.3).abs().sqrt() * (x - 0.3).signum(), 0.0, 2.0, 0.3, 60);
    }

    /// The secant of a straight line hits its zero, here without rounding. That of the function with a bend, from (0,
    /// −1) to (2, 1), hits the bend.
    #[test]
    fn a_zero_that_is_hit_ends_the_search_and_another_value_does_not() {
        check(|x| x - 0.5, 0.0, 2.0, 0.5, 1);
        check(|x| 0.25 * x + 0.25, -2.0, 2.0, -1.0, 1);
        for bend in [0.125_f64, -0.125, 0.5] {
            let f = |x: f64| if x < 1.0 { (1.0 + bend) * x - 1.0 } else { bend + (1.0 - bend) * (x - 1.0) };
            let root = if bend > 0.0 { 1.0 / (1.0 + bend) } else { 1.0 - bend / (1.0 - bend) };
            check(f, 0.0, 2.0, root, 60);
        }
    }
}

//! Variables on which a quantity does not depend.

use nlmodes::linalg::{DenseLu, Mat};

/// Largest share of the spread of a quantity that a variable may explain on which it is said not to depend.
const SHARE: f64 = 1e-3;
/// Cases for each coefficient of the fit.
const CASES: usize = 4;
/// Standard errors of a coefficient that count as its effect, too.
const ERRORS: f64 = 2.0;

/// What a quantity depends on.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Independence {
    /// Whether its whole spread is below the error of the computation.
    pub of_all: bool,
    /// Numbers of the variables over whose range it changes by less than a thousandth of its spread.
    pub of: Vec<usize>,
}

/// Judges the cases with values `y` and their errors (0 where none is known), over the variables `x` (a list each): by
/// the whole spread, and by a linear fit, of each variable its effect over its range with what is uncertain of it.
pub fn independence(x: &[Vec<f64>], y: &[f64], errors: &[f64]) -> Independence {
    let span = |values: &[f64]| {
        let [low, high] = values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(*v), b.max(*v)]);
        high - low
    };
    let (n, d, spread) = (y.len(), x.len(), span(y));
    let error = errors.iter().copied().fold(0.0, f64::max);
    let rounding = y.iter().map(|v| v.abs()).fold(0.0, f64::max) * ROUNDING;
    if n > 1 && spread <= (2.0 * error).max(rounding) {
        return Independence { of_all: true, of: Vec::new() };
    }
    if d < 2 || n < CASES * (d + 1) {
        return Independence::default();
    }
    effects(x, y).map_or_else(Independence::default, |effects| Independence {
        of_all: false,
        of: (0..d).filter(|v| span(&x[*v]) > 0.0 && effects[*v] * span(&x[*v]) < SHARE * spread).collect(),
    })
}

/// Relative spread that rounding and the tolerance of the continuation leave of what stays the same.
const ROUNDING: f64 = 1e-8;

/// Magnitude of the slope of each variable in a linear fit, with its standard errors; none where the variables are not
/// independent of each other.
fn effects(x: &[Vec<f64>], y: &[f64]) -> Option<Vec<f64>> {
    let (n, d) = (y.len(), x.len());
    let mean = |values: &[f64]| values.iter().sum::<f64>() / n as f64;
    let centred = |values: &[f64]| {
        let mean = mean(values);
        values.iter().map(|v| v - mean).collect::<Vec<f64>>()
    };
    let (columns, y): (Vec<Vec<f64>>, Vec<f64>) = (x.iter().map(|column| centred(column)).collect(), centred(y));
    let size = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>().sqrt();
    let sizes: Vec<f64> = columns.iter().map(|column| size(column)).collect();
    if sizes.contains(&0.0) {
        return None;
    }
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let normal = Mat::from_fn(d, d, |i, j| product(&columns[i], &columns[j]) / (sizes[i] * sizes[j]));
    let lu = DenseLu::factor(&normal).ok()?;
    let mut slopes: Vec<f64> = (0..d).map(|i| product(&columns[i], &y) / sizes[i]).collect();
    lu.solve_in_place(&mut slopes);
    let fitted = |k: usize| (0..d).map(|i| slopes[i] * columns[i][k] / sizes[i]).sum::<f64>();
    let left = (0..n).map(|k| (y[k] - fitted(k)).powi(2)).sum::<f64>() / (n - d - 1) as f64;
    let inverse = lu.solve_columns(&Mat::from_fn(d, d, |i, j| f64::from(u8::from(i == j))));
    let effect = |i: usize| {
        let uncertain = (left * inverse[(i, i)].abs()).sqrt();
        (slopes[i].abs() + ERRORS * uncertain) / sizes[i]
    };
    let effects: Vec<f64> = (0..d).map(effect).collect();
    effects.iter().all(|effect| effect.is_finite()).then_some(effects)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points that fill a square evenly.
    fn square() -> [Vec<f64>; 2] {
        let of = |factor: f64| (1..=200).map(|k| (f64::from(k) * factor).fract()).collect::<Vec<f64>>();
        [of(0.754_877_666_246_692_8), of(0.569_840_290_998_053_3)]
    }

    #[test]
    fn what_does_not_change_depends_on_nothing() {
        let [a, b] = square();
        let y = vec![52.3004; a.len()];
        assert!(independence(&[a.clone(), b.clone()], &y, &[0.0]).of_all);
        // Within the error of interpolation.
        let y: Vec<f64> = a.iter().map(|a| 50.0 + 1e-5 * a).collect();
        assert!(independence(&[a.clone(), b.clone()], &y, &[1e-5]).of_all);
        assert!(!independence(&[a, b], &y, &[1e-7]).of_all);
    }

    #[test]
    fn a_variable_without_effect_is_named_and_one_with_a_small_one_is_not() {
        let [a, b] = square();
        let of =
            |share: f64| a.iter().zip(&b).map(|(a, b)| 1.0 + 0.02 * a.sqrt().mul_add(0.01, *a) + share * b).collect();
        let found = |share: f64| -> Vec<usize> {
            let y: Vec<f64> = of(share);
            independence(&[a.clone(), b.clone()], &y, &[0.0]).of
        };
        assert_eq!(found(0.0), [1]);
        assert!(found(1e-3).is_empty());
    }
}

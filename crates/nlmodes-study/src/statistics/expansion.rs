//! Sobol' indices from an expansion in polynomials (polynomial chaos), fitted to cases and their gradients.
//!
//! ```text
//! q(x) ≈ Σ_α c_α Π_k p_{α_k}(x_k) ,   E[p_i p_j] = δ_ij ,   |α| ≤ degree
//! S_k = Σ_{α of k alone} c_α²/V ,   T_k = Σ_{α_k > 0} c_α²/V ,   V = Σ_{α ≠ 0} c_α²
//! ```
//!
//! Least squares for `c` of the values of the cases and of what they change by over a standard deviation of each
//! variable. The degree is the one whose predictions of cases that are left out, with their gradients, have the least
//! mean square, `ε V`.
//!
//! An index is the squared cosine of the angle between the quantity and a space of functions, and what is left out of
//! the quantity, `√(ε V)`, turns it by `asin √ε` at most: the index is right to `2 √(S (1 − S) ε) + ε`.

use nlmodes::linalg::{DenseLu, Mat};
use serde::Serialize;
use serde_json::Value;

use super::sobol::SobolIndex;
use crate::distribution::Tolerance;
use crate::study::{Design, Values, Variable};

/// Highest degree; cases are too few for it long before.
const MOST_DEGREE: usize = 12;
/// Fewest cases.
const FEWEST: usize = 4;

/// What the indices of a quantity are from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Expansion {
    /// Degree of the polynomials.
    pub degree: usize,
    /// Number of their products.
    pub terms: usize,
    /// Number of cases.
    pub cases: usize,
    /// Number of cases with gradients.
    pub with_gradients: usize,
    /// Mean of the quantity.
    pub mean: f64,
    /// Its standard deviation.
    pub std: f64,
    /// Mean square by which a case that is left out is missed, as a share of the variance.
    pub left_out: f64,
}

/// A case: the values of the variables, that of the quantity, and its derivative by each variable where it is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    pub x: Vec<f64>,
    pub value: f64,
    pub slope: Option<Vec<f64>>,
}

/// The orthonormal polynomials of a variable about its mean, in standard deviations.
#[derive(Debug, Clone, PartialEq)]
pub struct Polynomials {
    tolerance: Tolerance,
    /// `a_k` and `b_{k+1}` of `b_{k+1} p_{k+1} = (ξ − a_k) p_k − b_k p_{k−1}`.
    recurrence: Vec<[f64; 2]>,
}

/// Nodes of the double exponential rule, and how far they go on either side: to 1e-15 of the probability.
const NODES: usize = 400;
const REACH: f64 = 3.1;

impl Polynomials {
    /// Those of a variable of a study.
    ///
    /// # Errors
    /// Why it has none, as [`Tolerance::of`].
    pub fn of(variable: &Variable, design: &Design) -> Result<Self, String> {
        let tolerance = Tolerance::of(variable, design)?;
        let listed = |values: &Vec<Vec<Value>>| {
            values.iter().filter_map(|row| Some((row.first()?.as_f64()?, 1.0))).collect::<Vec<_>>()
        };
        let nodes = match &variable.values {
            Values::Listed(values) => listed(values),
            Values::Drawn(distribution) => (0..=NODES)
                .map(|j| {
                    let t = REACH * (2.0 * j as f64 / NODES as f64 - 1.0);
                    let u = 1.0 / (1.0 + (-std::f64::consts::PI * t.sinh()).exp());
                    (distribution.quantile(u), t.cosh() * u * (1.0 - u))
                })
                .collect(),
        };
        let all: f64 = nodes.iter().map(|(_, weight)| weight).sum();
        let nodes: Vec<[f64; 2]> =
            nodes.iter().map(|(x, weight)| [(x - tolerance.mean) / tolerance.std, weight / all]).collect();
        let mean =
            |values: &dyn Fn(usize) -> f64| nodes.iter().enumerate().map(|(j, at)| at[1] * values(j)).sum::<f64>();
        let (mut before, mut own, mut b) = (vec![0.0; nodes.len()], vec![1.0; nodes.len()], 0.0);
        let mut recurrence = Vec::new();
        while recurrence.len() < MOST_DEGREE && tolerance.std > 0.0 {
            let a = mean(&|j| nodes[j][0] * own[j] * own[j]);
            let next: Vec<f64> = (0..nodes.len()).map(|j| (nodes[j][0] - a) * own[j] - b * before[j]).collect();
            b = mean(&|j| next[j] * next[j]).sqrt();
            // Of n values there are n polynomials.
            if b <= f64::EPSILON.sqrt() {
                break;
            }
            recurrence.push([a, b]);
            before = std::mem::replace(&mut own, next.iter().map(|p| p / b).collect());
        }
        Ok(Self { tolerance, recurrence })
    }

    /// Values up to a degree, and their derivatives by ξ.
    fn at(&self, x: f64, degree: usize) -> Vec<[f64; 2]> {
        let xi = if self.recurrence.is_empty() { 0.0 } else { (x - self.tolerance.mean) / self.tolerance.std };
        let (mut all, mut before, mut b) = (vec![[1.0, 0.0]], [0.0, 0.0], 0.0);
        for [a, next] in self.recurrence.iter().take(degree) {
            let [p, dp] = all[all.len() - 1];
            let new = [((xi - a) * p - b * before[0]) / next, (p + (xi - a) * dp - b * before[1]) / next];
            (before, b) = ([p, dp], *next);
            all.push(new);
        }
        all
    }
}

/// A fit: its terms with their coefficients, and the mean square by which a case that is left out is missed.
struct Fit {
    terms: Vec<Vec<usize>>,
    c: Vec<f64>,
    missed: f64,
}

/// The expansion of a quantity, and the indices of each variable; none where too few cases have it, or it is constant.
pub fn expansion(variables: &[Polynomials], cases: &[Sample]) -> Option<(Expansion, Vec<SobolIndex>)> {
    if cases.len() < FEWEST {
        return None;
    }
    let fits = (0..=MOST_DEGREE).map_while(|degree| Some((degree, fit(variables, cases, degree)?)));
    let (degree, Fit { terms, c, missed }) = fits.min_by(|a, b| a.1.missed.total_cmp(&b.1.missed))?;
    let share = |which: &dyn Fn(&[usize]) -> bool| {
        terms.iter().zip(&c).filter(|(term, _)| which(term)).map(|(_, c)| c * c).sum::<f64>()
    };
    let variance = share(&|term| term.iter().any(|k| *k > 0));
    (variance > 0.0).then_some(())?;
    let left_out = (missed / variance).min(1.0);
    let with_error = |index: f64| (index, 2.0 * (index * (1.0 - index).max(0.0) * left_out).sqrt() + left_out);
    let index = |k: usize| {
        let alone = |term: &[usize]| term[k] > 0 && term.iter().enumerate().all(|(j, degree)| j == k || *degree == 0);
        let (first, first_error) = with_error(share(&alone) / variance);
        let (total, total_error) = with_error(share(&|term| term[k] > 0) / variance);
        SobolIndex { first, first_error, total, total_error }
    };
    let expansion = Expansion {
        degree,
        terms: terms.len(),
        cases: cases.len(),
        with_gradients: cases.iter().filter(|case| case.slope.is_some()).count(),
        mean: c.first().copied().unwrap_or_default(),
        std: variance.sqrt(),
        left_out,
    };
    Some((expansion, (0..variables.len()).map(index).collect()))
}

/// The fit of a degree; none where the cases are too few for it.
fn fit(variables: &[Polynomials], cases: &[Sample], degree: usize) -> Option<Fit> {
    let most: Vec<usize> = variables.iter().map(|one| one.recurrence.len().min(degree)).collect();
    let terms = terms(&most, degree);
    let blocks: Vec<usize> = cases.iter().map(|case| 1 + case.slope.as_ref().map_or(0, Vec::len)).collect();
    let rows: usize = blocks.iter().sum();
    if rows - blocks.iter().max()? < terms.len() {
        return None;
    }
    let (mut a, mut y) = (Mat::zeros(rows, terms.len()), Vec::new());
    for case in cases {
        let at: Vec<Vec<[f64; 2]>> = variables.iter().zip(&case.x).map(|(one, x)| one.at(*x, degree)).collect();
        let product = |term: &[usize], by: Option<usize>| -> f64 {
            term.iter().enumerate().map(|(k, p)| at[k][*p][usize::from(by == Some(k))]).product()
        };
        let by = case.slope.iter().flat_map(|slope| slope.iter().enumerate());
        let by = by.map(|(k, slope)| (Some(k), slope * variables[k].tolerance.std));
        for (by, value) in std::iter::once((None, case.value)).chain(by) {
            (0..terms.len()).for_each(|j| a[(y.len(), j)] = product(&terms[j], by));
            y.push(value);
        }
    }
    let lu = DenseLu::factor(&(a.transpose() * &a)).ok().filter(|lu| lu.pivot_ratio() > f64::EPSILON)?;
    let inverse = lu.solve_columns(&a.transpose().to_owned());
    let c: Vec<f64> = (0..terms.len()).map(|j| (0..rows).map(|i| inverse[(j, i)] * y[i]).sum()).collect();
    let mut missed = 0.0;
    let mut from = 0;
    for size in blocks {
        // Without these rows the residual of them would be `(1 − H)⁻¹ r`.
        let own = a.submatrix(from, 0, size, terms.len()) * inverse.submatrix(0, from, terms.len(), size);
        let mut left: Vec<f64> =
            (from..from + size).map(|i| y[i] - (0..terms.len()).map(|j| a[(i, j)] * c[j]).sum::<f64>()).collect();
        let others = Mat::from_fn(size, size, |i, j| f64::from(u8::from(i == j)) - own[(i, j)]);
        DenseLu::factor(&others).ok()?.solve_in_place(&mut left);
        missed += left[0] * left[0] / cases.len() as f64;
        from += size;
    }
    Some(Fit { terms, c, missed })
}

/// The degrees of all products of a total degree, the constant first.
fn terms(most: &[usize], degree: usize) -> Vec<Vec<usize>> {
    let Some((first, others)) = most.split_first() else { return vec![Vec::new()] };
    let of = |k: usize| terms(others, degree - k).into_iter().map(move |rest| [vec![k], rest].concat());
    (0..=degree.min(*first)).flat_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::distribution::Distribution;

    const DISTRIBUTIONS: [Distribution; 4] = [
        Distribution::Uniform { low: -3.0, high: 5.0 },
        Distribution::Normal { mean: 2.0, std: 0.5, min: f64::NEG_INFINITY, max: f64::INFINITY },
        Distribution::LogUniform { low: 1e-3, high: 4e-3 },
        Distribution::Normal { mean: 0.0, std: 1.0, min: 0.0, max: 2.0 },
    ];

    fn polynomials(values: Values) -> Polynomials {
        let design = Design { box_deviations: 3.0, ..Design::default() };
        Polynomials::of(&Variable { name: "x".into(), keys: vec!["x".into()], values }, &design).unwrap()
    }

    /// Against those of Legendre and Hermite, and means over many quantiles.
    #[test]
    fn polynomials_are_orthonormal_in_their_distribution() {
        let [uniform, normal, ..] = DISTRIBUTIONS.map(|one| polynomials(Values::Drawn(one)));
        for x in [-2.5, 0.3, 4.9] {
            let t = (x - 1.0) / 4.0;
            let of = uniform.at(x, 3);
            assert!((of[2][0] - 5f64.sqrt() * (1.5 * t * t - 0.5)).abs() < 1e-10, "{of:?}");
            assert!((of[3][0] - 7f64.sqrt() * (2.5 * t * t - 1.5) * t).abs() < 1e-10, "{of:?}");
            let (z, of) = ((x - 2.0) / 0.5, normal.at(x, 3));
            assert!((of[3][0] - (z * z - 3.0) * z / 6f64.sqrt()).abs() < 1e-9 * z.abs().powi(3), "{of:?}");
            assert!((of[3][1] - 3.0 * (z * z - 1.0) / 6f64.sqrt()).abs() < 1e-8 * z * z, "{of:?}");
        }
        for distribution in DISTRIBUTIONS {
            let (own, n) = (polynomials(Values::Drawn(distribution)), 100_000);
            let mut sums = [[0.0; 4]; 4];
            for j in 0..n {
                let at = own.at(distribution.quantile((f64::from(j) + 0.5) / f64::from(n)), 3);
                (0..16).for_each(|k| sums[k / 4][k % 4] += at[k / 4][0] * at[k % 4][0] / f64::from(n));
            }
            for (k, sum) in sums.iter().flatten().enumerate() {
                let expected = f64::from(u8::from(k / 4 == k % 4));
                assert!((sum - expected).abs() < 2e-2, "{distribution:?} {k}: {sum}");
            }
        }
        let listed = Values::Listed([1.0, 2.0, 4.0].map(|x| vec![Value::from(x)]).to_vec());
        assert_eq!(polynomials(listed).recurrence.len(), 2);
    }

    /// A function of the variables, with its derivatives.
    type Differentiable<'f> = &'f dyn Fn(&[f64]) -> (f64, Vec<f64>);

    /// `x₀ + x₁² + 2 x₀ x₂` of independent standard normal and uniform variables: variances by hand.
    #[test]
    fn indices_of_a_polynomial_are_exact_and_those_of_other_functions_right_to_what_is_said() {
        let normal = Distribution::Normal { mean: 0.0, std: 1.0, min: f64::NEG_INFINITY, max: f64::INFINITY };
        let variables = [normal, normal, Distribution::Uniform { low: -1.0, high: 1.0 }];
        let bases = variables.map(|one| polynomials(Values::Drawn(one)));
        let sample = |f: Differentiable<'_>, n: usize| -> Vec<Sample> {
            let at = |j: usize| {
                let u = [0.819_172_5, 0.671_043_6, 0.549_700_5].map(|a| (0.5 + a * (j + 1) as f64).fract());
                let x: Vec<f64> = variables.iter().zip(u).map(|(one, u)| one.quantile(u)).collect();
                let (value, slope) = f(&x);
                Sample { x, value, slope: Some(slope) }
            };
            (0..n).map(at).collect()
        };
        let polynomial =
            |x: &[f64]| (x[0] + x[1] * x[1] + 2.0 * x[0] * x[2], vec![1.0 + 2.0 * x[2], 2.0 * x[1], 2.0 * x[0]]);
        let (found, indices) = expansion(&bases, &sample(&polynomial, 8)).unwrap();
        assert!(found.degree >= 2 && found.left_out < 1e-20, "{found:?}");
        let variance: f64 = 1.0 + 2.0 + 4.0 / 3.0;
        assert!((found.mean - 1.0).abs() < 1e-10 && (found.std - variance.sqrt()).abs() < 1e-10, "{found:?}");
        let mixed = 4.0 / 3.0 / variance;
        for (k, [first, total]) in
            [[1.0 / variance, 1.0 / variance + mixed], [2.0 / variance; 2], [0.0, mixed]].into_iter().enumerate()
        {
            assert!((indices[k].first - first).abs() < 1e-10 && (indices[k].total - total).abs() < 1e-10, "{k}");
        }
        // Σ aᵢ xᵢ + exp(xᵢ bᵢ): sums of functions of one variable each, whose variances are known.
        let (a, b) = ([1.0, 0.5, 0.2], [0.5, 0.3, 1.5]);
        let sum = |x: &[f64]| {
            let of = |k: usize| (a[k] * x[k] + (b[k] * x[k]).exp(), a[k] + b[k] * (b[k] * x[k]).exp());
            ((0..3).map(|k| of(k).0).sum(), (0..3).map(|k| of(k).1).collect())
        };
        let of_normal = |a: f64, b: f64| {
            let mean = (0.5 * b * b).exp();
            a * a + 2.0 * a * b * mean + mean * mean * ((b * b).exp() - 1.0)
        };
        let of_uniform = |a: f64, b: f64| {
            let (mean, square) = (b.sinh() / b, (2.0 * b).sinh() / (2.0 * b));
            a * a / 3.0 + 2.0 * a * (b.cosh() / b - b.sinh() / (b * b)) + square - mean * mean
        };
        let own = [of_normal(a[0], b[0]), of_normal(a[1], b[1]), of_uniform(a[2], b[2])];
        let variance: f64 = own.iter().sum();
        let mut before = f64::INFINITY;
        for n in [6, 12, 24] {
            let (found, indices) = expansion(&bases, &sample(&sum, n)).unwrap();
            for (index, own) in indices.iter().zip(own) {
                let [first, total] = [(index.first, index.first_error), (index.total, index.total_error)]
                    .map(|(index, error)| ((index - own / variance).abs(), error));
                assert!(first.0 <= first.1 && total.0 <= total.1, "{n} {found:?} {index:?} {}", own / variance);
            }
            assert!(found.left_out < before, "{n}: {found:?}");
            before = found.left_out;
        }
    }

    #[test]
    fn a_case_without_a_gradient_counts_by_its_value() {
        let bases = [polynomials(Values::Drawn(DISTRIBUTIONS[0]))];
        let at = |x: f64, known: bool| Sample { x: vec![x], value: x * x, slope: known.then(|| vec![2.0 * x]) };
        let cases = [at(-2.0, true), at(0.0, false), at(1.0, false), at(3.0, true), at(4.5, false)];
        let (found, indices) = expansion(&bases, &cases).unwrap();
        assert!(found.with_gradients == 2 && found.cases == 5 && found.left_out < 1e-20, "{found:?}");
        assert!((indices[0].first - 1.0).abs() < 1e-12);
        assert_eq!(expansion(&bases, &cases[..3]), None);
        let constant = cases.map(|case| Sample { value: 2.0, slope: None, ..case });
        assert!(expansion(&bases, &constant).is_none_or(|(found, _)| found.std < 1e-12));
    }
}

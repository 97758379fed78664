use nlmodes_linalg::Mat;

use crate::first_root::{Approximation, Guard, first_negative, root};
use crate::phase::{dot, transposed_product};

/// Order of the power series of a step: with `‖𝒜‖ h ≤ 2` the remainder is below `2²⁷ / 27! = 2e-20` of the state.
pub(super) const ORDER: usize = 26;

/// That remainder.
const LEFT: f64 = 2e-20;

/// A row along the flow of a step of length `h`, `r e^{𝒜 h τ} w = Σ_k (r_k w) τ^k` with `r_k = r (h 𝒜)^k / k!`.
#[derive(Debug, Clone)]
pub struct FlowSeries {
    rows: Vec<Vec<f64>>,
    /// The integral over a whole step.
    whole: Vec<f64>,
}

/// `Σ_k a_k τ^k` for τ from 0 to 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Polynomial {
    pub a: [f64; ORDER + 1],
    /// Scale of its rounding errors.
    pub size: f64,
}

impl FlowSeries {
    pub(super) fn new(row: &[f64], matrix: &Mat<f64>, step: f64) -> Self {
        let mut rows = vec![row.to_vec()];
        for k in 1..=ORDER {
            let mut next = transposed_product(matrix, &rows[k - 1]);
            next.iter_mut().for_each(|v| *v *= step / k as f64);
            rows.push(next);
        }
        let integral = |j: usize| rows.iter().enumerate().map(|(k, row)| row[j] / (k + 1) as f64).sum::<f64>();
        let whole = (0..row.len()).map(integral).collect();
        Self { rows, whole }
    }

    /// The polynomial from the state `w` on.
    pub(super) fn from(&self, w: &[f64]) -> Polynomial {
        let mut a = [0.0; ORDER + 1];
        self.rows.iter().zip(&mut a).for_each(|(row, a)| *a = dot(row, w));
        Polynomial { a, size: size(&self.rows[0], w) }
    }

    /// The polynomial from a `w` on of which one entry is one and all others are zero.
    pub(super) fn column(&self, entry: usize) -> Polynomial {
        let mut a = [0.0; ORDER + 1];
        self.rows.iter().zip(&mut a).for_each(|(row, a)| *a = row[entry]);
        Polynomial { a, size: a[0].abs() }
    }

    /// Where the row, which is zero or positive at `w`, first falls below zero on the way to `next`, `part` of a step
    /// later.
    #[must_use]
    pub fn first_fall(&self, w: &[f64], next: &[f64], part: f64) -> Option<f64> {
        let (before, after) = (self.leading(w), self.leading(next));
        let guard = may_fall(&before, &after).then(|| self.guard(w))?;
        first_negative(&[guard], part).map(|(when, _)| when)
    }

    /// The polynomial from `w` on of a row that is not negative there: after its contact instant it is zero to
    /// rounding.
    pub(super) fn guard(&self, w: &[f64]) -> Polynomial {
        let mut guard = self.from(w);
        guard.a[0] = guard.a[0].max(0.0);
        guard
    }

    /// The row.
    pub(super) fn row(&self) -> &[f64] {
        &self.rows[0]
    }

    /// Its first four coefficients.
    pub(super) fn leading(&self, w: &[f64]) -> [f64; 4] {
        [0, 1, 2, 3].map(|k| dot(&self.rows[k], w))
    }

    /// `∫ dτ` over the whole step from the state `w` on.
    pub(super) fn integral(&self, w: &[f64]) -> f64 {
        dot(&self.whole, w)
    }

    /// Value and slope over a step at `w`.
    pub(super) fn value_and_slope(&self, w: &[f64]) -> [f64; 2] {
        [dot(&self.rows[0], w), dot(&self.rows[1], w)]
    }
}

/// Whether a row can fall below zero between two instants within a step, with these leading coefficients there.
pub(super) fn may_fall(before: &[f64; 4], after: &[f64; 4]) -> bool {
    before[0].min(after[0]) <= reach(before).max(reach(after))
}

/// By how much a row may change within half a step: a step resolves all modes, each of which turns by no more than one
/// radian in half of it.
pub(super) fn reach(leading: &[f64; 4]) -> f64 {
    leading[1].abs() + leading[2].abs() + leading[3].abs()
}

/// Scale of the rounding errors of a row at `w`.
pub(super) fn size(row: &[f64], w: &[f64]) -> f64 {
    row.iter().zip(w).map(|(r, w)| (r * w).abs()).sum()
}

/// Terms of the power series of a step that its part up to τ needs for values and slopes to the rounding that the whole
/// step has.
pub(super) fn terms_within(tau: f64) -> usize {
    let mut slope = 1.0;
    let is_felt = |k: &usize| {
        let is_felt = slope > LEFT;
        slope *= 2.0 * tau / *k as f64;
        is_felt
    };
    (1..=ORDER).take_while(is_felt).count()
}

impl Polynomial {
    /// Value and slope with the terms up to this one.
    pub fn up_to(&self, terms: usize, t: f64) -> [f64; 2] {
        self.a[..=terms].iter().rev().fold([0.0; 2], |[value, slope], a| [value * t + a, slope * t + value])
    }

    /// Largest value up to `end`: where the slope falls through zero between samples, four for each radian of a step.
    pub fn highest(&self, end: f64) -> f64 {
        const CELLS: usize = 8;
        let negated = Self { a: self.a.map(|a| -a), size: self.size };
        let at = |j: usize| end * j as f64 / CELLS as f64;
        let mut most = self.evaluate(0.0)[0].max(self.evaluate(end)[0]);
        for j in 0..CELLS {
            let (from, to) = (negated.evaluate(at(j)), negated.evaluate(at(j + 1)));
            if from[1] < 0.0 && to[1] > 0.0 {
                most = most.max(self.evaluate(root(&negated, 1, at(j), at(j + 1)))[0]);
            }
        }
        most
    }

    /// `∫ dτ` from 0 to `end`.
    pub fn integral(&self, end: f64) -> f64 {
        let sum = (0..=ORDER).rev().fold(0.0, |sum, k| sum * end + self.a[k] / (k + 1) as f64);
        sum * end
    }
}

impl Guard for Polynomial {
    /// Middle and half-width of the cell.
    type Shared = (f64, f64);

    /// Of the third derivative.
    type Bounds = f64;

    fn bounds(&self) -> Option<f64> {
        let third: f64 = (3..=ORDER).map(|k| (k * (k - 1) * (k - 2)) as f64 * self.a[k].abs()).sum();
        third.is_finite().then_some(third)
    }

    fn share(&self, middle: f64, r: f64, shared: &mut (f64, f64)) {
        *shared = (middle, r);
    }

    fn approximate(&self, third: &f64, (middle, r): &(f64, f64)) -> Approximation {
        Approximation::taylor(self.evaluate(*middle), *third, *r)
    }

    fn evaluate(&self, t: f64) -> [f64; 3] {
        let [mut value, mut slope, mut half] = [0.0; 3];
        for a in self.a.iter().rev() {
            half = half * t + slope;
            slope = slope * t + value;
            value = value * t + a;
        }
        [value, slope, 2.0 * half]
    }

    fn size(&self) -> f64 {
        self.size
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of `Π (r_i − τ)`.
    fn product(roots: &[f64]) -> Polynomial {
        let mut a = [0.0; ORDER + 1];
        a[0] = 1.0;
        for root in roots {
            (1..=ORDER).rev().for_each(|k| a[k] = root * a[k] - a[k - 1]);
            a[0] *= root;
        }
        Polynomial { a, size: a[0].abs() }
    }

    #[test]
    fn the_smallest_root_is_found() {
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            0.05 + 2.95 * (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        for count in (1..7).cycle().take(600) {
            let mut roots: Vec<f64> = (0..count).map(|_| random()).collect();
            roots.sort_by(f64::total_cmp);
            if roots.windows(2).any(|pair| pair[1] - pair[0] < 0.02) {
                continue;
            }
            match first_negative(&[product(&roots)], 1.0) {
                Some((root, _)) => assert!((root - roots[0]).abs() < 1e-8, "{root} {roots:?}"),
                None => assert!(roots[0] >= 1.0 - 1e-8, "{roots:?}"),
            }
        }
    }

    #[test]
    fn a_short_dip_is_seen_and_a_touch_is_not() {
        // (τ − 1/2)² ∓ 1e-10
        let of = |a: [f64; 3]| {
            let mut all = [0.0; ORDER + 1];
            all[..3].copy_from_slice(&a);
            first_negative(&[Polynomial { a: all, size: a[0] }], 1.0).map(|(root, _)| root)
        };
        assert!((of([0.25 - 1e-10, -1.0, 1.0]).unwrap() - (0.5 - 1e-5)).abs() < 1e-10);
        assert_eq!(of([0.25 + 1e-10, -1.0, 1.0]), None);
        assert_eq!(of([0.0; 3]), None);
    }

    #[test]
    fn a_cosine_along_a_turn_has_its_values_roots_extremes_and_integral() {
        let turn = Mat::from_fn(2, 2, |i, j| [[0.0, 2.0], [-2.0, 0.0]][i][j]);
        let of = FlowSeries::new(&[1.0, 0.0], &turn, 1.0).from(&[0.6_f64.cos(), -0.6_f64.sin()]);
        for τ in [0.0_f64, 0.2, 0.7, 1.0] {
            let (sin, cos) = (0.6 + 2.0 * τ).sin_cos();
            let found = of.evaluate(τ);
            [cos, -2.0 * sin, -4.0 * cos].iter().zip(found).for_each(|(a, b)| assert!((a - b).abs() < 2e-15));
        }
        let quarter = 0.25 * std::f64::consts::PI - 0.3;
        let first = |end: f64| first_negative(std::slice::from_ref(&of), end);
        assert!((first(1.0).unwrap().0 - quarter).abs() < 1e-15);
        assert!(first(quarter - 1e-9).is_none());
        assert!((of.integral(0.8) - 0.5 * (2.2_f64.sin() - 0.6_f64.sin())).abs() < 1e-15);
        assert_eq!(of.highest(1.0), of.a[0]);
        let rising = FlowSeries::new(&[1.0, 0.0], &turn, 1.0).from(&[(-0.6_f64).cos(), 0.6_f64.sin()]);
        assert!((rising.highest(1.0) - 1.0).abs() < 1e-15);
    }
}

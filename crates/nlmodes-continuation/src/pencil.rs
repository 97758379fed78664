//! How often the Jacobian becomes singular between two points: eigenvalues of one Jacobian in terms of the other.

use nlmodes_linalg::{Mat, eigenvalues};

use crate::signs::Signs;
use crate::vectors::dot;
use crate::{LinearSolver, Linearization};

/// Vectors of the subspace in which it is looked whether anything may have changed its sign: at first, and where that
/// is not clear.
const SUBSPACE: [usize; 2] = [4, 12];

/// Rayleigh quotient above which nothing has.
const CLEAR: f64 = 0.25;

/// Ritz value below which all eigenvalues are computed.
const UNCLEAR: f64 = 0.1;

/// Largest imaginary part of an eigenvalue that counts as real, over its real part.
const REAL: f64 = 0.05;

/// Vectors of the subspace in which the eigenvalues of a large matrix are looked for, and how many it starts with: so
/// many times an eigenvalue may be repeated.
const LARGE: (usize, usize) = (48, 4);

/// Eigenvalue by which a Jacobian is known to be nearly singular beside another one, far away and close by, and steps
/// in which it would show.
pub(crate) const GROWN: f64 = 1e3;
pub(crate) const GROWN_NEAR: f64 = 1e2;
const INVERSE_STEPS: usize = 4;

/// `B = [J; cᵀ]` at a point: the Jacobian, with the row that was below it when the point was found, and its factors.
#[derive(Debug, Clone)]
pub(crate) struct Bordered {
    pub at: Linearization,
    pub row: Vec<f64>,
    pub solver: Box<dyn LinearSolver>,
}

impl Bordered {
    /// `[J; rowᵀ] v`.
    fn times(&self, row: &[f64], v: &[f64]) -> Vec<f64> {
        let mut product = self.at.times(v);
        product.push(dot(row, v));
        product
    }

    /// `B⁻¹ B'` times a vector, for another point, both with the row of this one.
    fn in_terms(&self, other: &Self, v: &[f64]) -> Vec<f64> {
        let mut product = other.times(&self.row, v);
        self.solver.solve_in_place(&mut product);
        product
    }

    /// Whether `B⁻¹ B'` may have eigenvalues that are not positive, as far as a small subspace tells.
    fn may_differ_in_sign(&self, other: &Self) -> bool {
        let n = self.row.len();
        let mut signs = Signs::default();
        // Not orthogonal to what is symmetric.
        let start: Vec<f64> = (0..n).map(|_| signs.draw_between()).collect();
        let length = dot(&start, &start).sqrt();
        let mut basis = vec![start.iter().map(|v| v / length).collect::<Vec<f64>>()];
        let mut h: Vec<Vec<f64>> = Vec::new();
        for k in 1..=SUBSPACE[1].min(n) {
            let mut next = self.in_terms(other, &basis[k - 1]);
            let size = dot(&next, &next).sqrt();
            if !size.is_finite() {
                return true;
            }
            let mut column = vec![0.0; k];
            // Twice is enough.
            for _ in 0..2 {
                for (c, b) in column.iter_mut().zip(&basis) {
                    let share = dot(b, &next);
                    *c += share;
                    next.iter_mut().zip(b).for_each(|(v, b)| *v -= share * b);
                }
            }
            let rest = dot(&next, &next).sqrt();
            let complete = rest <= 1e-10 * size || k == n;
            column.push(rest);
            h.push(column);
            if (k == SUBSPACE[0] || complete) && is_positive(&h) {
                return false;
            }
            if complete {
                break;
            }
            next.iter_mut().for_each(|v| *v /= rest);
            basis.push(next);
        }
        let k = h.len();
        let projected = Mat::from_fn(k, k, |i, j| h[j].get(i).copied().unwrap_or(0.0));
        eigenvalues(&projected)
            .map_or(true, |ritz| ritz.iter().any(|μ| μ.re < UNCLEAR && μ.im.abs() <= μ.re.abs().max(UNCLEAR)))
    }

    /// Shares of the way from another point to this one at which the Jacobian is singular, ascending, if it changes
    /// evenly; none where that can be ruled out at less expense.
    ///
    /// Each is an eigenvalue μ of `B⁻¹ B'` that is negative: `(1 − τ) B' + τ B` is singular at `τ = μ/(μ − 1)`. Neither
    /// the units of the unknowns nor those of the equations matter, nor whether the Jacobian is symmetric.
    pub fn singular_since(&self, other: &Self, certain: bool) -> Vec<f64> {
        if !certain && !self.may_differ_in_sign(other) && !other.may_differ_in_sign(self) {
            return Vec::new();
        }
        let all = self.eigenvalues_of(other);
        let negative = all.into_iter().filter(|(re, im)| *re < 0.0 && im.abs() <= REAL * re.abs());
        let mut shares: Vec<f64> = negative.map(|(μ, _)| μ / (μ - 1.0)).collect();
        shares.sort_by(f64::total_cmp);
        shares
    }

    /// The share of the way from another point to this one, be it beyond this one, at which the Jacobian becomes
    /// singular next to here.
    pub fn nearest_singular(&self, other: &Self) -> Option<f64> {
        let all = self.eigenvalues_of(other).into_iter().filter(|(re, im)| im.abs() <= REAL * re.abs());
        let (μ, _) = all.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))?;
        Some(μ / (μ - 1.0)).filter(|share| share.is_finite())
    }

    /// Whether this Jacobian is nearly singular beside another one, `B⁻¹ B'` having an eigenvalue above `grown`: a few
    /// steps of the power method, in which a direction that is nearly free outgrows the rest. The first of them tells
    /// the norm, which is large too where the units of the equations differ.
    pub fn is_singular_beside(&self, other: &Self, grown: f64) -> bool {
        let mut signs = Signs::default();
        let mut v: Vec<f64> = self.row.iter().map(|_| signs.draw_between()).collect();
        let mut length = dot(&v, &v).sqrt();
        for _ in 0..INVERSE_STEPS {
            v.iter_mut().for_each(|v| *v /= length);
            v = self.in_terms(other, &v);
            length = dot(&v, &v).sqrt();
            if !length.is_finite() {
                return true;
            }
        }
        length > grown
    }

    /// Eigenvalues of `B⁻¹ B'`: all of them, or where the solver is sparse those that lie outside of the rest. Those of
    /// a short step are one but for a few.
    fn eigenvalues_of(&self, other: &Self) -> Vec<(f64, f64)> {
        let matrix = if self.solver.is_sparse() { self.projected(other) } else { self.product(other) };
        eigenvalues(&matrix).map_or_else(|_| Vec::new(), |all| all.iter().map(|μ| (μ.re, μ.im)).collect())
    }

    /// `B⁻¹ B'` in the basis of a block Krylov subspace.
    fn projected(&self, other: &Self) -> Mat<f64> {
        let n = self.row.len();
        let mut signs = Signs::default();
        let mut images: Vec<Vec<f64>> = Vec::new();
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let mut starts = (0..LARGE.1.min(n)).map(|_| (0..n).map(|_| signs.draw_between()).collect::<Vec<f64>>());
        let mut taken = 0;
        while basis.len() < LARGE.0.min(n) {
            let next = starts.next().or_else(|| {
                taken += 1;
                images.get(taken - 1).cloned()
            });
            let Some(next) = next else { break };
            if let Some(unit) = orthonormal(next, &basis) {
                images.push(self.in_terms(other, &unit));
                basis.push(unit);
            }
        }
        Mat::from_fn(basis.len(), basis.len(), |i, j| dot(&basis[i], &images[j]))
    }

    fn product(&self, other: &Self) -> Mat<f64> {
        let n = self.row.len();
        let mut product = Mat::zeros(n, n);
        for j in 0..n {
            let unit: Vec<f64> = (0..n).map(|i| if i == j { 1.0 } else { 0.0 }).collect();
            let column = self.in_terms(other, &unit);
            product.col_mut(j).iter_mut().zip(&column).for_each(|(to, from)| *to = *from);
        }
        product
    }
}

/// The part of a vector that is orthogonal to these unit vectors, as a unit vector; `None` where nothing is left but
/// rounding.
pub(crate) fn orthonormal(mut v: Vec<f64>, basis: &[Vec<f64>]) -> Option<Vec<f64>> {
    let size = dot(&v, &v).sqrt();
    // Twice is enough.
    for _ in 0..2 {
        for b in basis {
            let share = dot(b, &v);
            v.iter_mut().zip(b).for_each(|(v, b)| *v -= share * b);
        }
    }
    let rest = dot(&v, &v).sqrt();
    (rest > 1e-10 * size).then(|| v.iter().map(|v| v / rest).collect())
}

/// Whether the symmetric part of the projected matrix, whose columns these are, exceeds a multiple of one: by
/// elimination.
fn is_positive(columns: &[Vec<f64>]) -> bool {
    let k = columns.len();
    let entry = |i: usize, j: usize| columns[j].get(i).copied().unwrap_or(0.0);
    let shifted = |i: usize, j: usize| 0.5 * (entry(i, j) + entry(j, i)) - if i == j { CLEAR } else { 0.0 };
    let mut a: Vec<Vec<f64>> = (0..k).map(|i| (0..k).map(|j| shifted(i, j)).collect()).collect();
    for p in 0..k {
        let (above, below) = a.split_at_mut(p + 1);
        let pivot = &above[p];
        if pivot[p] <= 0.0 {
            return false;
        }
        for row in below {
            let factor = row[p] / pivot[p];
            row.iter_mut().zip(pivot).skip(p).for_each(|(entry, pivot)| *entry -= factor * pivot);
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DenseSolver, SparseSolver};

    /// A matrix with this row at its end, factored.
    fn bordered(b: &Mat<f64>, sparse: bool) -> Bordered {
        let n = b.nrows() - 1;
        let mut solver: Box<dyn LinearSolver> =
            if sparse { Box::<SparseSolver>::default() } else { Box::<DenseSolver>::default() };
        let mut at = Linearization::for_solver(&*solver, n);
        let places = (0..n).flat_map(|i| (0..=n).map(move |j| (i, j)));
        match sparse {
            true => at.entries = places.map(|(i, j)| (i, j, b[(i, j)])).collect(),
            false => places.for_each(|(i, j)| at.jacobian[(i, j)] = b[(i, j)]),
        }
        let row: Vec<f64> = (0..=n).map(|j| b[(n, j)]).collect();
        solver.factor(&at, &row).unwrap();
        Bordered { at, row, solver }
    }

    /// `B` and `B' = B P`, where `P` is one but for these eigenvalues, whose vectors are orthogonal to the row at the
    /// end of `B`, which thus stays.
    fn pair(size: usize, eigenvalues: &[f64], sparse: bool) -> [Bordered; 2] {
        let mut signs = Signs::default();
        let b = Mat::from_fn(size, size, |i, j| signs.draw_between() + if i == j { 3.0 } else { 0.0 });
        let row: Vec<f64> = (0..size).map(|j| b[(size - 1, j)]).collect();
        let mut basis = vec![orthonormal(row, &[]).unwrap()];
        let mut p = Mat::<f64>::identity(size, size);
        for μ in eigenvalues {
            let v = orthonormal((0..size).map(|_| signs.draw_between()).collect(), &basis).unwrap();
            (0..size).for_each(|i| (0..size).for_each(|j| p[(i, j)] += (μ - 1.0) * v[i] * v[j]));
            basis.push(v);
        }
        [bordered(&b, sparse), bordered(&(&b * &p), sparse)]
    }

    /// On the way from `B'` to `B` the matrix is singular where `(1 − τ) μ + τ = 0`.
    #[test]
    fn a_matrix_is_singular_where_its_eigenvalues_on_the_way_vanish() {
        for (size, sparse) in [(6, false), (6, true), (60, false), (60, true)] {
            for eigenvalues in [&[-0.5][..], &[-0.5, -2.0, 1.3], &[-3.0, 0.8], &[-0.2, -0.5, -1.0, -4.0]] {
                let [b, other] = pair(size, eigenvalues, sparse);
                let negative = eigenvalues.iter().filter(|μ| **μ < 0.0);
                let mut expected: Vec<f64> = negative.map(|μ| -μ / (1.0 - μ)).collect();
                expected.sort_by(f64::total_cmp);
                for certain in [true, false] {
                    let found = b.singular_since(&other, certain);
                    assert_eq!(found.len(), expected.len(), "{size} {sparse} {certain} {eigenvalues:?}: {found:?}");
                    found.iter().zip(&expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-8, "{found:?}"));
                }
                assert!(b.may_differ_in_sign(&other));
            }
            for eigenvalues in [&[0.5][..], &[0.3, 2.0, 5.0]] {
                let [b, other] = pair(size, eigenvalues, sparse);
                assert!(!b.may_differ_in_sign(&other) && b.singular_since(&other, true).is_empty());
            }
        }
    }

    #[test]
    fn the_eigenvalue_that_is_largest_tells_where_a_matrix_becomes_singular_and_how_nearly_it_is() {
        for (size, sparse) in [(6, false), (6, true), (60, true)] {
            for largest in [50.0, -50.0, 300.0, 5e3, -5e3] {
                let [b, other] = pair(size, &[0.4, largest, 3.0], sparse);
                let share = b.nearest_singular(&other).unwrap();
                assert!((share / (largest / (largest - 1.0)) - 1.0).abs() < 1e-9, "{largest}: {share}");
                let size = f64::abs(largest);
                let found = [GROWN, GROWN_NEAR].map(|grown| b.is_singular_beside(&other, grown));
                assert_eq!(found, [size > GROWN, size > GROWN_NEAR], "{largest}");
            }
        }
    }

    /// The symmetric part of a matrix, by columns, beside a quarter.
    #[test]
    fn a_matrix_is_positive_if_the_eigenvalues_of_its_symmetric_part_exceed_a_quarter() {
        for (least, expected) in [(0.26, true), (0.24, false), (-1.0, false)] {
            assert_eq!(is_positive(&[vec![least, 0.1]]), expected);
            for angle in [0.3_f64, 1.1, 2.5] {
                let (sin, cos) = angle.sin_cos();
                let entry = |a: f64, b: f64| a * b;
                let (p, q, r) = (
                    least * entry(cos, cos) + 2.0 * entry(sin, sin),
                    (least - 2.0) * entry(sin, cos),
                    least * entry(sin, sin) + 2.0 * entry(cos, cos),
                );
                // With a part that is skew.
                assert_eq!(is_positive(&[vec![p, q + 0.7], vec![q - 0.7, r, 0.0]]), expected, "{least} {angle}");
            }
        }
    }
}

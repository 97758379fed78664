//! The directions in which a Jacobian leaves a point nearly free to move.

use nlmodes_linalg::{Mat, symmetric_eigen};

use crate::pencil::orthonormal;
use crate::signs::Signs;
use crate::vectors::dot;
use crate::{LinearSolver, Linearization};

/// Singular value over the largest one, or over one where that is less, below which a direction counts as nearly free.
pub(crate) const NEARLY_FREE: f64 = 1e-3;

/// Singular vectors of `J`, n × (n + 1), that belong to its smallest singular values, each row over the size of its
/// equation.
pub(crate) struct SingularDirections {
    /// The right singular vector of the value that is zero: the tangent, where there is one.
    pub tangent: Vec<f64>,
    /// The left ones of the values that are nearly zero beside it, ascending; that of the smallest is never missing. As
    /// combinations of the equations as they are.
    pub left: Vec<Vec<f64>>,
    /// The smallest singular value, beside the one that is zero, over the largest, or over one where that is less.
    pub ratio: f64,
    /// Orthonormal vectors that span the kernel: the tangent and the right singular vectors of the values that are
    /// nearly zero.
    pub right: Vec<Vec<f64>>,
}

impl SingularDirections {
    pub fn of(linearization: &Linearization, solver: &dyn LinearSolver) -> Option<Self> {
        if solver.is_sparse() {
            Self::by_inverse(linearization, solver.cloned())
        } else {
            Self::by_squares(linearization)
        }
    }

    /// All singular values, from the eigenvalues of `JᵀJ` and `J Jᵀ`.
    fn by_squares(linearization: &Linearization) -> Option<Self> {
        let Linearization { jacobian, sizes, .. } = linearization;
        let jacobian = Mat::from_fn(jacobian.nrows(), jacobian.ncols(), |i, j| jacobian[(i, j)] / sizes[i]);
        let (_, vectors) = symmetric_eigen(&(jacobian.transpose() * &jacobian)).ok()?;
        let (squares, left) = symmetric_eigen(&(&jacobian * jacobian.transpose())).ok()?;
        let largest = squares.last()?.max(1.0);
        let ratio = |square: &f64| (square.max(0.0) / largest).sqrt();
        let free = squares.iter().take_while(|s| ratio(s) < NEARLY_FREE).count();
        let left = (0..free.max(1)).map(|k| unit(left.col(k).iter().zip(sizes).map(|(u, size)| u * size))).collect();
        let right: Vec<Vec<f64>> = (0..=free).map(|k| unit(vectors.col(k).iter().copied())).collect();
        Some(Self { tangent: right.first()?.clone(), right, left, ratio: ratio(squares.first()?) })
    }
}

/// Singular values that are looked for where the Jacobian is sparse, and steps of inverse iteration.
const SMALLEST: usize = 8;
const STEPS: usize = 12;

/// Singular value, over the largest one of these, below which a direction may be nearly free: those of a fine mesh are
/// small without.
const APART: f64 = 0.05;

impl SingularDirections {
    /// The smallest singular values, by inverse iteration: with the tangent `t` as its last row, `B = [J; tᵀ]` has the
    /// singular values of `J` and one more, and `(B Bᵀ)⁻¹ = B⁻ᵀ B⁻¹` their squares' inverses.
    fn by_inverse(linearization: &Linearization, mut solver: Box<dyn LinearSolver>) -> Option<Self> {
        let n = linearization.residual.len();
        let sizes = &linearization.sizes;
        let mut at = linearization.clone();
        at.scale_entries(|i, _| 1.0 / sizes[i]);
        let mut signs = Signs::default();
        let mut draw = || (0..=n).map(|_| signs.draw_between()).collect::<Vec<f64>>();
        let tangent = null_vector(&at, &mut *solver, &draw())?;
        factor_nearly(&at, &mut *solver, &tangent)?;
        let border: Vec<f64> = (0..=n).map(|i| if i == n { 1.0 } else { 0.0 }).collect();
        let mut basis = vec![border];
        while basis.len() <= SMALLEST.min(n) {
            basis.push(orthonormal(draw(), &basis)?);
        }
        let (mut values, mut left) = (Vec::new(), basis.split_off(1));
        for _ in 0..STEPS {
            let mut next = basis.clone();
            for vector in left {
                // What is nearly free outgrows the rest: it is taken out before too.
                let vector = orthonormal(vector, &next).or_else(|| orthonormal(draw(), &next))?;
                let mut image = vector.clone();
                solver.solve_in_place(&mut image);
                solver.solve_transposed_in_place(&mut image);
                next.push(orthonormal(image, &next).unwrap_or(vector));
            }
            (values, left) = rotated(&at, next.split_off(1))?;
        }
        let largest = largest_singular_value(&at, draw()).max(1.0);
        let smallest = *values.first()?;
        let apart = if values.len() < n { APART * values.last()? } else { f64::INFINITY };
        let below = apart.min(NEARLY_FREE * largest);
        let free = values.iter().take_while(|value| **value < below).count();
        let mut right = vec![tangent.clone()];
        for u in left.iter().take(free) {
            // B v = σ u .
            let mut image = u.clone();
            solver.solve_in_place(&mut image);
            right.extend(orthonormal(image, &right));
        }
        let left = left.iter().take(free.max(1));
        let left = left.map(|u| unit(u.iter().zip(sizes).map(|(u, size)| u * size))).collect();
        Some(Self { tangent, left, ratio: smallest / largest, right })
    }
}

/// Factors `[J; rowᵀ]`, or where that is singular, with its last digits changed.
fn factor_nearly(at: &Linearization, solver: &mut dyn LinearSolver, row: &[f64]) -> Option<()> {
    if solver.factor(at, row).is_ok() {
        return Some(());
    }
    let mut near = at.clone();
    near.scale_entries(|i, j| if i == j { 1.0 + 16.0 * f64::EPSILON } else { 1.0 });
    solver.factor(&near, row).ok()
}

/// A unit vector that `J` takes to zero.
fn null_vector(at: &Linearization, solver: &mut dyn LinearSolver, start: &[f64]) -> Option<Vec<f64>> {
    let mut row = unit(start.iter().copied());
    for _ in 0..2 {
        factor_nearly(at, solver, &row)?;
        row.fill(0.0);
        *row.last_mut()? = 1.0;
        solver.solve_in_place(&mut row);
        row = unit(row.into_iter());
    }
    row.iter().all(|t| t.is_finite()).then_some(row)
}

/// Singular values, ascending, and left singular vectors of `J` in the span of orthonormal vectors, whose last entry is
/// zero.
fn rotated(at: &Linearization, basis: Vec<Vec<f64>>) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
    let images: Vec<Vec<f64>> = basis.iter().map(|u| transposed_times(at, u)).collect();
    let k = basis.len();
    let (_, vectors) = symmetric_eigen(&Mat::from_fn(k, k, |i, j| dot(&images[i], &images[j]))).ok()?;
    let combined = |c: usize| {
        let mut sum = vec![0.0; at.residual.len() + 1];
        basis.iter().enumerate().for_each(|(r, u)| {
            sum.iter_mut().zip(u).for_each(|(sum, u)| *sum += vectors[(r, c)] * u);
        });
        sum
    };
    let left: Vec<Vec<f64>> = (0..k).map(combined).collect();
    // The square of a small value is lost beside that of a large one.
    let value = |u: &Vec<f64>| {
        let image = transposed_times(at, u);
        dot(&image, &image).sqrt()
    };
    Some((left.iter().map(value).collect(), left))
}

/// `Jᵀ u`, of which the last entry belongs to the border.
fn transposed_times(at: &Linearization, u: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; u.len()];
    at.each(|i, j, value| product[j] += value * u[i]);
    product
}

/// The largest singular value, by the power method.
fn largest_singular_value(at: &Linearization, start: Vec<f64>) -> f64 {
    let mut v = unit(start.into_iter());
    let mut size = 0.0;
    for _ in 0..STEPS {
        let mut u = at.times(&v);
        u.push(0.0);
        v = transposed_times(at, &u);
        size = dot(&v, &v).sqrt();
        if size == 0.0 {
            break;
        }
        v.iter_mut().for_each(|v| *v /= size);
    }
    size.sqrt()
}

fn unit(vector: impl Iterator<Item = f64>) -> Vec<f64> {
    let vector: Vec<f64> = vector.collect();
    let length = vector.iter().map(|v| v * v).sum::<f64>().sqrt();
    vector.iter().map(|v| v / length).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DenseSolver, SparseSolver};

    /// The reflection of a unit vector across a plane, drawn by lot.
    fn reflected(number: usize, mut v: Vec<f64>) -> Vec<f64> {
        let normal = unit((0..v.len()).map(|i| (1.1 + 0.7 * number as f64 + 2.3 * i as f64).sin()));
        let along = 2.0 * dot(&normal, &v);
        v.iter_mut().zip(normal).for_each(|(v, n)| *v -= along * n);
        v
    }

    /// The vector number k of an orthonormal basis.
    fn basis(k: usize, n: usize, number: usize) -> Vec<f64> {
        let axis = (0..n).map(|i| if i == k { 1.0 } else { 0.0 }).collect();
        reflected(number + 1, reflected(number, axis))
    }

    /// `J = Σ_k σ_k u_k v_kᵀ` of two unrelated bases.
    #[test]
    fn what_is_nearly_free_is_known_of_dense_and_of_sparse_matrices() {
        let n = 12;
        for (free, small) in [(1, vec![0.02]), (1, vec![1e-6]), (2, vec![1e-7, 1e-5]), (3, vec![1e-6, 2e-5, 1e-4])] {
            let more = (small.len()..n).map(|k| 0.3 + 0.2 * k as f64);
            let values: Vec<f64> = small.iter().copied().chain(more).collect();
            let (u, v) = (|k| basis(k, n, 0), |k| basis(k, n + 1, 5));
            let mut dense = Linearization::new(n);
            let mut sparse = Linearization::sparse(n);
            for (i, j) in (0..n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
                let entry = (0..n).map(|k| values[k] * u(k)[i] * v(k)[j]).sum();
                dense.jacobian[(i, j)] = entry;
                sparse.entries.push((i, j, entry));
            }
            let found = [
                SingularDirections::of(&dense, &DenseSolver::default()).unwrap(),
                SingularDirections::of(&sparse, &SparseSolver::default()).unwrap(),
            ];
            // The squares of singular values are rounded by 1e-16 of the largest one, which is an estimate where the
            // matrix is sparse.
            for (found, rounding, estimate) in [(&found[0], 2e-7, 1e-10), (&found[1], 1e-9, 0.05)] {
                let ratio = values[0] / values[n - 1];
                let off = (found.ratio - ratio).abs();
                assert!(off < rounding + estimate * ratio, "{small:?}: {:e} of {ratio:e}", found.ratio);
                // What is nearly free is not distinguished from the tangent by squares.
                let free_too = if estimate < 1e-3 { free } else { 0 };
                let within: f64 = (0..free_too).chain([n]).map(|k| dot(&found.tangent, &v(k)).powi(2)).sum();
                assert!((within - 1.0).abs() < 1e-12, "{small:?}: {within}");
                assert_eq!(found.left.len(), free, "{small:?}");
                for (k, left) in found.left.iter().enumerate() {
                    assert!((dot(left, &u(k)).abs() - 1.0).abs() < 1e-6, "{small:?}: {k}");
                }
            }
        }
    }

    /// Weighted differences around a ring and an unknown that occurs nowhere: `Σ r_i / a_i = 0` of the rows, weights
    /// that are powers of two, so that elimination ends with a pivot of zero.
    #[test]
    fn what_is_free_of_a_sparse_matrix_that_cannot_be_factored_is_known_too() {
        let n = 12;
        let weight = |i: usize| [1.0, 2.0, 0.5, 4.0, 1.0, 0.25, 2.0][i % 7];
        let mut ring = Linearization::sparse(n);
        for i in 0..n {
            ring.entries.extend([(i, i, weight(i)), (i, (i + 1) % n, -weight(i))]);
        }
        let found = SingularDirections::of(&ring, &SparseSolver::default()).unwrap();
        assert!(found.ratio < 1e-12, "{:e}", found.ratio);
        assert_eq!(found.left.len(), 1);
        let left = unit((0..n).map(|i| 1.0 / weight(i)));
        assert!((dot(&found.left[0], &left).abs() - 1.0).abs() < 1e-12, "{:?}", found.left[0]);
        // On the ring all move alike.
        assert!(found.tangent[..n].iter().all(|t| (t - found.tangent[0]).abs() < 1e-12), "{:?}", found.tangent);
    }
}

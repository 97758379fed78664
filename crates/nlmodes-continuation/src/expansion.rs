//! What an expansion about boundaries of smooth pieces is made of.

use nlmodes_linalg::{Mat, symmetric_eigen};

use crate::corrector::Corrector;
use crate::singular::SingularDirections;
use crate::vectors::dot;
use crate::{Boundary, Linearization};

/// Distance beyond the boundary at which it is looked what sets in there.
pub(crate) const DEPTH: f64 = 1e-6;

/// Powers of the depth with which that may grow: a contact force grows with 3/2.
pub(crate) const POWERS: std::ops::RangeInclusive<f64> = 1.2..=2.5;

/// What sets in, over the rounding of the equations, from which on it is known well enough.
pub(crate) const ABOVE_ROUNDING: f64 = 1e3;

/// Largest depth, over the length of a step, for which a bend is tight.
pub(crate) const SHALLOW: f64 = 0.3;

/// Distance from the predicted point, over the step, and cosine of the angle between the tangents up to which the
/// prediction is confirmed.
pub(crate) const CONFIRMED: (f64, f64) = (0.3, 0.9);

/// The unit vector of unknowns, parameter and k forces that the equations and k boundaries leave free, `[J, F; ∇gᵀ, 0]`
/// with these columns and rows, and the next smallest singular value of that. Each row is taken over the size of its
/// equation.
pub(crate) fn free_beyond(
    at: &Linearization,
    forces: &[&[f64]],
    slopes: &[&[f64]],
    corrector: &Corrector,
) -> Option<(Vec<f64>, f64)> {
    let (n, k) = (at.residual.len(), forces.len());
    if corrector.solver().is_sparse() {
        let mut beyond = Linearization::sparse(n + k);
        beyond.sizes[..n].copy_from_slice(&at.sizes);
        beyond.entries.extend_from_slice(&at.entries);
        for (c, (force, slope)) in forces.iter().zip(slopes).enumerate() {
            beyond.entries.extend(force.iter().enumerate().map(|(i, force)| (i, n + 1 + c, *force)));
            beyond.entries.extend(slope.iter().enumerate().map(|(j, slope)| (n + c, j, *slope)));
        }
        let free = SingularDirections::of(&beyond, corrector.solver())?;
        return Some((free.tangent, free.value));
    }
    let entry = |i: usize, j: usize| match (i < n, j <= n) {
        (true, true) => at.jacobian[(i, j)] / at.sizes[i],
        (true, false) => forces[j - n - 1][i] / at.sizes[i],
        (false, true) => slopes[i - n][j],
        (false, false) => 0.0,
    };
    let matrix = Mat::from_fn(n + k, n + 1 + k, entry);
    let (squares, vectors) = symmetric_eigen(&(matrix.transpose() * &matrix)).ok()?;
    let vector = (0..n + 1 + k).map(|j| vectors[(j, 0)]).collect();
    Some((vector, squares.get(1)?.max(0.0).sqrt()))
}

/// The gradient of the function of a boundary, by central differences.
pub(crate) fn gradient(boundary: &Boundary, z: &[f64]) -> Option<Vec<f64>> {
    const STEP: f64 = 1e-5;
    let mut at = z.to_vec();
    let slope: Vec<f64> = (0..z.len())
        .map(|j| {
            let mut value = |s: f64| {
                at[j] = z[j] + s;
                let value = boundary.value(&at);
                at[j] = z[j];
                value
            };
            (value(STEP) - value(-STEP)) / (2.0 * STEP)
        })
        .collect();
    let size = dot(&slope, &slope);
    (size.is_finite() && size > 0.0).then_some(slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signs::Signs;
    use crate::{DenseSolver, SparseSolver};

    #[test]
    fn the_gradient_of_a_boundary_is_that_of_its_function() {
        let boundary = Boundary::new(|z| z[0] * z[1] - 3.0 * z[2] * z[2]);
        let found = gradient(&boundary, &[0.4, -1.2, 0.7]).unwrap();
        assert!(found.iter().zip([-1.2, 0.4, -4.2]).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
        assert_eq!(gradient(&Boundary::new(|_| 1.0), &[0.4]), None, "a constant has none");
    }

    /// The vector that equations and boundaries leave free, by whatever solver and in whatever units the equations are.
    #[test]
    fn what_equations_and_boundaries_leave_free_is_left_free() {
        let (n, k) = (5, 2);
        let mut values = Vec::new();
        for (sparse, unit) in [(false, 1.0), (true, 1.0), (false, 1e6), (true, 1e6)] {
            let mut signs = Signs::default();
            let solver: Box<dyn crate::LinearSolver> =
                if sparse { Box::<SparseSolver>::default() } else { Box::<DenseSolver>::default() };
            let corrector = Corrector::with_solver(solver.clone(), n, 1e-11, 8);
            let mut at = Linearization::for_solver(&*solver, n);
            for (i, j) in (0..n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
                // One equation in another unit.
                let value = signs.draw_between() * if i == 2 { unit } else { 1.0 };
                if sparse { at.entries.push((i, j, value)) } else { at.jacobian[(i, j)] = value }
            }
            at.sizes[2] = unit;
            let mut vectors = |length: usize| -> Vec<Vec<f64>> {
                (0..k).map(|_| (0..length).map(|_| signs.draw_between()).collect()).collect()
            };
            let (mut forces, slopes) = (vectors(n), vectors(n + 1));
            forces.iter_mut().for_each(|force| force[2] *= unit);
            let [f, g] = [&forces, &slopes].map(|all| all.iter().map(Vec::as_slice).collect::<Vec<&[f64]>>());
            let (free, next) = free_beyond(&at, &f, &g, &corrector).unwrap();
            assert!((dot(&free, &free) - 1.0).abs() < 1e-9, "a unit vector");
            let (z, of_forces) = free.split_at(n + 1);
            for (i, along) in at.times(z).into_iter().enumerate() {
                let pushed: f64 = (0..k).map(|c| forces[c][i] * of_forces[c]).sum();
                assert!((along + pushed).abs() < 1e-7 * at.sizes[i], "{sparse} {i}: {:e}", along + pushed);
            }
            slopes.iter().for_each(|slope| assert!(dot(slope, z).abs() < 1e-7, "{sparse}: {:e}", dot(slope, z)));
            values.push(next);
        }
        assert!(values[0] > 1e-3 && values.iter().all(|v| (v / values[0] - 1.0).abs() < 0.05), "{values:?}");
    }
}

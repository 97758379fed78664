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

/// Distance from the predicted point, over the step, and cosine of the angle between the tangents up to which the prediction is confirmed.
pub(crate) const CONFIRMED: (f64, f64) = (0.3, 0.9);

/// The unit vector of unknowns, parameter and k forces that the equations and k boundaries leave free, `[J, F; ∇gᵀ, 0]` with these columns and
/// rows, and the next smallest singular value of that. Each row is taken over the size of its equation.
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

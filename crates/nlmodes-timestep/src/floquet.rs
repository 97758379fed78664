use nlmodes_linalg::{Mat, eigenvalues};
use nlmodes_modal::Stability;
use num_complex::Complex64;

use crate::phase::dot;
use crate::{ContactDynamics, PeriodicMotion, TimestepError, Trajectory};

/// Distance from the unit circle up to which a multiplier is taken to be on it.
///
/// Rounding errors are some 1e-12 for a simple multiplier, and the square root of that where two of them meet.
pub const UNIT_CIRCLE: f64 = 1e-6;

/// Floquet multipliers of a periodic motion.
///
/// A conservative autonomous system has the multiplier +1 twice: a shift along the motion is unchanged after a period,
/// and a change of energy leads to the neighbouring motion of the family, with another period. This pair is not
/// semisimple, and rounding would split it by the square root of 1e-16. It is therefore removed exactly: with `f` the
/// direction of the motion and `e` the gradient of the energy, `e · f = 0`, the monodromy matrix is block triangular in
/// `f`, the complement of both, and `e`; the multipliers returned are those of the middle block.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Floquet {
    /// The 2m − 2 multipliers other than the double +1, in order of decreasing magnitude.
    pub multipliers: Vec<Complex64>,
    /// `‖(M − I) f‖ / ‖f‖` in the energy norm: accuracy of the return along the motion; rounding for a periodic one.
    pub trivial_defect: f64,
}

impl Floquet {
    /// From the monodromy matrix of one period.
    ///
    /// # Errors
    /// Errors of [`ContactDynamics::propagate`]; [`TimestepError::Linalg`] if the eigenvalues do not converge;
    /// [`TimestepError::NotPositive`] for a structure at rest.
    pub fn new(dynamics: &mut ContactDynamics, motion: &PeriodicMotion) -> Result<Self, TimestepError> {
        let scale: Vec<f64> = dynamics.omega().iter().map(|ω| ω.max(motion.omega)).collect();
        let monodromy = scaled_monodromy(&motion.trajectory, &scale);
        let flow = flow(dynamics, motion, &scale)?;
        let length = dot(&flow, &flow).sqrt();
        if length == 0.0 {
            return Err(TimestepError::NotPositive { what: "speed of the motion", value: 0.0 });
        }
        let flow: Vec<f64> = flow.iter().map(|f| f / length).collect();
        let returned: Vec<f64> =
            (0..flow.len()).map(|i| (0..flow.len()).map(|j| monodromy[(i, j)] * flow[j]).sum()).collect();
        let defect = returned.iter().zip(&flow).map(|(r, f)| (r - f).powi(2)).sum::<f64>().sqrt();
        let gradient = conjugate(&flow, &scale);
        let block = complement_block(&monodromy, &[flow, gradient]);
        let mut multipliers = eigenvalues(&block).map_err(TimestepError::during("Floquet multipliers"))?;
        multipliers.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        Ok(Self { multipliers, trivial_defect: defect })
    }

    /// Largest magnitude of a multiplier; 1 if there is none other than the double +1.
    pub fn largest(&self) -> f64 {
        self.multipliers.first().map_or(1.0, |μ| μ.norm())
    }

    /// Whether all multipliers are on the unit circle to within [`UNIT_CIRCLE`]: no small disturbance grows
    /// exponentially.
    pub fn is_stable(&self) -> bool {
        self.largest() <= 1.0 + UNIT_CIRCLE
    }

    /// The same with the largest multiplier.
    pub fn stability(&self) -> Stability {
        let largest = self.multipliers.first().map_or([1.0, 0.0], |μ| [μ.re, μ.im.abs()]);
        Stability::conservative(self.is_stable(), largest)
    }
}

/// Monodromy matrix, 2m × 2m, of the trajectory for the coordinates `scale_k z_k` and `v_k`.
fn scaled_monodromy(trajectory: &Trajectory, scale: &[f64]) -> Mat<f64> {
    let m = scale.len();
    let z = Mat::from_fn(m, 2 * m, |i, j| if i == j { 1.0 / scale[i] } else { 0.0 });
    let v = Mat::from_fn(m, 2 * m, |i, j| if i + m == j { 1.0 } else { 0.0 });
    let (z, v) = trajectory.transition(z, v, |_, _, _| {});
    Mat::from_fn(2 * m, 2 * m, |i, j| if i < m { scale[i] * z[(i, j)] } else { v[(i - m, j)] })
}

/// `(scale ż, v̇)` at the beginning.
fn flow(dynamics: &mut ContactDynamics, motion: &PeriodicMotion, scale: &[f64]) -> Result<Vec<f64>, TimestepError> {
    let acceleration = dynamics.acceleration(&motion.state)?;
    let first = motion.state.v.iter().zip(scale).map(|(v, s)| s * v);
    Ok(first.chain(acceleration).collect())
}

/// Gradient of the energy, which is the rotated flow: `∂E/∂v = v = ż`, `∂E/∂z = −v̇`, each divided by its scale.
fn conjugate(flow: &[f64], scale: &[f64]) -> Vec<f64> {
    let m = scale.len();
    let gradient = (0..2 * m).map(|i| if i < m { -flow[m + i] / scale[i] } else { flow[i - m] / scale[i - m] });
    let gradient: Vec<f64> = gradient.collect();
    let length = dot(&gradient, &gradient).sqrt();
    gradient.iter().map(|g| g / length).collect()
}

/// `Qᵀ M Q` with an orthonormal basis Q of the complement of two orthonormal vectors, by two reflections.
fn complement_block(matrix: &Mat<f64>, vectors: &[Vec<f64>; 2]) -> Mat<f64> {
    let n = matrix.nrows();
    let mut turned = matrix.clone();
    let mut rest = vectors.to_vec();
    for first in 0..2 {
        // The reflection that takes the vector to ±e_first does not change the entries before it.
        let mut normal = rest[first].clone();
        normal[..first].fill(0.0);
        let length = dot(&normal, &normal).sqrt();
        normal[first] += length.copysign(normal[first]);
        let factor = 2.0 / dot(&normal, &normal);
        for j in 0..n {
            let overlap = factor * (0..n).map(|i| normal[i] * turned[(i, j)]).sum::<f64>();
            (0..n).for_each(|i| turned[(i, j)] -= overlap * normal[i]);
        }
        for i in 0..n {
            let overlap = factor * (0..n).map(|j| normal[j] * turned[(i, j)]).sum::<f64>();
            (0..n).for_each(|j| turned[(i, j)] -= overlap * normal[j]);
        }
        for vector in &mut rest {
            let overlap = factor * dot(&normal, vector);
            vector.iter_mut().zip(&normal).for_each(|(v, n)| *v -= overlap * n);
        }
    }
    Mat::from_fn(n - 2, n - 2, |i, j| turned[(i + 2, j + 2)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_of_one_mode_has_no_multipliers_beside_the_pair_and_is_stable() {
        let alone = Floquet { multipliers: Vec::new(), trivial_defect: 0.0 };
        assert!(alone.largest() == 1.0 && alone.is_stable());
        let with = |μ: Complex64| Floquet { multipliers: vec![μ, μ.inv()], trivial_defect: 0.0 };
        assert!(with(Complex64::cis(0.3)).is_stable() && with(Complex64::new(1.0 + 1e-7, 0.0)).is_stable());
        assert!(!with(Complex64::new(-1.0 - 1e-5, 0.0)).is_stable());
        assert!((with(Complex64::new(0.0, -1.5)).largest() - 1.5).abs() < 1e-15);
    }

    #[test]
    fn the_block_of_the_complement_has_the_other_eigenvalues() {
        // Eigenvectors of a symmetric matrix: without two of them the other two remain.
        let q = [[1.0, 1.0, 1.0, 1.0], [1.0, -1.0, 1.0, -1.0], [1.0, 1.0, -1.0, -1.0], [1.0, -1.0, -1.0, 1.0]]
            .map(|v| v.map(|x| 0.5 * x));
        let eigenvalue = [1.0, 5.0, 1.0, -0.25];
        let matrix = Mat::from_fn(4, 4, |i, j| (0..4).map(|k| eigenvalue[k] * q[k][i] * q[k][j]).sum());
        for out in [[0, 2], [1, 3], [3, 0]] {
            let block = complement_block(&matrix, &out.map(|k| q[k].to_vec()));
            let mut found: Vec<f64> = eigenvalues(&block).unwrap().iter().map(|μ| μ.re).collect();
            let mut left: Vec<f64> = (0..4).filter(|k| !out.contains(k)).map(|k| eigenvalue[k]).collect();
            found.sort_by(f64::total_cmp);
            left.sort_by(f64::total_cmp);
            assert!(found.iter().zip(&left).all(|(a, b)| (a - b).abs() < 1e-14), "{out:?}: {found:?}, {left:?}");
        }
    }
}

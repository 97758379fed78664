//! The arms of the reduced equations where what sets in is stiff.

use nlmodes_linalg::{Mat, symmetric_eigen};

use super::onset::dual;
use super::reduced::{RADIUS, Reduced};
use crate::expansion::SHALLOW;
use crate::vectors::{along, dot};

/// Factor or distance from the boundary, over the length of the direction, below which it is not clear which side is
/// taken, and singular value below which it is not clear which direction.
const CLEAR: f64 = 1e-6;

impl Reduced {
    /// The coordinates of all arms at the distance one; `None` where depths are not small beside that or it is not
    /// clear which sides the arms take.
    ///
    /// Where the depths are small beside the distance, the directions `t` of the arms and what sets in, `m`, solve a
    /// complementarity problem,
    ///
    /// ```text
    /// J t + Σ_j m_j F_j = 0 ,   0 ≤ m_j ⊥ ∇g_j · t ≥ 0
    /// ```
    ///
    /// which for each set of boundaries that are passed has at most one solution, or two of opposite senses where none
    /// is passed.
    pub(super) fn stiff_arms(&self) -> Option<Vec<Vec<f64>>> {
        let k = self.slopes.len();
        let inward = dual(&self.slopes)?;
        let mut arms = Vec::new();
        for set in 0..1_usize << k {
            let is_passed = |j: usize| set >> j & 1 == 1;
            let direction = self.direction_of(is_passed)?;
            let kept = |j: usize| {
                if is_passed(j) { dot(&self.factor(j), &direction) } else { dot(&self.slopes[j], &direction) }
            };
            let kept: Vec<f64> = (0..k).map(kept).collect();
            if kept.iter().any(|kept| kept.abs() < CLEAR) {
                return None;
            }
            for sign in [1.0, -1.0].into_iter().filter(|sign| kept.iter().all(|kept| sign * kept > 0.0)) {
                let straight: Vec<f64> = direction.iter().map(|d| sign * d).collect();
                let passed = (0..k).filter(|j| is_passed(*j));
                let depths: Vec<(usize, f64)> = passed.map(|j| (j, self.depth(j, sign * kept[j]))).collect();
                if depths.iter().any(|(_, depth)| *depth > SHALLOW) {
                    return None;
                }
                arms.push(depths.iter().fold(straight, |y, (j, depth)| along(&y, -depth, &inward[*j])));
            }
        }
        Some(arms)
    }

    /// The unit vector along the boundaries that are passed, with nothing of what sets in beyond the others.
    fn direction_of(&self, is_passed: impl Fn(usize) -> bool) -> Option<Vec<f64>> {
        let k = self.slopes.len();
        let row = |j: usize| if is_passed(j) { self.slopes[j].clone() } else { self.factor(j) };
        let rows: Vec<Vec<f64>> = (0..k).map(row).collect();
        let lengths: Vec<f64> = rows.iter().map(|row| dot(row, row).sqrt()).collect();
        let matrix = Mat::from_fn(k, k + 1, |i, j| rows[i][j] / lengths[i]);
        let (squares, vectors) = symmetric_eigen(&(matrix.transpose() * &matrix)).ok()?;
        let is_clear = squares.get(1)?.max(0.0).sqrt() > CLEAR;
        is_clear.then(|| (0..=k).map(|j| vectors[(j, 0)]).collect())
    }

    /// How deep the boundary j is passed at the distance one with this factor.
    fn depth(&self, j: usize, factor: f64) -> f64 {
        let (size, power) = self.onsets[j];
        (factor * RADIUS / size).powf(1.0 / power) / RADIUS
    }
}

//! The equations around a point on several boundaries, reduced to what sets in beyond these.

use std::convert::Infallible;

use super::onset::Onset;
use crate::corrector::Corrector;
use crate::expansion::{DEPTH, free_beyond};
use crate::vectors::{along, dot};
use crate::{Linearization, ParametricSystem};

/// Radius at which arms of the reduced equations are looked for.
pub(super) const RADIUS: f64 = 1e-3;

/// Length that is left of a direction without those before, over its own, below which it is one of them.
const DEPENDENT: f64 = 1e-10;

/// `J (z − z₀) + Σ_j F_j (d_j/d₀)^k_j = 0` with `d_j = (−∇g_j · (z − z₀))₊`, where `z − z₀` is a combination of the k + 1 directions for which `J` times
/// them is one of the `F_j`: what is left are k equations, one for each factor.
///
/// Lengths are such that the distance at which arms are looked for is [`RADIUS`].
pub(super) struct Reduced {
    /// The directions, orthonormal, k + 1.
    directions: Vec<Vec<f64>>,
    /// The factors that belong to each.
    factors: Vec<Vec<f64>>,
    /// `∇g_j` times each.
    pub slopes: Vec<Vec<f64>>,
    /// What sets in at the depth one, and its power.
    pub onsets: Vec<(f64, f64)>,
}

impl Reduced {
    /// For arms at the distance `distance`; `at` is the Jacobian where nothing has set in. None where a direction that belongs to nothing that sets in is
    /// nearly free at that distance: something else may happen there.
    pub fn new(
        at: &Linearization,
        tangent: &[f64],
        onsets: &[Onset],
        distance: f64,
        corrector: &Corrector,
    ) -> Option<Self> {
        let (n, k) = (at.residual.len(), onsets.len());
        let mut solver = corrector.solver().cloned();
        solver.factor(at, tangent).ok()?;
        let solved = |mut right: Vec<f64>| {
            solver.solve_in_place(&mut right);
            right
        };
        let along_curve = solved((0..=n).map(|i| if i == n { 1.0 } else { 0.0 }).collect());
        let mut directions: Vec<Vec<f64>> = Vec::new();
        let mut factors: Vec<Vec<f64>> = Vec::new();
        let all = onsets.iter().map(|onset| solved(onset.force.iter().map(|f| -f).chain([0.0]).collect()));
        for (number, mut direction) in std::iter::once(along_curve).chain(all).enumerate() {
            let mut factor: Vec<f64> = (0..k).map(|j| if j + 1 == number { 1.0 } else { 0.0 }).collect();
            let before = dot(&direction, &direction).sqrt();
            // Twice is enough.
            for _ in 0..2 {
                for (known, of_known) in directions.iter().zip(&factors) {
                    let share = dot(known, &direction);
                    (direction, factor) = (along(&direction, -share, known), along(&factor, -share, of_known));
                }
            }
            let length = dot(&direction, &direction).sqrt();
            if length.is_nan() || length <= DEPENDENT * before {
                return None;
            }
            directions.push(direction.iter().map(|d| d / length).collect());
            factors.push(factor.iter().map(|f| f / length).collect());
        }
        let forces: Vec<&[f64]> = onsets.iter().map(|onset| onset.force.as_slice()).collect();
        let fixed: Vec<&[f64]> = directions[1..].iter().map(Vec::as_slice).collect();
        let (_, rest) = free_beyond(at, &forces, &fixed, corrector)?;
        if rest < distance {
            return None;
        }
        let slopes = onsets.iter().map(|onset| directions.iter().map(|d| dot(&onset.slope, d)).collect()).collect();
        let unit = distance / RADIUS;
        let onsets = onsets.iter().map(|o| (o.length * (unit / DEPTH).powf(o.power) / unit, o.power)).collect();
        Some(Self { directions, factors, slopes, onsets })
    }

    /// What the factor j is per length along each direction.
    pub fn factor(&self, j: usize) -> Vec<f64> {
        self.factors.iter().map(|factors| factors[j]).collect()
    }

    /// The coordinates of a direction.
    pub fn coordinates(&self, direction: &[f64]) -> Vec<f64> {
        self.directions.iter().map(|d| dot(d, direction)).collect()
    }

    /// The direction with these coordinates.
    pub fn direction(&self, coordinates: &[f64]) -> Vec<f64> {
        let zero = vec![0.0; self.directions[0].len()];
        self.directions.iter().zip(coordinates).fold(zero, |sum, (d, c)| along(&sum, *c, d))
    }
}

impl ParametricSystem for Reduced {
    type Error = Infallible;

    fn dim(&self) -> usize {
        self.onsets.len()
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        let y: Vec<f64> = x.iter().copied().chain([p]).collect();
        for (j, ((size, power), slope)) in self.onsets.iter().zip(&self.slopes).enumerate() {
            let depth = (-dot(slope, &y)).max(0.0);
            let factor = self.factor(j);
            out.residual[j] = size * depth.powf(*power) - dot(&factor, &y);
            let stiffness = size * power * depth.powf(power - 1.0);
            (0..y.len()).for_each(|i| out.jacobian[(j, i)] = -stiffness * slope[i] - factor[i]);
        }
        Ok(())
    }
}

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

/// `J (z − z₀) + Σ_j F_j (d_j/d₀)^k_j = 0` with `d_j = (−∇g_j · (z − z₀))₊`, where `z − z₀` is a combination of the k +
/// 1 directions for which `J` times them is one of the `F_j`: what is left are k equations, one for each factor.
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
    /// For arms at the distance `distance`; `at` is the Jacobian where nothing has set in. None where a direction that
    /// belongs to nothing that sets in is nearly free at that distance: something else may happen there.
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

#[cfg(test)]
mod tests {
    use super::super::on_small_sphere;
    use super::*;

    /// Two stops, `size_j max(v_j, 0)^1.5 = v_j + q_j p`, in coordinates that are turned.
    fn two_stops(sizes: [f64; 2], q: [f64; 2]) -> Reduced {
        // Rows: v₁, v₂ and p.
        let turned = [[0.6, 0.0, 0.8], [0.64, -0.6, -0.48], [0.48, 0.8, -0.36]];
        let in_turned = |row: [f64; 3]| (0..3).map(|c| (0..3).map(|r| row[r] * turned[r][c]).sum()).collect();
        let factor = |j: usize| -> Vec<f64> { in_turned([[1.0, 0.0, q[0]], [0.0, 1.0, q[1]]][j]) };
        let factors = (0..3).map(|i| vec![factor(0)[i], factor(1)[i]]).collect();
        let slopes = vec![in_turned([-1.0, 0.0, 0.0]), in_turned([0.0, -1.0, 0.0])];
        let directions = (0..3).map(|c| turned.iter().map(|row| row[c]).collect()).collect();
        Reduced { directions, factors, slopes, onsets: sizes.iter().map(|size| (*size, 1.5)).collect() }
    }

    fn residual(sizes: [f64; 2], q: [f64; 2], v: &[f64]) -> [f64; 2] {
        [0, 1].map(|j| sizes[j] * v[j].max(0.0).powf(1.5) - v[j] - q[j] * v[2])
    }

    #[test]
    fn the_reduced_equations_are_those_of_the_stops_and_their_derivatives_differences() {
        let (sizes, q) = ([80.0, 3.0], [0.8, 1.1]);
        let mut stops = two_stops(sizes, q);
        let mut at = |y: &[f64]| {
            let mut out = Linearization::new(2);
            stops.linearize(&y[..2], y[2], &mut out).unwrap();
            out
        };
        for y in [[3e-3, 1e-3, 4e-3], [-2e-3, 5e-3, 1e-3], [5e-3, -4e-3, -1e-3], [-1e-3, -2e-3, -3e-3]] {
            let out = at(&y);
            let v = two_stops(sizes, q).direction(&y);
            let expected = residual(sizes, q, &v);
            assert!(out.residual.iter().zip(expected).all(|(r, e)| (r - e).abs() < 1e-15), "{y:?}");
            for j in 0..3 {
                let mut beside = |s: f64| {
                    let mut y = y;
                    y[j] += s;
                    at(&y).residual
                };
                let (up, down) = (beside(1e-7), beside(-1e-7));
                for i in 0..2 {
                    let slope = (up[i] - down[i]) / 2e-7;
                    assert!((out.jacobian[(i, j)] - slope).abs() < 1e-5, "{y:?} ({i}, {j}): {slope}");
                }
            }
        }
    }

    /// As soft as that the depths are not small beside the distance: each stop is open, `v = −q p`, or closed, at a
    /// root that halving finds.
    #[test]
    fn all_arms_of_stops_that_are_not_stiff_are_found() {
        for (sizes, q) in [([100.0, 100.0], [0.8, 1.1]), ([150.0, 300.0], [1.0, 0.7])] {
            let mut stops = two_stops(sizes, q);
            assert!(stops.stiff_arms().is_none());
            let v_of = |j: usize, closed: bool, p: f64| {
                if !closed {
                    return -q[j] * p;
                }
                let (mut low, mut high) = (1.0 / (sizes[j] * sizes[j]), 1.0);
                for _ in 0..200 {
                    let middle = 0.5 * (low + high);
                    let missing = sizes[j] * f64::powf(middle, 1.5) - middle - q[j] * p;
                    if missing < 0.0 { low = middle } else { high = middle }
                }
                low
            };
            let expected: Vec<Vec<f64>> = (0..4)
                .map(|set| {
                    let at = |p: f64| [v_of(0, set & 1 == 1, p), v_of(1, set & 2 == 2, p), p];
                    let (mut low, mut high) = (0.0, RADIUS);
                    for _ in 0..200 {
                        let middle = 0.5 * (low + high);
                        if dot(&at(middle), &at(middle)) < RADIUS * RADIUS { low = middle } else { high = middle }
                    }
                    at(low).iter().map(|v| v / RADIUS).collect()
                })
                .collect();
            for back in &expected {
                let back = stops.coordinates(back);
                let found = on_small_sphere(&mut stops, &back, 1e-11).unwrap();
                assert_eq!(found.len(), 4, "{sizes:?}");
                assert!(found[0].iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-6), "{sizes:?}");
                for arm in &expected {
                    let arm = stops.coordinates(arm);
                    let nearest = found.iter().map(|y| crate::vectors::distance(y, &arm)).fold(f64::INFINITY, f64::min);
                    assert!(nearest < 1e-6, "{sizes:?}: {arm:?} is {nearest:e} off {found:?}");
                }
            }
        }
    }
}

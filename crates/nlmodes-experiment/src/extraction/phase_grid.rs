//! Sums over many samples at uneven phases: each sample is spread over a few points of an even grid, of which a fast
//! Fourier transform gives all harmonics at once.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};
use nlmodes_modal::HarmonicBasis;
use num_complex::Complex64;

use crate::extraction::ExtractionError;

/// Points of the grid that a sample is spread over: each adds a digit, thirteen of them.
const WIDTH: usize = 14;
/// Points of the grid for each one that the harmonics need.
const FINER: usize = 2;
/// Decay of the kernel with which its width gives most digits, for a grid that is twice as fine.
const DECAY: f64 = 2.3 * WIDTH as f64;
/// Terms of the polynomials by which the kernel is evaluated.
const TERMS: usize = 20;
/// Nodes of the integrals of the kernel.
const NODES: usize = 400;

/// A kernel `φ(z) = e^{β(√(1−z²)−1)}` over `WIDTH` points of a grid of phases, and what it does to each harmonic.
///
/// Spreading and reading are adjoint to each other:
///
/// ```text
/// Σ_j x_j e^{inψ_j} = Σ_m g_m e^{inτ_m} / φ̂_n ,   g_m = Σ_j x_j φ(τ_m − ψ_j)
/// ```
///
/// to `1e-12` of `Σ|x_j|`.
pub struct PhaseGrid {
    points: usize,
    basis: HarmonicBasis,
    /// `φ̂_n` of each harmonic.
    transform: Vec<f64>,
    /// Coefficients of the polynomials, a row a power, a column a point.
    polynomials: [[f64; WIDTH]; TERMS],
}

/// Weights of a sample at the points of the grid from `first` on.
#[derive(Debug, Clone, Copy)]
pub struct Weights {
    first: usize,
    of_points: [f64; WIDTH],
}

impl Weights {
    /// Adds a value to a grid of [`PhaseGrid::empty`].
    pub fn spread(&self, value: f64, grid: &mut [f64]) {
        let near = &mut grid[self.first..self.first + WIDTH];
        near.iter_mut().zip(&self.of_points).for_each(|(g, weight)| *g += value * weight);
    }

    /// The value of a grid of [`PhaseGrid::filled`] at the sample.
    pub fn read(&self, grid: &[f64]) -> f64 {
        let near = &grid[self.first..self.first + WIDTH];
        near.iter().zip(&self.of_points).map(|(g, weight)| g * weight).sum()
    }
}

impl PhaseGrid {
    /// For harmonics 0 to `n_harmonics`.
    ///
    /// # Errors
    /// [`ExtractionError::Harmonics`]: none that a fit of as many harmonics would not have.
    pub fn new(n_harmonics: usize) -> Result<Self, ExtractionError> {
        let points = (FINER * (2 * n_harmonics + 1)).next_power_of_two().max(2 * WIDTH);
        let refuse = || ExtractionError::Harmonics { harmonics: n_harmonics, frequency_hz: f64::NAN, samples: points };
        let basis = HarmonicBasis::new(n_harmonics, points).map_err(|_| refuse())?;
        let transform = (0..=n_harmonics).map(|n| transform(TAU * n as f64 / points as f64)).collect();
        Ok(Self { points, basis, transform, polynomials: polynomials().ok_or_else(refuse)? })
    }

    /// Weights at a phase, rad.
    pub fn weights(&self, phase: f64) -> Weights {
        let turns = phase / TAU;
        let at = (turns - turns.floor()) * self.points as f64;
        let first = at.floor();
        // From the first point of the kernel, which lies half its width before the sample.
        let x = 2.0 * (1.0 - (at - first)) - 1.0;
        let mut of_points = self.polynomials[TERMS - 1];
        for row in self.polynomials[..TERMS - 1].iter().rev() {
            of_points.iter_mut().zip(row).for_each(|(weight, c)| *weight = *weight * x + c);
        }
        Weights { first: first as usize, of_points }
    }

    /// A grid of zeros to spread over.
    pub fn empty(&self) -> Vec<f64> {
        vec![0.0; self.points + WIDTH + 1]
    }

    /// `Σ_j x_j e^{inψ_j}` of what was spread over a grid.
    pub fn sums(&mut self, grid: &[f64]) -> Vec<Complex64> {
        let mut once = vec![0.0; self.points];
        for (m, g) in grid.iter().enumerate() {
            once[self.turned(m)] += g;
        }
        let mut sums = vec![Complex64::default(); self.transform.len()];
        self.basis.analyze(&once, &mut sums);
        let half = 0.5 * self.points as f64;
        for (n, (sum, transform)) in sums.iter_mut().zip(&self.transform).enumerate() {
            // A basis has twice the mean product, but for the mean itself.
            let factor = if n == 0 { 2.0 * half } else { half };
            *sum = sum.conj() * (factor / transform);
        }
        sums
    }

    /// A grid to read `Re Σ_n q_n e^{inψ}` from.
    pub fn filled(&mut self, coefficients: &[Complex64]) -> Vec<f64> {
        let scaled: Vec<Complex64> =
            coefficients.iter().zip(&self.transform).map(|(q, transform)| q / *transform).collect();
        let mut once = vec![0.0; self.points];
        self.basis.synthesize(&scaled, &mut once);
        (0..self.points + WIDTH + 1).map(|m| once[self.turned(m)]).collect()
    }

    /// The point of the turn at which a point of a grid lies: grids begin half a width before it.
    fn turned(&self, m: usize) -> usize {
        (m + self.points + 1 - WIDTH / 2) % self.points
    }
}

/// The kernel at a distance in points.
fn kernel(distance: f64) -> f64 {
    let z = distance / (0.5 * WIDTH as f64);
    if z.abs() >= 1.0 { 0.0 } else { (DECAY * ((1.0 - z * z).sqrt() - 1.0)).exp() }
}

/// Its Fourier integral at an angle a point: `∫ φ(t) cos(angle t) dt`, by the midpoint rule after `t = sin`, so that
/// the ends do not count.
fn transform(angle: f64) -> f64 {
    let step = std::f64::consts::PI / NODES as f64;
    let term = |k: usize| {
        let x = -std::f64::consts::FRAC_PI_2 + step * (k as f64 + 0.5);
        let t = 0.5 * WIDTH as f64 * x.sin();
        kernel(t) * (angle * t).cos() * 0.5 * WIDTH as f64 * x.cos()
    };
    step * (0..NODES).map(term).sum::<f64>()
}

/// Polynomials through the kernel at each point, in `x` from −1 to 1 over the distance from one point to the next.
fn polynomials() -> Option<[[f64; WIDTH]; TERMS]> {
    let node = |i: usize| (std::f64::consts::PI * (i as f64 + 0.5) / TERMS as f64).cos();
    let powers = DMatrix::from_fn(TERMS, TERMS, |i, p| node(i).powi(p as i32)).lu();
    let mut table = [[0.0; WIDTH]; TERMS];
    for k in 0..WIDTH {
        let distance = |x: f64| k as f64 - 0.5 * WIDTH as f64 + 0.5 * (x + 1.0);
        let found = powers.solve(&DVector::from_fn(TERMS, |i, _| kernel(distance(node(i)))))?;
        table.iter_mut().zip(found.iter()).for_each(|(row, c)| row[k] = *c);
    }
    Some(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_polynomials_are_the_kernel() {
        let grid = PhaseGrid::new(3).unwrap();
        for share in [0.0, 1e-9, 0.1, 0.37, 0.5, 0.83, 1.0 - 1e-9] {
            let weights = grid.weights(TAU * (5.0 + share) / grid.points as f64);
            for (k, weight) in weights.of_points.iter().enumerate() {
                let distance = k as f64 + 1.0 - 0.5 * WIDTH as f64 - share;
                assert!((weight - kernel(distance)).abs() < 1e-13, "{share} {k}: {weight} {}", kernel(distance));
            }
        }
    }

    #[test]
    fn sums_and_signals_are_those_term_by_term() {
        for n_harmonics in [0, 1, 5, 40, 333] {
            let mut grid = PhaseGrid::new(n_harmonics).unwrap();
            let (step, n) = (0.0123, 3000);
            let phase = |j: usize| step * (j as f64 - 700.0);
            let x = |j: usize| ((j * j) as f64 * 0.61).sin() + 0.3;
            let mut spread = grid.empty();
            (0..n).for_each(|j| grid.weights(phase(j)).spread(x(j), &mut spread));
            let size: f64 = (0..n).map(|j| x(j).abs()).sum();
            for (k, sum) in grid.sums(&spread).iter().enumerate() {
                let direct: Complex64 = (0..n).map(|j| x(j) * Complex64::cis(k as f64 * phase(j))).sum();
                assert!((sum - direct).norm() < 1e-12 * size, "{n_harmonics} {k}: {sum} {direct}");
            }
            let mut q: Vec<Complex64> =
                (0..=n_harmonics).map(|k| Complex64::from_polar(1.0 / (1.0 + k as f64), k as f64)).collect();
            q[0].im = 0.0;
            let filled = grid.filled(&q);
            for j in [0, 1, 699, 700, 701, 2999] {
                let direct: f64 = q.iter().enumerate().map(|(k, q)| (q * Complex64::cis(k as f64 * phase(j))).re).sum();
                let read = grid.weights(phase(j)).read(&filled);
                assert!((read - direct).abs() < 1e-12 * (n_harmonics + 1) as f64, "{n_harmonics} {j}: {read} {direct}");
            }
        }
    }
}

use nlmodes_linalg::{DenseLu, Mat};

use crate::CondensedStructure;
use crate::energy::{KineticEnergy, inner};
use crate::transfer::Plane;

/// Most Newton steps: from the mode of the whole structure few are needed.
const MOST_STEPS: usize = 20;

/// Relative change of `ν²` and of `b` below which they are known.
const KNOWN: f64 = 1e-14;

/// Relative difference to the mode of the whole structure beyond which it is another one.
const OTHER: f64 = 0.1;

/// The linear mode that a structure with few of its held modes has in harmonics, `(A − B)(ν²) b = 0`, next to that of the whole structure with
/// angular frequency `omega` (rad/s) and `b = whole`: its angular frequency, and its `b` with `φᵀ M φ = 1`.
///
/// None where it is not found, as among several modes with one frequency.
pub(crate) fn reduced_mode(structure: &CondensedStructure, omega: f64, whole: &[f64]) -> Option<(f64, Vec<f64>)> {
    let (n, size) = (whole.len(), inner(whole, whole));
    let (mut plane, mut nu2, mut b) = (Plane::new(n), omega * omega, whole.to_vec());
    for _ in 0..MOST_STEPS {
        plane.set(structure, nu2);
        let row = |of: &[f64], i: usize| inner(&of[i * n..(i + 1) * n], &b);
        let scale = |i: usize| plane.size_of_row(i, nu2);
        let matrix = Mat::from_fn(n + 1, n + 1, |i, j| match (i < n, j < n) {
            (true, true) => plane.d[i * n + j] / scale(i),
            (true, false) => nu2 * (row(&plane.da, i) - row(&plane.db, i)) / scale(i),
            (false, true) => whole[j] / size,
            (false, false) => 0.0,
        });
        let mut step: Vec<f64> = (0..n).map(|i| -row(&plane.d, i) / scale(i)).collect();
        step.push(1.0 - inner(whole, &b) / size);
        DenseLu::factor(&matrix).ok()?.solve_in_place(&mut step);
        let (relative, moved) = (step.pop()?, step);
        nu2 *= 1.0 + relative;
        b.iter_mut().zip(&moved).for_each(|(b, moved)| *b += moved);
        let off: f64 = b.iter().zip(whole).map(|(b, whole)| (b - whole).powi(2)).sum();
        // NaN is far away too.
        if !((nu2 / (omega * omega) - 1.0).abs() < OTHER && off < OTHER * OTHER * size) {
            return None;
        }
        if relative.abs() < KNOWN && inner(&moved, &moved) < KNOWN * KNOWN * size {
            break;
        }
    }
    plane.set(structure, nu2);
    let mut energy = KineticEnergy::new(n);
    energy.set(structure, &plane, nu2, &b, &b);
    let factor = (0.25 * nu2 / energy.value).sqrt();
    factor.is_finite().then(|| (nu2.sqrt(), b.iter().map(|b| factor * b).collect()))
}

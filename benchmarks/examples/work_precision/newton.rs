//! Newton's method at a fixed frequency or energy.

use nlmodes::continuation::{Linearization, ParametricSystem};
use nlmodes::linalg::{DenseLu, Mat};

/// Where Newton's method ended.
pub struct Solution {
    /// Unknowns, then the parameter.
    pub z: Vec<f64>,
    pub residual: f64,
    pub iterations: usize,
}

/// Residual from which on a point counts as found, if it does not fall any more.
pub const FOUND: f64 = 1e-9;

const MOST_ITERATIONS: usize = 40;

/// Halvings of a step that does not make the residual smaller, before it is taken as it is.
const MOST_HALVINGS: usize = 6;

/// From `z`, unknowns and parameter, with entry `fixed` held; the best point of all iterates.
pub fn newton<S: ParametricSystem>(system: &mut S, z: &[f64], fixed: usize) -> Solution {
    iterate(system, z, fixed, 0)
}

/// The same, and where it does not settle, with steps that are halved: for starts from which contacts come and go.
pub fn search<S: ParametricSystem>(system: &mut S, z: &[f64], fixed: usize) -> Solution {
    let found = newton(system, z, fixed);
    if found.residual < FOUND { found } else { iterate(system, z, fixed, MOST_HALVINGS) }
}

fn iterate<S: ParametricSystem>(system: &mut S, z: &[f64], fixed: usize, halvings: usize) -> Solution {
    let n = system.dim();
    let free: Vec<usize> = (0..=n).filter(|j| *j != fixed).collect();
    let (mut z, mut at) = (z.to_vec(), Linearization::new(n));
    let (mut square, mut lu, mut step) = (Mat::<f64>::zeros(n, n), DenseLu::default(), vec![0.0; n]);
    let mut best = Solution { z: z.clone(), residual: f64::INFINITY, iterations: 0 };
    for iteration in 0..MOST_ITERATIONS {
        if system.linearize(&z[..n], z[n], &mut at).is_err() {
            break;
        }
        let residual = at.residual_norm();
        if residual >= best.residual && best.residual < FOUND {
            break;
        }
        if residual < best.residual {
            best = Solution { z: z.clone(), residual, iterations: iteration };
        }
        // Rounding leaves a few of its units.
        if residual < 2e-15 {
            break;
        }
        for (j, &from) in free.iter().enumerate() {
            square.col_mut(j).iter_mut().zip(at.jacobian.col(from).iter()).for_each(|(to, from)| *to = *from);
        }
        if lu.refactor(&square).is_err() {
            break;
        }
        step.copy_from_slice(&at.residual);
        lu.solve_in_place(&mut step);
        let shortened = shorten(system, &z, &free, &step, residual, halvings);
        free.iter().zip(&step).for_each(|(&j, s)| z[j] -= shortened * s);
    }
    best
}

/// The largest of 1, ½, ¼ … of the step after which the residual is smaller.
fn shorten<S: ParametricSystem>(
    system: &mut S,
    z: &[f64],
    free: &[usize],
    step: &[f64],
    residual: f64,
    halvings: usize,
) -> f64 {
    let n = system.dim();
    let (mut at, mut share) = (Linearization::new(n), 1.0);
    for _ in 0..halvings {
        let mut tried = z.to_vec();
        free.iter().zip(step).for_each(|(&j, s)| tried[j] -= share * s);
        if system.linearize(&tried[..n], tried[n], &mut at).is_ok() && at.residual_norm() < residual {
            return share;
        }
        share *= 0.5;
    }
    share
}

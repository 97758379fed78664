use nlmodes_continuation::{Linearization, ParametricSystem};
use nlmodes_linalg::{DenseLu, Mat};

use super::system::PeriodicSystem;

/// A solution to rounding. A closed rigid stop leaves of the gaps without contact forces only what it is pressed by,
/// which may be 1e-8 of them: forces, and with them the balance of power, then have but half of the digits of the
/// unknowns.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Refined {
    /// The unknowns.
    pub x: Vec<f64>,
    /// The parameter.
    pub p: f64,
    /// Largest scaled residual.
    pub residual: f64,
}

/// Most evaluations, and the shortest share of a step of Newton's method that is tried.
const STEPS: usize = 20;
const SHORTEST: f64 = 0.05;

impl PeriodicSystem {
    /// The solution near `(x, p)` to rounding, by steps of Newton's method across `border` (n + 1): along it the
    /// unknowns and the parameter stay. The best of the iterates, with its residual, where these do not converge.
    pub fn refine(&mut self, x: &[f64], p: f64, border: &[f64]) -> Refined {
        let n = self.dim();
        let mut best = Refined { x: x.to_vec(), p, residual: f64::INFINITY };
        let mut at = Linearization::new(n);
        let mut z: Vec<f64> = x.iter().chain([&p]).copied().collect();
        let (mut from, mut step, mut share) = (z.clone(), vec![0.0; n + 1], 1.0);
        for _ in 0..STEPS {
            let is_evaluated = self.linearize(&z[..n], z[n], &mut at).is_ok();
            if is_evaluated && at.residual_norm() < best.residual {
                best = Refined { x: z[..n].to_vec(), p: z[n], residual: at.residual_norm() };
                let square = Mat::from_fn(n + 1, n + 1, |i, j| if i < n { at.jacobian[(i, j)] } else { border[j] });
                let Ok(lu) = DenseLu::factor(&square) else { break };
                step = at.residual.iter().copied().chain([0.0]).collect();
                lu.solve_in_place(&mut step);
                (from, share) = (z, 1.0);
            } else if share > SHORTEST {
                // Where an interval of contact begins or vanishes, the full step may lead too far.
                share *= 0.25;
            } else {
                break;
            }
            z = from.iter().zip(&step).map(|(z, step)| z - share * step).collect();
        }
        best
    }
}

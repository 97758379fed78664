//! Bratu's problem `u″ + p eᵘ = 0`, `u(0) = u(1) = 0`: two solutions for small `p`, none beyond the fold at
//! `p = 3.513830719…`.
//!
//! Central differences on `n` inner nodes; the branch starts at `u = 0`, turns at the fold, and ends where the maximum
//! of `u` is 5.
//!
//! `cargo run -p nlmodes-continuation --example bratu`

use std::convert::Infallible;
use std::ops::ControlFlow;

use nlmodes_continuation::{Bound, Continuation, ContinuationError, EventKind, Linearization, ParametricSystem};

/// Its fold, from `p = 8 (θ / cosh θ)²` at `θ tanh θ = 1`.
const FOLD: f64 = 3.513_830_719_125_162;

struct Bratu {
    n: usize,
}

impl ParametricSystem for Bratu {
    type Error = Infallible;

    fn dim(&self) -> usize {
        self.n
    }

    fn linearize(&mut self, u: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        let h2 = (1.0 / (self.n + 1) as f64).powi(2);
        for i in 0..self.n {
            let (left, right) = (if i > 0 { u[i - 1] } else { 0.0 }, u.get(i + 1).copied().unwrap_or(0.0));
            out.residual[i] = left - 2.0 * u[i] + right + h2 * p * u[i].exp();
            out.jacobian[(i, i)] = h2 * p * u[i].exp() - 2.0;
            out.jacobian[(i, self.n)] = h2 * u[i].exp();
            if i > 0 {
                (out.jacobian[(i, i - 1)], out.jacobian[(i - 1, i)]) = (1.0, 1.0);
            }
        }
        Ok(())
    }
}

/// Parameter at the fold, and at the end of the branch, on `n` inner nodes.
fn follow(n: usize) -> Result<(Option<f64>, f64), ContinuationError<Infallible>> {
    let middle = Bound { coordinate: n / 2, min: -1.0, max: 5.0 };
    let settings = Continuation { bounds: vec![middle], ..Continuation::default() };
    let mut direction = vec![0.0; n + 1];
    direction[n] = 1.0;
    let branch = settings.run(&mut Bratu { n }, &vec![0.0; n], 0.0, &direction, |_| ControlFlow::Continue(()))?;
    let fold = branch.points.iter().find(|point| point.events.contains(&EventKind::ParameterFold)).map(|point| point.p);
    Ok((fold, branch.points.last().map_or(0.0, |point| point.p)))
}

fn main() -> Result<(), ContinuationError<Infallible>> {
    for n in [15, 31, 63] {
        let (fold, end) = follow(n)?;
        let fold = fold.unwrap_or(f64::NAN);
        println!("{n:>3} nodes: fold at p = {fold:.8} ({:+.1e}), maximum 5 at p = {end:.6}", fold - FOLD);
    }
    Ok(())
}

#[test]
fn the_fold_is_found_and_converges_with_the_square_of_the_spacing() -> Result<(), ContinuationError<Infallible>> {
    let error = |n| follow(n).map(|(fold, _)| fold.map_or(f64::NAN, |p| p - FOLD));
    let rate = (error(15)? / error(31)?).log2();
    assert!((rate - 2.0).abs() < 0.02, "{rate}");
    // On the upper half u = ln(cosh²θ / cosh²(θ (1 − 2x))), p = 8 (θ / cosh θ)², with a maximum of 5 where cosh θ =
    // e^{5/2}.
    let theta = 2.5_f64.exp().acosh();
    let exact = 8.0 * (theta / theta.cosh()).powi(2);
    let (coarse, fine) = (follow(15)?.1, follow(31)?.1);
    assert!(((4.0 * fine - coarse) / 3.0 / exact - 1.0).abs() < 2e-3, "{coarse} {fine} {exact}");
    Ok(())
}

//! Equations as systems for continuation.

use std::convert::Infallible;

use nlmodes::continuation::{Linearization, ParametricSystem};

/// `f(x, p) = 0`, written by a function.
pub struct Equations<F> {
    pub n: usize,
    pub f: F,
}

impl<F: Fn(&[f64], f64, &mut Linearization)> ParametricSystem for Equations<F> {
    type Error = Infallible;

    fn dim(&self) -> usize {
        self.n
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        out.residual.fill(0.0);
        (0..=self.n).for_each(|j| (0..self.n).for_each(|i| out.jacobian[(i, j)] = 0.0));
        (self.f)(x, p, out);
        Ok(())
    }
}

/// One equation: value and both derivatives.
pub fn planar(f: impl Fn(f64, f64) -> [f64; 3]) -> Equations<impl Fn(&[f64], f64, &mut Linearization)> {
    let f = move |x: &[f64], p: f64, out: &mut Linearization| {
        [out.residual[0], out.jacobian[(0, 0)], out.jacobian[(0, 1)]] = f(x[0], p);
    };
    Equations { n: 1, f }
}

/// Central differences of `u″ + p f(u)` on `n` inner nodes, times h², with both ends at `end`.
pub fn two_point(
    n: usize,
    end: f64,
    f: impl Fn(f64) -> [f64; 2],
) -> Equations<impl Fn(&[f64], f64, &mut Linearization)> {
    let h2 = ((n + 1) as f64).powi(-2);
    let equations = move |u: &[f64], p: f64, out: &mut Linearization| {
        for i in 0..n {
            let [value, derivative] = f(u[i]);
            let left = if i == 0 { end } else { u[i - 1] };
            let right = if i + 1 == n { end } else { u[i + 1] };
            out.residual[i] = left - 2.0 * u[i] + right + h2 * p * value;
            out.jacobian[(i, i)] = -2.0 + h2 * p * derivative;
            out.jacobian[(i, n)] = h2 * value;
            if i > 0 {
                out.jacobian[(i, i - 1)] = 1.0;
            }
            if i + 1 < n {
                out.jacobian[(i, i + 1)] = 1.0;
            }
        }
    };
    Equations { n, f: equations }
}

/// A system with two smooth pieces.
pub struct Pieces<S> {
    pub inner: S,
    pub edge: f64,
    pub beyond: bool,
}

impl<S: ParametricSystem> ParametricSystem for Pieces<S> {
    type Error = S::Error;

    fn dim(&self) -> usize {
        self.inner.dim()
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), S::Error> {
        self.beyond = x[0] > self.edge;
        self.inner.linearize(x, p, out)
    }

    fn pattern(&self) -> u64 {
        u64::from(self.beyond)
    }
}

//! Solutions that are too far from a guess for Newton's method.

use std::ops::ControlFlow;

use nlmodes_continuation::{
    Bound, Boundary, Continuation, Linearization, ParametricSystem, RunLog, Scaling, StepSettings, StopReason,
};
use nlmodes_linalg::{column, column_mut};
use thiserror::Error;

/// What may be spent on the way to a solution. A search for the half-branches of a corner on it, among a hundred
/// unknowns, may take a hundred thousand evaluations: there are other ways.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Effort {
    points: usize,
    /// For each of them, so that a way that is gone on with after an interruption is the same.
    evaluations: usize,
}

impl Effort {
    /// For a beginning.
    pub const FULL: Self = Self { points: 500, evaluations: 1000 };
    /// For one of some tens of tries, of which few have to succeed.
    pub const SOME: Self = Self { points: 100, evaluations: 300 };
    /// For one of many tries.
    pub const LITTLE: Self = Self { points: 20, evaluations: 60 };
}

/// Why the deformed problem is not evaluated.
#[derive(Debug, Error)]
enum HomotopyError<E: std::error::Error + 'static> {
    #[error(transparent)]
    System(E),
    #[error("a step on the way to a solution takes too many evaluations")]
    TooLong,
}

/// `R(z) = (1 − s) R(z₀)` with one coordinate of `z` kept, n + 1 equations for `z` with the parameter `s`: solved by
/// `z₀` at `s = 0`, and by a solution of `R(z) = 0` at `s = 1`.
struct Homotopy<'a, S> {
    system: &'a mut S,
    inner: Linearization,
    /// `R(z₀)`.
    defect: Vec<f64>,
    coordinate: usize,
    value: f64,
    /// Evaluations since the last step, and how many there may be.
    spent: usize,
    most: usize,
}

impl<S: ParametricSystem> ParametricSystem for Homotopy<'_, S> {
    type Error = HomotopyError<S::Error>;

    fn dim(&self) -> usize {
        self.defect.len() + 1
    }

    fn linearize(&mut self, z: &[f64], s: f64, out: &mut Linearization) -> Result<(), Self::Error> {
        let n = self.defect.len();
        self.spent += 1;
        if self.spent > self.most {
            return Err(HomotopyError::TooLong);
        }
        self.system.linearize(&z[..n], z[n], &mut self.inner).map_err(HomotopyError::System)?;
        for i in 0..n {
            out.residual[i] = self.inner.residual[i] - (1.0 - s) * self.defect[i];
            out.sizes[i] = self.inner.sizes[i];
        }
        out.residual[n] = z[self.coordinate] - self.value;
        for j in 0..=n + 1 {
            let from = if j > n { &self.defect } else { column(&self.inner.jacobian, j) };
            let to = column_mut(&mut out.jacobian, j);
            to[..n].copy_from_slice(&from[..n]);
            to[n] = if j == self.coordinate { 1.0 } else { 0.0 };
        }
        Ok(())
    }

    fn scaling(&self) -> Option<Scaling> {
        Some(Scaling::unit(self.dim()))
    }

    fn pattern(&self) -> u64 {
        self.system.pattern()
    }

    fn pattern_at(&mut self, z: &[f64]) -> Option<u64> {
        self.system.pattern_at(&z[..=self.defect.len()])
    }

    fn boundary(&mut self, from: &[f64], to: &[f64]) -> Option<Boundary> {
        let n = self.defect.len();
        let boundary = self.system.boundary(&from[..=n], &to[..=n])?;
        Some(Boundary::new(move |z| boundary.value(&z[..=n])))
    }

    fn accepted(&mut self, z: &[f64], _: f64) {
        let n = self.defect.len();
        self.spent = 0;
        self.system.accepted(&z[..n], z[n]);
    }
}

/// The solution to which the guess `z` deforms as its residual is taken away, with this coordinate kept; `None` if that
/// leads nowhere or takes more than it may.
pub(crate) fn solve<S: ParametricSystem>(
    system: &mut S,
    z: &[f64],
    coordinate: usize,
    step: &StepSettings,
    effort: Effort,
    log: &mut dyn RunLog,
) -> Option<(Vec<f64>, f64)> {
    let n = z.len() - 1;
    let mut inner = Linearization::new(n);
    system.linearize(&z[..n], z[n], &mut inner).ok()?;
    let defect = inner.residual.clone();
    let (value, most) = (z[coordinate], effort.evaluations);
    let mut homotopy = Homotopy { system, inner, defect, coordinate, value, spent: 0, most };
    let bounds = vec![Bound { coordinate: n + 1, min: -0.5, max: 1.0 }];
    let method = Continuation { step: step.clone(), bounds, max_points: effort.points, ..Continuation::default() };
    let mut direction = vec![0.0; n + 2];
    direction[n + 1] = 1.0;
    let branch = method.run_with_log(&mut homotopy, z, 0.0, &direction, log, |_| ControlFlow::Continue(())).ok()?;
    let last = branch.points.last()?;
    let arrived = matches!(branch.stop, StopReason::Bound { value, .. } if value == 1.0);
    arrived.then(|| (last.x[..n].to_vec(), last.x[n]))
}

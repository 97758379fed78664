use std::f64::consts::TAU;

use nlmodes_linalg::{DenseLu, Mat, eigenvalues};

use super::trajectory::{Piece, Propagator, transition};
use super::{ForcedMotion, ForcedStructure};
use crate::{MAX_SHOOTING_MODES, TimestepError};

/// Maximum number of Newton steps, and the smallest damping factor tried.
const STEPS: usize = 40;
const SHORTEST: f64 = 1e-3;

/// Relative residual below which a motion is periodic, and below which no further improvement is attempted.
const PERIODIC: f64 = 1e-9;
const ROUNDING: f64 = 1e-15;

/// A first state, the steps from there, and the last state.
type Shot = (Vec<f64>, Vec<Piece>, Vec<f64>);

impl ForcedStructure {
    /// The periodic motion near a state under the load of this level at the frequency `omega` (rad/s), over this many
    /// of its periods: Newton's method on `x(T; x₀) − x₀ = 0` with the exact derivative, stable or not.
    ///
    /// # Errors
    /// [`TimestepError::NotPositive`], [`TimestepError::Dimension`], [`TimestepError::TooManyModes`],
    /// [`TimestepError::NotConverged`], or errors of the contact problem.
    pub fn periodic(
        &self,
        level: f64,
        omega: f64,
        periods: usize,
        near: &[f64],
    ) -> Result<ForcedMotion, TimestepError> {
        for (what, value) in [("frequency (rad/s)", omega), ("periods of the load", periods as f64)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(TimestepError::NotPositive { what, value });
            }
        }
        let (m, n) = (self.n_modes(), self.n_states());
        if m > MAX_SHOOTING_MODES {
            return Err(TimestepError::TooManyModes { found: m, most: MAX_SHOOTING_MODES });
        }
        if near.len() != n {
            return Err(TimestepError::Dimension { what: "entries of the state", expected: n, found: near.len() });
        }
        if near.iter().any(|v| !v.is_finite()) || !level.is_finite() {
            return Err(TimestepError::NotFinite { what: "state of the motion" });
        }
        let mut propagator = Propagator::new(self, omega, level)?;
        let duration = TAU * periods as f64 / omega;
        let mut x = self.in_units(near, self.rate().recip());
        let (mut pieces, mut end) = propagator.propagate(&x, duration)?;
        let mut iterations = 0;
        while iterations < STEPS && distance(&x, &end) > ROUNDING {
            iterations += 1;
            let over = transition(&pieces, n)?;
            let jacobian = Mat::from_fn(n, n, |i, j| over[(i, j)] - f64::from(u8::from(i == j)));
            let lu = DenseLu::factor(&jacobian).map_err(TimestepError::during("derivative of a forced motion"))?;
            let mut step: Vec<f64> = end.iter().zip(&x).map(|(end, x)| end - x).collect();
            lu.solve_in_place(&mut step);
            let Some(next) = self.shortened(&mut propagator, &x, &step, distance(&x, &end), duration)? else { break };
            (x, pieces, end) = next;
        }
        let residual = distance(&x, &end);
        if residual.is_nan() || residual > PERIODIC {
            return Err(TimestepError::NotConverged { residual, iterations });
        }
        let mut multipliers =
            eigenvalues(&transition(&pieces, n)?).map_err(TimestepError::during("Floquet multipliers"))?;
        multipliers.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        Ok(ForcedMotion { omega, periods, state: self.in_units(&x, self.rate()), residual, multipliers, pieces })
    }

    /// The state after this many periods of the load.
    ///
    /// # Errors
    /// As [`periodic`](Self::periodic).
    pub fn after(&self, level: f64, omega: f64, periods: usize, state: &[f64]) -> Result<Vec<f64>, TimestepError> {
        let expected = self.n_states();
        if state.len() != expected {
            return Err(TimestepError::Dimension { what: "entries of the state", expected, found: state.len() });
        }
        let x = self.in_units(state, self.rate().recip());
        let end = Propagator::new(self, omega, level)?.propagate(&x, TAU * periods as f64 / omega)?.1;
        Ok(self.in_units(&end, self.rate()))
    }

    /// A state with its rates multiplied by a factor.
    pub(super) fn in_units(&self, state: &[f64], factor: f64) -> Vec<f64> {
        let m = self.n_modes();
        let is_rate = |i: usize| (m..2 * m).contains(&i);
        state.iter().enumerate().map(|(i, v)| if is_rate(i) { v * factor } else { *v }).collect()
    }

    /// The motion from the first damped step that reduces the residual; none if no step does.
    fn shortened(
        &self,
        propagator: &mut Propagator<'_>,
        x: &[f64],
        step: &[f64],
        before: f64,
        duration: f64,
    ) -> Result<Option<Shot>, TimestepError> {
        let mut share = 1.0;
        while share > SHORTEST {
            let next: Vec<f64> = x.iter().zip(step).map(|(x, s)| x - share * s).collect();
            let (pieces, end) = propagator.propagate(&next, duration)?;
            if distance(&next, &end) < before {
                return Ok(Some((next, pieces, end)));
            }
            share *= 0.4;
        }
        Ok(None)
    }
}

/// Largest difference of two states relative to the first.
pub(super) fn distance(x: &[f64], end: &[f64]) -> f64 {
    // NaN is preserved.
    let larger = |most: f64, v: f64| if v.abs() > most || v.is_nan() { v.abs() } else { most };
    let largest = |of: &mut dyn Iterator<Item = f64>| of.fold(0.0, larger);
    let size = largest(&mut x.iter().chain(end).copied());
    let off = largest(&mut x.iter().zip(end).map(|(x, end)| x - end));
    if size == 0.0 { off } else { off / size }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distance_of_states_is_relative_to_the_larger_of_them() {
        for unit in [1e-9, 1.0, 1e6] {
            let state = |v: [f64; 2]| v.map(|x| unit * x);
            let found = distance(&state([1.0, -4.0]), &state([1.5, -3.0]));
            assert!((found - 0.25).abs() < 1e-15, "{found}");
            let found = distance(&state([1.0, -4.0]), &state([1.5, -8.0]));
            assert!((found - 0.5).abs() < 1e-15, "{found}");
        }
        assert_eq!(distance(&[0.0; 2], &[0.0; 2]), 0.0);
        assert!(distance(&[f64::NAN, 1.0], &[0.0; 2]).is_nan());
    }
}

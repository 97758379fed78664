use std::f64::consts::TAU;

use nlmodes_linalg::{DenseLu, Mat, eigenvalues};

use super::trajectory::{Piece, Propagator};
use super::{ForcedMotion, ForcedStructure};
use crate::error::{agrees, fits, positive};
use crate::phase::product;
use crate::{MAX_SHOOTING_MODES, TimestepError};

/// Maximum number of Newton steps, and the smallest damping factor tried.
const STEPS: usize = 40;
const SHORTEST: f64 = 1e-3;

/// Relative residual below which a motion is periodic, and below which no further improvement is attempted.
const PERIODIC: f64 = 1e-9;
const ROUNDING: f64 = 1e-15;

/// The parts of a period from their first states on.
struct Shots {
    /// First states.
    states: Vec<Vec<f64>>,
    /// The steps of each part, and its last state.
    parts: Vec<(Vec<Piece>, Vec<f64>)>,
}

impl Shots {
    /// What each part ends with beyond the beginning of the next one.
    fn jump(&self, k: usize) -> Vec<f64> {
        let next = &self.states[(k + 1) % self.states.len()];
        self.parts[k].1.iter().zip(next).map(|(end, next)| end - next).collect()
    }

    /// The largest of these, relative to the states.
    fn residual(&self) -> f64 {
        let of = |k: usize| distance(&self.states[(k + 1) % self.states.len()], &self.parts[k].1);
        // NaN is preserved.
        (0..self.states.len()).map(of).fold(0.0, |most, v| if v > most || v.is_nan() { v } else { most })
    }
}

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
        self.periodic_through(level, omega, periods, &[near.to_vec()])
    }

    /// The same near several states that follow each other in equal parts of its period, the first one at its
    /// beginning: by multiple shooting, which finds motions that are too unstable to be followed over a whole period.
    ///
    /// # Errors
    /// As [`periodic`](Self::periodic).
    pub fn periodic_through(
        &self,
        level: f64,
        omega: f64,
        periods: usize,
        near: &[Vec<f64>],
    ) -> Result<ForcedMotion, TimestepError> {
        positive("frequency (rad/s)", omega)?;
        positive("periods of the load", periods as f64)?;
        positive("states of the motion", near.len() as f64)?;
        let (m, n) = (self.n_modes(), self.n_states());
        if m > MAX_SHOOTING_MODES {
            return Err(TimestepError::TooManyModes { found: m, most: MAX_SHOOTING_MODES });
        }
        for state in near {
            fits("entries of the state", n, state)?;
        }
        fits("level of the load", 1, &[level])?;
        let mut propagator = Propagator::new(self, omega, level)?;
        let duration = TAU * periods as f64 / omega;
        let states = near.iter().map(|state| self.in_units(state, self.rate().recip())).collect();
        let mut shots = shots(&mut propagator, states, duration)?;
        let mut iterations = 0;
        while iterations < STEPS && shots.residual() > ROUNDING {
            iterations += 1;
            let steps = self.newton(&shots)?;
            let Some(next) = shortened(&mut propagator, &shots, &steps, duration)? else { break };
            shots = next;
        }
        let residual = shots.residual();
        if residual.is_nan() || residual > PERIODIC {
            return Err(TimestepError::NotConverged { residual, iterations });
        }
        let state = self.in_units(&shots.states[0], self.rate());
        let pieces: Vec<Piece> = shots.parts.into_iter().flat_map(|(pieces, _)| pieces).collect();
        let mut multipliers =
            eigenvalues(&self.transition(&pieces)?).map_err(TimestepError::during("Floquet multipliers"))?;
        multipliers.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        Ok(ForcedMotion { omega, periods, state, residual, multipliers, pieces })
    }

    /// The step of each state: `δ_{k+1} = T_k δ_k + r_k` around the period.
    fn newton(&self, shots: &Shots) -> Result<Vec<Vec<f64>>, TimestepError> {
        let n = self.n_states();
        let over = shots.parts.iter().map(|(pieces, _)| self.transition(pieces)).collect::<Result<Vec<_>, _>>()?;
        let (mut around, mut first) = (Mat::identity(n, n), vec![0.0; n]);
        for (k, over) in over.iter().enumerate() {
            around = over * &around;
            first = product(over, &first).iter().zip(shots.jump(k)).map(|(x, r)| x + r).collect();
        }
        let jacobian = Mat::from_fn(n, n, |i, j| f64::from(u8::from(i == j)) - around[(i, j)]);
        let lu = DenseLu::factor(&jacobian).map_err(TimestepError::during("derivative of a forced motion"))?;
        lu.solve_in_place(&mut first);
        let mut steps = vec![first];
        for (k, over) in over.iter().enumerate().take(shots.states.len() - 1) {
            steps.push(product(over, &steps[k]).iter().zip(shots.jump(k)).map(|(x, r)| x + r).collect());
        }
        Ok(steps)
    }

    /// The state after this many periods of the load.
    ///
    /// # Errors
    /// As [`periodic`](Self::periodic).
    pub fn after(&self, level: f64, omega: f64, periods: usize, state: &[f64]) -> Result<Vec<f64>, TimestepError> {
        agrees("entries of the state", self.n_states(), state.len())?;
        let x = self.in_units(state, self.rate().recip());
        let end = Propagator::new(self, omega, level)?.propagate(&x, 0.0, TAU * periods as f64 / omega)?.1;
        Ok(self.in_units(&end, self.rate()))
    }

    /// A state with its rates multiplied by a factor.
    pub(super) fn in_units(&self, state: &[f64], factor: f64) -> Vec<f64> {
        let m = self.n_modes();
        let is_rate = |i: usize| (m..2 * m).contains(&i);
        state.iter().enumerate().map(|(i, v)| if is_rate(i) { v * factor } else { *v }).collect()
    }
}

/// All parts of a period from their first states.
fn shots(propagator: &mut Propagator<'_>, states: Vec<Vec<f64>>, duration: f64) -> Result<Shots, TimestepError> {
    let at = |k: usize| duration * k as f64 / states.len() as f64;
    let parts = states.iter().enumerate().map(|(k, state)| propagator.propagate(state, at(k), at(k + 1)));
    let parts = parts.collect::<Result<_, _>>()?;
    Ok(Shots { states, parts })
}

/// The motion from the first damped step that reduces the residual; none if no step does.
fn shortened(
    propagator: &mut Propagator<'_>,
    from: &Shots,
    steps: &[Vec<f64>],
    duration: f64,
) -> Result<Option<Shots>, TimestepError> {
    let (before, mut share) = (from.residual(), 1.0);
    while share > SHORTEST {
        let moved = |(x, step): (&Vec<f64>, &Vec<f64>)| x.iter().zip(step).map(|(x, s)| x + share * s).collect();
        let states: Vec<Vec<f64>> = from.states.iter().zip(steps).map(moved).collect();
        let next = shots(propagator, states, duration)?;
        if next.residual() < before {
            return Ok(Some(next));
        }
        share *= 0.4;
    }
    Ok(None)
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

use std::f64::consts::TAU;

use super::ForcedMotion;
use super::ForcedStructure;
use super::flow::Flow;
use super::trajectory::Propagator;
use crate::TimestepError;
use crate::error::{fits, positive};
use crate::phase::{dot, product};

/// Powers of the transition matrix by which the direction of its largest multiplier is found.
const POWERS: usize = 200;

/// A motion at an instant.
#[derive(Debug, Clone, Copy)]
pub struct Flash<'a> {
    /// Its state: modal coordinates, their rates, displacements of the dissipative stops.
    pub state: &'a [f64],
    /// The observed displacements, m.
    pub observed: &'a [f64],
    /// Their largest values since the instant before, m.
    pub largest: &'a [f64],
}

impl ForcedStructure {
    /// Follows the motion from a state at the beginning of a period of the load, and shows so many states of each
    /// period, the first one after `1/n` of the first period, for as long as `goes_on`.
    ///
    /// # Errors
    /// As [`periodic`](Self::periodic).
    pub fn flash(
        &self,
        (level, omega): (f64, f64),
        state: &[f64],
        n: usize,
        goes_on: &mut dyn FnMut(Flash<'_>) -> bool,
    ) -> Result<(), TimestepError> {
        fits("entries of the state", self.n_states(), state)?;
        positive("frequency (rad/s)", omega)?;
        positive("states of a period", n as f64)?;
        let mut propagator = Propagator::new(self, omega, level)?;
        let mut x = self.in_units(state, self.rate().recip());
        loop {
            let (period, mut k) = (TAU / omega, 1);
            let mut running = propagator.start(self.augmented(&x, omega, 0.0), 0.0)?;
            let mut largest = vec![f64::NEG_INFINITY; self.observed.len()];
            let mut show = |flow: &Flow, w: &[f64], largest: &mut Vec<f64>| {
                let observed: Vec<f64> = flow.observed.iter().map(|row| dot(row.row(), w)).collect();
                largest.iter_mut().zip(&observed).for_each(|(most, value)| *most = most.max(*value));
                let state = self.in_units(&w[..self.n_states()], self.rate());
                let is_going_on = goes_on(Flash { state: &state, observed: &observed, largest });
                largest.fill(f64::NEG_INFINITY);
                is_going_on
            };
            while let Some(mut piece) = propagator.advance(&mut running, period)? {
                // The instants within it divide the piece; the last one is the end of the period.
                while k < n && period * k as f64 / n as f64 <= piece.from + piece.length {
                    let part = period * k as f64 / n as f64 - piece.from;
                    let w = piece.flow.after(&piece.w, part);
                    let rest = piece.length - part;
                    piece.length = part;
                    piece.raise(&mut largest, &w);
                    if !show(&piece.flow, &w, &mut largest) {
                        return Ok(());
                    }
                    (piece.from, piece.length, piece.w) = (piece.from + part, rest, w);
                    k += 1;
                }
                piece.raise(&mut largest, &running.w);
            }
            if !show(&running.flow, &running.w, &mut largest) {
                return Ok(());
            }
            x.copy_from_slice(&running.w[..self.n_states()]);
        }
    }

    /// The direction of the largest multiplier of a motion, or one in the plane of a complex pair: what becomes of any
    /// disturbance after many periods. Its largest entry, with rates over the highest frequency, is as large as that of
    /// the state of the motion.
    ///
    /// # Errors
    /// [`TimestepError::Linalg`].
    pub fn disturbance(&self, motion: &ForcedMotion) -> Result<Vec<f64>, TimestepError> {
        let n = self.n_states();
        let over = self.transition(&motion.pieces)?;
        let largest = |x: &[f64]| x.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let mut x: Vec<f64> = (0..n).map(|i| 1.0 / (1 + i % 7) as f64).collect();
        for _ in 0..POWERS {
            x = product(&over, &x);
            let size = largest(&x);
            if size == 0.0 || !size.is_finite() {
                break;
            }
            x.iter_mut().for_each(|v| *v /= size);
        }
        let size = largest(&self.in_units(&motion.state, self.rate().recip()));
        x.iter_mut().for_each(|v| *v *= size);
        Ok(self.in_units(&x, self.rate()))
    }

    /// Largest difference of two states, with rates over the highest frequency, relative to the larger of them.
    pub fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let rate = self.rate().recip();
        super::shooting::distance(&self.in_units(a, rate), &self.in_units(b, rate))
    }
}

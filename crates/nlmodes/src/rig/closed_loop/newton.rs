use std::f64::consts::TAU;

use nlmodes_experiment::phase_loop::Controlled;
use nlmodes_linalg::{DenseLu, Mat};

use super::{ClosedLoop, Map};
use crate::rig::RigError;

/// Step of the differences, relative to the size of what is changed: contact instants are smooth functions of it.
const STEP: f64 = 1e-6;
/// Largest defect of a periodic motion, relative.
const DEFECT: f64 = 1e-9;
/// Most iterations.
const ITERATIONS: usize = 14;
/// Largest change in an iteration, relative.
const CHANGE: f64 = 0.3;
/// A defect that shrinks by less than this factor wants a new Jacobian.
const SHRINKS: f64 = 0.2;

/// A motion that may be periodic: state at phase zero, and the frequency at which it is to repeat itself.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Guess {
    pub(crate) y: Vec<f64>,
    pub(crate) omega: f64,
}

impl Guess {
    /// On the line through two motions, at `share` of the way from the first to the second.
    pub(crate) fn between(&self, other: &Self, share: f64) -> Self {
        let mix = |(a, b): (&f64, &f64)| a + share * (b - a);
        Self { y: self.y.iter().zip(&other.y).map(mix).collect(), omega: mix((&self.omega, &other.omega)) }
    }
}

impl ClosedLoop {
    /// Sizes of the entries of a state: one for those of the rig, which are alike, and one for each signal of the
    /// detector.
    fn scales(&self, at: &Guess) -> Vec<f64> {
        let (control, rig) = at.y.split_at(at.y.len() - self.states());
        let size = |part: &[f64]| part.iter().fold(f64::MIN_POSITIVE, |m: f64, x| m.max(x.abs()));
        let mut scales = vec![1.0, at.omega];
        let (detected, drive) = control[2..].split_at(control.len() - 2 - self.driven());
        for part in detected.chunks((detected.len() / 2).max(1)) {
            scales.extend(vec![size(part); part.len()]);
        }
        scales.extend([size(drive), 1.0].iter().take(drive.len()));
        scales.extend(vec![size(rig); rig.len()]);
        scales
    }

    /// Numbers of the control of an amplitude: the drive and the error before.
    fn driven(&self) -> usize {
        if self.control.amplitude.controlled == Controlled::Drive { 0 } else { 2 }
    }

    /// Number of states of the rig.
    pub(crate) fn states(&self) -> usize {
        let stages: usize = self.rig.sensors.iter().map(|sensor| sensor.chain.stages.len()).sum();
        2 * self.rig.structure.modes() + self.rig.exciter.states() + 2 * stages
    }
}

/// `∂P/∂y` in scaled entries, the phase first, and the derivative of `P` by the logarithm of the frequency.
#[derive(Debug)]
pub(crate) struct Derivatives {
    pub(crate) by_state: Mat<f64>,
    by_frequency: Vec<f64>,
}

impl ClosedLoop {
    /// The periodic motion of a level near a guess; none where Newton's method does not find one.
    pub(crate) fn periodic(
        &self,
        level: f64,
        guess: &Guess,
        known: &mut Option<Derivatives>,
    ) -> Result<Option<Guess>, RigError> {
        let (mut at, samples) = (guess.clone(), self.samples(guess.omega));
        at.y[0] = 0.0;
        let mut before = f64::INFINITY;
        for _ in 0..ITERATIONS {
            let map = self.map(level, at.omega, samples, 0.0)?;
            let Ok(after) = map.after(&at.y) else { return Ok(None) };
            let scales = self.scales(&at);
            let defect: Vec<f64> = after.iter().zip(&at.y).zip(&scales).map(|((a, y), s)| (a - y) / s).collect();
            let size = defect.iter().fold(0.0, |m: f64, d| if d.abs() <= m { m } else { d.abs() });
            if size <= DEFECT {
                return Ok(Some(at));
            }
            if !size.is_finite() {
                return Ok(None);
            }
            if size > SHRINKS * before || known.is_none() {
                *known = self.derivatives(level, &at, samples, &after)?;
            }
            before = size;
            let Some(known) = known.as_ref() else { return Ok(None) };
            let Some(change) = known.newton(&defect) else { return Ok(None) };
            let largest = change.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
            let share = (CHANGE / largest).min(1.0);
            at.y.iter_mut().zip(&change).zip(&scales).skip(1).for_each(|((y, c), s)| *y += share * c * s);
            at.omega *= (share * change[0]).exp();
        }
        Ok(None)
    }

    /// Derivatives at a motion, by differences.
    pub(crate) fn derivatives(
        &self,
        level: f64,
        at: &Guess,
        samples: usize,
        after: &[f64],
    ) -> Result<Option<Derivatives>, RigError> {
        let map = self.map(level, at.omega, samples, 0.0)?;
        let (scales, n) = (self.scales(at), at.y.len());
        let mut by_state = Mat::zeros(n, n);
        let difference = |map: &Map, y: &[f64]| -> Option<Vec<f64>> {
            let moved = map.after(y).ok()?;
            Some(moved.iter().zip(after).zip(&scales).map(|((m, a), s)| (m - a) / (s * STEP)).collect())
        };
        for j in 0..n {
            let mut y = at.y.clone();
            y[j] += STEP * scales[j];
            let Some(column) = difference(&map, &y) else { return Ok(None) };
            column.iter().enumerate().for_each(|(i, d)| by_state[(i, j)] = *d);
        }
        let faster = self.map(level, at.omega * (1.0 + STEP), samples, 0.0)?;
        let by_frequency = difference(&faster, &at.y);
        Ok(by_frequency.map(|by_frequency| Derivatives { by_state, by_frequency }))
    }
}

impl Derivatives {
    /// Change of the entries, with the logarithm of the frequency in the place of the phase, that takes the defect
    /// away.
    fn newton(&self, defect: &[f64]) -> Option<Vec<f64>> {
        let n = defect.len();
        let mut matrix = self.by_state.clone();
        for i in 0..n {
            matrix[(i, i)] -= 1.0;
            matrix[(i, 0)] = self.by_frequency[i];
        }
        let mut change: Vec<f64> = defect.iter().map(|d| -d).collect();
        DenseLu::factor(&matrix).ok()?.solve_in_place(&mut change);
        change.iter().all(|c| c.is_finite()).then_some(change)
    }
}

/// A whole turn beyond the frequency's own: that of a period.
pub(crate) fn period(omega: f64) -> f64 {
    TAU / omega
}

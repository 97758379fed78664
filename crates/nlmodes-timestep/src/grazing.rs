use nlmodes_contact::{LcpMatrix, balance, solver_by_name};
use nlmodes_linalg::Mat;

use crate::dynamics::STRAINLESS;
use crate::phase::Coordinates;
use crate::{ContactDynamics, ModalState, TimestepError};

/// A linear mode at the grazing amplitude, where the state of a contact is about to change and a nonlinear mode begins.
///
/// Contacts that are preloaded at rest are closed.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct GrazingState {
    /// Angular frequency of the linear mode, rad/s.
    pub omega: f64,
    /// Averaged kinetic energy, J.
    pub energy: f64,
    /// The contact that grazes.
    pub contact: usize,
    /// The state at the instant of grazing, with zero velocity.
    pub state: ModalState,
    /// Difference of `state` from static equilibrium.
    pub amplitude: Vec<f64>,
}

impl ContactDynamics {
    /// Grazing of the linear mode whose angular frequency is closest to `omega` (rad/s).
    ///
    /// # Errors
    /// [`TimestepError::NoGrazing`] if it is a rigid-body mode or does not move a contact,
    /// [`TimestepError::TouchesAtRest`] for one that it moves and that touches at rest without force.
    pub fn grazing(&mut self, omega: f64) -> Result<GrazingState, TimestepError> {
        let closed = self.closed_at_rest()?;
        let phase = self.phase(&closed)?;
        let distance = |k: &usize| (phase.omega[*k] - omega).abs();
        let nearest = (0..phase.omega.len()).min_by(|i, j| distance(i).total_cmp(&distance(j)));
        let mode = nearest.map_or(0, |k| k + 1);
        let refused = |why| TimestepError::NoGrazing { mode, why };
        let highest = phase.omega.last().copied().unwrap_or(0.0);
        let k = nearest.filter(|k| phase.omega[*k] > STRAINLESS * highest);
        let k = k.ok_or_else(|| refused("there is no such mode with a frequency"))?;
        let guards: Vec<(f64, f64)> = (0..closed.len()).map(|i| phase.guard_coefficients(i, k)).collect();
        let largest = guards.iter().fold(0.0_f64, |m, g| m.max(g.1.abs()));
        let moved = (0..closed.len()).filter(|&i| guards[i].1.abs() > 1e-9 * largest);
        let amplitude = |i: &usize| -guards[*i].0 / guards[*i].1;
        let contact = moved.min_by(|i, j| amplitude(i).abs().total_cmp(&amplitude(j).abs()));
        let contact = contact.ok_or_else(|| refused("it does not move a contact"))?;
        let found = amplitude(&contact);
        if found == 0.0 {
            return Err(TimestepError::TouchesAtRest { omega: phase.omega[k] });
        }
        let mut at = Coordinates { u: vec![0.0; phase.omega.len()], v: vec![0.0; phase.omega.len()] };
        let (rest, _) = phase.leave(&at);
        at.u[k] = found;
        let (z, v) = phase.leave(&at);
        Ok(GrazingState {
            omega: phase.omega[k],
            energy: 0.25 * (phase.omega[k] * found).powi(2),
            contact,
            amplitude: z.iter().zip(&rest).map(|(z, rest)| z - rest).collect(),
            state: ModalState { z, v },
        })
    }

    /// The contacts preloaded at rest, by their gaps or by a steady force.
    pub(crate) fn closed_at_rest(&self) -> Result<Vec<bool>, TimestepError> {
        let contacts = self.model().contacts();
        let gaps: Vec<f64> = contacts.iter().map(|c| c.gap).collect();
        let (mut closed, mut force) = (vec![false; gaps.len()], vec![0.0; gaps.len()]);
        let falls: Vec<usize> = (0..self.n_modes()).filter(|k| self.falls(*k)).collect();
        if falls.is_empty() && gaps.iter().all(|gap| *gap >= 0.0) {
            return Ok(closed);
        }
        // The whole structure deforms, not only the contact nodes.
        let compliance = self.static_compliance();
        let a = Mat::from_fn(gaps.len(), gaps.len(), |i, j| 0.5 * (compliance[(i, j)] + compliance[(j, i)]));
        if !falls.is_empty() {
            // Gaps without forces where nothing but the motions without strain is left, and by these.
            let free: Vec<f64> = (0..gaps.len()).map(|i| self.open().guard_coefficients(i, 0).0).collect();
            let felt = |k: &usize| (0..gaps.len()).any(|i| self.open().guard_coefficients(i, *k).1 != 0.0);
            let falls: Vec<usize> = falls.into_iter().filter(felt).collect();
            let row = |i: usize, r: usize| self.open().guard_coefficients(i, falls[r]).1;
            let rows = Mat::from_fn(gaps.len(), falls.len(), row);
            let push: Vec<f64> = falls.iter().map(|&k| self.open().push[k]).collect();
            return Ok(balance(&a, &rows, &free, &push, solver_by_name("active-set")?.as_ref())?.closed);
        }
        solver_by_name("active-set")?.workspace(&LcpMatrix::new(&a)?)?.solve(&gaps, &mut closed, &mut force)?;
        Ok(closed)
    }
}

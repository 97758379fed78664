use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use nlmodes_contact::{ContactBody, LcpWorkspace, solver_by_name};
use nlmodes_linalg::{DenseLu, Mat, multiply};
use nlmodes_modal::HarmonicCoefficients;
use nlmodes_model::MasslessContactModel;
use num_complex::Complex64;

use crate::error::{agrees, positive};
use crate::first_root::first_negative;
use crate::oscillation::Oscillation;
use crate::phase::{Coordinates, Phase, dot, transposed_product};
use crate::trajectory::{Segment, Trajectory};
use crate::{ModalState, TimestepError};

/// Maximum number of degrees of freedom: all modes are kept, in dense matrices.
pub const MAX_DOFS: usize = 2000;

/// Maximum number of segments between contact instants in one trajectory: each stores its modal coordinates.
const MAX_SEGMENTS: usize = 100_000;

/// Number of switchings without progress in time, per contact, after which the contact problem just ahead decides, and
/// after which the integration fails.
pub(crate) const PATIENCE: [usize; 2] = [2, 8];

/// Angular frequency over the highest one up to which a mode strains nothing.
pub(crate) const STRAINLESS: f64 = 1e-7;

/// A structure with massless contact nodes as an ordinary differential equation, propagated exactly from contact
/// instant to contact instant.
///
/// ```text
/// M_LL q̈_L + (K_LL − K_LN K_NN⁻¹ K_NL) q_L = −K_LN K_NN⁻¹ W λ(q_L)
/// 0 ≤ λ ⊥ A λ + Wᵀ b + g₀ ≥ 0 ,   b = −K_NN⁻¹ K_NL q_L
/// ```
///
/// The right-hand side is Lipschitz, and linear as long as the set of closed contacts does not change: the solution
/// then consists of cosines and sines in the modes of that set, which are computed when it first occurs and cached.
/// Contact instants are roots of gaps and forces, none of which is missed. No quantity jumps, and energy is conserved.
pub struct ContactDynamics {
    model: MasslessContactModel,
    body: ContactBody,
    open: Arc<Phase>,
    phases: HashMap<Vec<bool>, Arc<Phase>>,
    workspace: Box<dyn LcpWorkspace>,
    goes_on: Box<dyn Fn() -> bool + Send + Sync>,
}

impl fmt::Debug for ContactDynamics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ContactDynamics({} modes, {} closed sets so far)", self.n_modes(), self.phases.len())
    }
}

impl ContactDynamics {
    /// Computes the modes of the structure with all contacts open.
    ///
    /// # Errors
    /// [`TimestepError::TooLarge`]; [`TimestepError::Model`], [`TimestepError::Contact`] or [`TimestepError::Linalg`]
    /// if its matrices are unsuitable.
    pub fn new(model: MasslessContactModel) -> Result<Self, TimestepError> {
        let found = model.dofs().len();
        if found > MAX_DOFS {
            return Err(TimestepError::TooLarge { found, most: MAX_DOFS });
        }
        let body = contact_body(&model)?;
        let workspace = solver_by_name("active-set")?.workspace(body.matrix())?;
        let closed = vec![false; model.contacts().len()];
        let open = Arc::new(Phase::new(&model, &body, &closed, None)?);
        let phases = HashMap::from([(closed, Arc::clone(&open))]);
        Ok(Self { model, body, open, phases, workspace, goes_on: Box::new(|| true) })
    }

    /// Asks before each segment between contact instants whether to continue; if not, the computation ends with
    /// [`TimestepError::Ended`].
    pub fn asking(self, goes_on: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self { goes_on: Box::new(goes_on), ..self }
    }

    /// The structure.
    pub fn model(&self) -> &MasslessContactModel {
        &self.model
    }

    /// Number of modes m: degrees of freedom with mass.
    pub fn n_modes(&self) -> usize {
        self.open.lambda.len()
    }

    /// Angular eigenfrequencies of the structure with all contacts open, rad/s, m.
    pub fn omega(&self) -> &[f64] {
        &self.open.omega
    }

    /// The state with these displacements and velocities of all degrees of freedom; those of massless ones are ignored.
    ///
    /// # Errors
    /// [`TimestepError::Dimension`].
    pub fn state(&self, displacement: &[f64], velocity: &[f64]) -> Result<ModalState, TimestepError> {
        agrees("displacements", self.model.dofs().len(), displacement.len())?;
        agrees("velocities", self.model.dofs().len(), velocity.len())?;
        let project = |x: &[f64]| transposed_product(&self.open.shapes, &multiply(self.model.mass(), x));
        Ok(ModalState { z: project(displacement), v: project(velocity) })
    }

    /// The state at the phase `tau = ωt` (rad) of a periodic motion given by its Fourier coefficients, eq. (7).
    ///
    /// # Errors
    /// [`TimestepError::Dimension`] if its coordinates are not those of the structure.
    pub fn state_of_harmonics(
        &self,
        motion: &HarmonicCoefficients,
        omega: f64,
        tau: f64,
    ) -> Result<ModalState, TimestepError> {
        let n = motion.n_coordinates();
        let displacement: Vec<f64> = (0..n).map(|d| motion.value(d, tau)).collect();
        let velocity: Vec<f64> = (0..n).map(|d| omega * motion.derivative(d, tau, 1)).collect();
        self.state(&displacement, &velocity)
    }

    /// Averaged kinetic energy `¼ Σ_n (nω)² q_nᴴ M q_n` of a periodic motion given by its Fourier coefficients, J.
    ///
    /// # Errors
    /// [`TimestepError::Dimension`] if its coordinates are not those of the structure.
    pub fn averaged_kinetic_energy(&self, motion: &HarmonicCoefficients, omega: f64) -> Result<f64, TimestepError> {
        let mut energy = 0.0;
        for n in 1..=motion.n_harmonics() {
            let part = |of: fn(&Complex64) -> f64| {
                (0..motion.n_coordinates()).map(|d| of(&motion.of(d)[n])).collect::<Vec<f64>>()
            };
            let ModalState { z, v } = self.state(&part(|q| q.re), &part(|q| q.im))?;
            energy += 0.25 * (n as f64 * omega).powi(2) * (dot(&z, &z) + dot(&v, &v));
        }
        Ok(energy)
    }

    /// Displacements and velocities of all degrees of freedom.
    ///
    /// # Errors
    /// [`TimestepError::Contact`] if the contact problem has no solution there.
    pub fn displacement_and_velocity(&mut self, state: &ModalState) -> Result<(Vec<f64>, Vec<f64>), TimestepError> {
        let phase = self.phase_at(state)?;
        let at = phase.enter(&state.z, &state.v);
        Ok((phase.displacement(&at), phase.velocity(&at)))
    }

    /// Kinetic and strain energy, including that of elastic stops and of a steady force, J.
    ///
    /// # Errors
    /// [`TimestepError::Contact`] if the contact problem has no solution there.
    pub fn energy(&mut self, state: &ModalState) -> Result<f64, TimestepError> {
        let phase = self.phase_at(state)?;
        Ok(phase.energy(&phase.enter(&state.z, &state.v)))
    }

    /// Gaps per contact force at rest, with the static flexibility of all modes, c × c.
    pub(crate) fn static_compliance(&self) -> Mat<f64> {
        let a = self.body.matrix().a();
        let contacts = self.model.contacts();
        let shape = |i: usize, k: usize| contacts[i].direction() * self.open.shapes[(contacts[i].dof, k)];
        Mat::from_fn(contacts.len(), contacts.len(), |i, j| {
            let elastic = (0..self.n_modes()).filter(|k| !self.falls(*k));
            let modes = elastic.map(|k| shape(i, k) * shape(j, k) / self.open.lambda[k]);
            a[(i, j)] + modes.sum::<f64>()
        })
    }

    /// Whether a mode of the open structure is a motion without strain under a steady force.
    pub(crate) fn falls(&self, k: usize) -> bool {
        let highest = self.open.omega.last().copied().unwrap_or(0.0);
        !self.open.push.is_empty() && self.open.omega[k] <= STRAINLESS * highest
    }

    /// Energy at rest of a structure that a steady force presses onto its contacts, J: the one from which its motions
    /// are counted; zero of others.
    ///
    /// # Errors
    /// [`TimestepError::Contact`] where it does not rest.
    pub fn energy_at_rest(&mut self) -> Result<f64, TimestepError> {
        if self.open.push.is_empty() {
            return Ok(0.0);
        }
        let closed = self.closed_at_rest()?;
        Ok(self.phase(&closed)?.strain)
    }

    /// The structure with all contacts open.
    pub(crate) fn open(&self) -> &Phase {
        &self.open
    }

    /// Accelerations in modal coordinates of the open structure.
    pub(crate) fn acceleration(&mut self, state: &ModalState) -> Result<Vec<f64>, TimestepError> {
        let phase = self.phase_at(state)?;
        Ok(phase.acceleration(&phase.enter(&state.z, &state.v)))
    }

    /// The motion from `state` over `duration` (s).
    ///
    /// # Errors
    /// [`TimestepError::NotPositive`], [`TimestepError::Dimension`], [`TimestepError::Chatter`],
    /// [`TimestepError::Ended`], or errors of the modes of a new set of closed contacts.
    pub fn propagate(&mut self, state: &ModalState, duration: f64) -> Result<Trajectory, TimestepError> {
        positive("duration (s)", duration)?;
        agrees("modal coordinates", self.n_modes(), state.z.len().min(state.v.len()))?;
        if state.z.iter().chain(&state.v).any(|x| !x.is_finite()) {
            return Err(TimestepError::NotFinite { what: "state of the motion" });
        }
        let mut phase = self.phase_at(state)?;
        let (mut segments, mut from, mut idle) = (Vec::new(), 0.0, 0);
        let mut state = state.clone();
        let patience = PATIENCE.map(|p| p * phase.closed.len() + 2);
        loop {
            if !(self.goes_on)() {
                return Err(TimestepError::Ended);
            }
            let start = phase.enter(&state.z, &state.v);
            let (length, switch) = first_switch(&phase, &start, duration - from);
            let end = phase.after(&start, length);
            (state.z, state.v) = phase.leave(&end);
            let to = if switch.is_some() { from + length } else { duration };
            idle = if length > 1e-13 * duration { 0 } else { idle + 1 };
            if idle == 0 || switch.is_none() {
                segments.push(Segment { from, to, phase: Arc::clone(&phase), start });
            }
            from = to;
            if segments.len() > MAX_SEGMENTS {
                return Err(TimestepError::TooManyContacts { time: from, most: MAX_SEGMENTS });
            }
            let Some(contact) = switch else { return Ok(Trajectory { segments, end: state }) };
            if idle > patience[1] {
                return Err(TimestepError::Chatter { time: from, switches: idle });
            }
            phase = match idle > patience[0] {
                true => self.phase_ahead(&phase, &end)?,
                false => self.switched(&phase, contact)?,
            };
        }
    }

    /// The set of closed contacts with `contact` changed.
    fn switched(&mut self, phase: &Phase, contact: usize) -> Result<Arc<Phase>, TimestepError> {
        let mut closed = phase.closed.clone();
        closed[contact] = !closed[contact];
        self.phase(&closed)
    }

    /// The set of closed contacts from the contact problem for a state.
    pub(crate) fn phase_at(&mut self, state: &ModalState) -> Result<Arc<Phase>, TimestepError> {
        let free = self.free_gaps(&state.z);
        self.solve(&free)
    }

    /// The set just after the present instant, if several contacts change at once: the displacement is smooth up to its
    /// second derivative.
    fn phase_ahead(&mut self, phase: &Phase, at: &Coordinates) -> Result<Arc<Phase>, TimestepError> {
        let moment = 1e-4 / phase.omega.last().copied().unwrap_or(1.0).max(f64::MIN_POSITIVE);
        let (z, v) = phase.leave(at);
        let acceleration = phase.acceleration(at);
        let ahead = |k: usize| z[k] + moment * (v[k] + 0.5 * moment * acceleration[k]);
        let free = self.free_gaps(&(0..z.len()).map(ahead).collect::<Vec<f64>>());
        self.solve(&free)
    }

    fn free_gaps(&self, z: &[f64]) -> Vec<f64> {
        let shape = |dof: usize| (0..z.len()).map(|k| self.open.shapes[(dof, k)] * z[k]).sum::<f64>();
        self.model.contacts().iter().map(|c| c.gap + c.direction() * shape(c.dof)).collect()
    }

    fn solve(&mut self, free: &[f64]) -> Result<Arc<Phase>, TimestepError> {
        let (mut closed, mut lambda) = (vec![false; free.len()], vec![0.0; free.len()]);
        self.workspace.solve(free, &mut closed, &mut lambda)?;
        self.phase(&closed)
    }

    pub(crate) fn phase(&mut self, closed: &[bool]) -> Result<Arc<Phase>, TimestepError> {
        if let Some(phase) = self.phases.get(closed) {
            return Ok(Arc::clone(phase));
        }
        let phase = Arc::new(Phase::new(&self.model, &self.body, closed, Some(&self.open))?);
        self.phases.insert(closed.to_vec(), Arc::clone(&phase));
        Ok(phase)
    }
}

/// Length of the segment with unchanged closed contacts, at most `end`, and the contact that changes then.
fn first_switch(phase: &Phase, start: &Coordinates, end: f64) -> (f64, Option<usize>) {
    let mut guards: Vec<Oscillation> = (0..phase.closed.len()).map(|i| phase.guard(i, start)).collect();
    for (i, guard) in guards.iter_mut().enumerate() {
        let value = guard.beginning();
        if value < 0.0 {
            // After a contact instant the guard is zero to rounding; a larger value means that the set does not belong
            // to this state.
            if value < -1e-9 * guard.size() {
                return (0.0, Some(i));
            }
            guard.constant -= value;
        }
    }
    first_negative(&guards, end).map_or((end, None), |(length, i)| (length, Some(i)))
}

/// The contact nodes with the compliance `K_NN⁻¹`, and that of the stops.
pub(crate) fn contact_body(model: &MasslessContactModel) -> Result<ContactBody, TimestepError> {
    let lu = DenseLu::factor(model.k_nn()).map_err(TimestepError::during("stiffness K_NN of the contact nodes"))?;
    let gaps = model.contacts().iter().map(|c| c.gap).collect();
    let body = ContactBody::new(model.w().clone(), lu.solve_columns(model.w()), gaps)?;
    Ok(body.with_stop_compliance(&model.stop_compliance())?)
}

/// `½ vᵀv + ½ Σ ω² z²` of a difference of states: the energy norm of the open structure, squared.
pub(crate) fn energy_norm_squared(omega: &[f64], z: &[f64], v: &[f64]) -> f64 {
    0.5 * (dot(v, v) + omega.iter().zip(z).map(|(ω, z)| (ω * z).powi(2)).sum::<f64>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_energy_norm_is_half_of_the_squares_of_speeds_and_of_displacements_times_their_frequencies() {
        let found = energy_norm_squared(&[2.0, 0.0, 10.0], &[0.5, 7.0, 0.1], &[3.0, 1.0, -2.0]);
        assert!((found - 0.5 * (9.0 + 1.0 + 4.0 + 1.0 + 0.0 + 1.0)).abs() < 1e-15, "{found}");
    }
}

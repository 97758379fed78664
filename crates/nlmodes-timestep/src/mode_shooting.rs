use std::ops::{Deref, DerefMut};

use nlmodes_linalg::bilinear;
use nlmodes_modal::{HarmonicCoefficients, ModalPoint, TimeHistory};
use nlmodes_model::DofContact;
use nlmodes_model::reduction::GalerkinReduction;

use crate::error::positive;
use crate::phase::dot;
use crate::verification::{n_intervals, share};
use crate::{
    ContactDynamics, ContactState, Floquet, GrazingState, ModalState, Shooting, ShootingScales, TimestepError,
    Trajectory,
};

/// Maximum number of fixed-interface modes for a branch by shooting: the cost of a point grows with its third power.
pub const MAX_SHOOTING_MODES: usize = 200;

/// Harmonics for which the energy of a motion is resolved, whatever number of its coefficients is kept.
const MOST_HARMONICS: usize = 64;

/// The nonlinear mode of a structure by exact shooting, with its modal quantities: [`Shooting`] on a
/// [`GalerkinReduction`], starting at grazing. Its equations are a system for continuation.
#[derive(Debug)]
pub struct ModeShooting {
    structure: GalerkinReduction,
    shooting: Shooting,
    /// None where contacts touch at rest without force.
    start: Option<GrazingState>,
    harmonics: usize,
}

impl ModeShooting {
    /// The nonlinear mode that begins with the linear mode whose angular frequency is closest to that of `near`; the
    /// coefficients of its motions are computed at least up to harmonic `harmonics`. Before contacts that touch at rest
    /// without force nothing is linear: energies then count in that of `near`.
    ///
    /// # Errors
    /// [`TimestepError::TooManyModes`]; errors of [`ContactDynamics::grazing`](crate::ContactDynamics::grazing).
    pub fn new(structure: GalerkinReduction, near: ShootingScales, harmonics: usize) -> Result<Self, TimestepError> {
        if structure.n_kept_modes() > MAX_SHOOTING_MODES {
            let (found, most) = (structure.n_kept_modes(), MAX_SHOOTING_MODES);
            return Err(TimestepError::TooManyModes { found, most });
        }
        let mut dynamics = ContactDynamics::new(structure.model().clone())?;
        let (start, scales) = match dynamics.grazing(near.omega) {
            Ok(start) => {
                let scales = ShootingScales { omega: start.omega, energy: start.energy };
                (Some(start), scales)
            }
            Err(TimestepError::TouchesAtRest { omega }) => (None, ShootingScales { omega, ..near }),
            Err(error) => return Err(error),
        };
        let shooting = Shooting::new(dynamics, scales)?;
        Ok(Self { structure, shooting, start, harmonics })
    }

    /// The structure.
    pub fn structure(&self) -> &GalerkinReduction {
        &self.structure
    }

    /// `yᵀ M y` of coordinates of the reduced structure: twice the kinetic energy of velocities.
    fn inertia(&self, reduced: &[f64]) -> f64 {
        bilinear(reduced, self.structure.model().mass(), reduced)
    }

    /// Unknown vector at grazing, where the parameter is zero, and the direction of growing amplitude (m + 2); where
    /// contacts touch at rest without force nothing but the direction of growing energy.
    pub fn start(&self) -> (Vec<f64>, Vec<f64>) {
        let m = self.frequency_index();
        let unit = |n: usize, at: usize| (0..n).map(|k| f64::from(u8::from(k == at))).collect();
        self.start.as_ref().map_or_else(|| (unit(m + 1, m), unit(m + 2, m + 1)), |start| self.shooting.start(start))
    }

    /// Unknown vector and parameter of a motion of the full structure that is given by its Fourier coefficients, taken
    /// as even in time.
    ///
    /// # Errors
    /// [`TimestepError::Dimension`] if it has other coordinates than the full structure; [`TimestepError::NotPositive`]
    /// for its energy.
    pub fn unknowns(&mut self, motion: &HarmonicCoefficients, omega: f64) -> Result<(Vec<f64>, f64), TimestepError> {
        let displacement: Vec<f64> = (0..motion.n_coordinates()).map(|d| motion.value(d, 0.0)).collect();
        let reduced = self.structure.project(&displacement)?;
        let still = vec![0.0; reduced.len()];
        let state = self.shooting.dynamics().state(&reduced, &still)?;
        let mut energy = 0.0;
        for n in 1..=motion.n_harmonics() {
            let part: Vec<f64> = (0..motion.n_coordinates()).map(|d| motion.of(d)[n].re).collect();
            let y = self.structure.project(&part)?;
            energy += 0.25 * (n as f64 * omega).powi(2) * self.inertia(&y);
        }
        positive("averaged kinetic energy (J)", energy)?;
        Ok((self.shooting.unknowns(&state, omega), (energy / self.scales().energy).ln()))
    }

    /// Floquet multipliers of the motion with the unknowns `x`.
    ///
    /// # Errors
    /// Errors of [`Floquet::new`].
    pub fn floquet(&mut self, x: &[f64]) -> Result<Floquet, TimestepError> {
        let motion = self.shooting.motion(x)?;
        Floquet::new(self.shooting.dynamics(), &motion)
    }

    /// Displacements of all degrees of freedom of the full structure at the beginning of the motion with the unknowns
    /// `x`, where the velocity is zero.
    ///
    /// # Errors
    /// Errors of [`ContactDynamics::displacement_and_velocity`](crate::ContactDynamics::displacement_and_velocity).
    pub fn first_displacement(&mut self, x: &[f64]) -> Result<Vec<f64>, TimestepError> {
        let state = self.shooting.state(x);
        let (q, _) = self.shooting.dynamics().displacement_and_velocity(&state)?;
        Ok(self.structure.expand(&q))
    }

    /// The point with the unknowns `x`, as a nonlinear mode with its modal quantities.
    ///
    /// Its coefficients are exact and include all harmonics that can be resonant with a mode, at most 64 and at least
    /// the requested ones; its energies are those of the exact motion, with all harmonics.
    ///
    /// # Errors
    /// Errors of [`ContactDynamics::propagate`](crate::ContactDynamics::propagate).
    pub fn modal_point(&mut self, x: &[f64], residual: f64) -> Result<ModalPoint, TimestepError> {
        let motion = self.shooting.motion(x)?;
        let trajectory = &motion.trajectory;
        let reduced = even(trajectory.harmonics(self.highest_harmonic(motion.omega)));
        let harmonic_energy = self.harmonic_energy(&reduced, motion.omega)?;
        let coefficients = self.expand(&reduced);
        let modal_amplitude = self.inertia(&harmonic(&reduced, 1)).sqrt();
        let full = self.structure.full();
        let contact = full.contacts()[0];
        let intervals = trajectory.closed_intervals();
        let period = trajectory.duration();
        let contacts = trajectory.contact_periods(full.contacts().len());
        let touches = intervals.iter().any(|i| i.contact == 0);
        Ok(ModalPoint {
            omega: motion.omega,
            fundamental: coefficients.of(contact.dof)[1].re,
            coefficients,
            kinetic_energy: motion.kinetic_energy,
            harmonic_energy,
            total_energy: motion.total_energy,
            modal_amplitude,
            peak: match touches {
                true => contact.gap + contact.stop_compliance() * contacts[0].peak_force,
                false => contact.gap - trajectory.smallest_gap(0),
            },
            contact_fraction: share(&intervals, 0, period),
            contact_intervals: n_intervals(&intervals, contacts.len(), period),
            peak_contact_force: contacts.iter().map(|contact| contact.peak_force).fold(0.0, f64::max),
            contacts,
            residual,
            ..ModalPoint::default()
        })
    }

    /// Real amplitude of the fundamental of the first contact in the motion with the unknowns `x`, m.
    ///
    /// # Errors
    /// Errors of [`ContactDynamics::propagate`](crate::ContactDynamics::propagate).
    pub fn fundamental(&mut self, x: &[f64]) -> Result<f64, TimestepError> {
        let motion = self.shooting.motion(x)?;
        let full = self.structure.expand(&harmonic(&motion.trajectory.harmonics(1), 1));
        Ok(full[self.structure.full().contacts()[0].dof])
    }

    /// Motion and force of all contacts over one period of the motion with the unknowns `x`, at `samples` equidistant
    /// instants and the end of the period.
    ///
    /// # Errors
    /// Errors of [`ContactDynamics::propagate`](crate::ContactDynamics::propagate).
    pub fn equidistant_histories(
        &mut self,
        x: &[f64],
        samples: usize,
        label: &str,
    ) -> Result<Vec<TimeHistory>, TimestepError> {
        let trajectory = self.shooting.motion(x)?.trajectory;
        let all = 0..self.structure.full().contacts().len();
        let state = |t: f64| all.clone().map(|contact| trajectory.contact_state(contact, t)).collect();
        let instants = (0..=samples).map(|j| trajectory.duration() * j as f64 / samples as f64);
        Ok(self.histories(&trajectory, label, instants.map(|t| (t, state(t)))))
    }

    /// Motion and force of all contacts over one period of the motion with the unknowns `x`, exact at the contact
    /// instants: at each closing or opening there are two instants, a rounding error apart, with the values just before
    /// and just after; `samples + 1` instants in total, or more if needed for 64 equidistant ones.
    ///
    /// # Errors
    /// Errors of [`ContactDynamics::propagate`](crate::ContactDynamics::propagate).
    pub fn time_histories(
        &mut self,
        x: &[f64],
        samples: usize,
        label: &str,
    ) -> Result<Vec<TimeHistory>, TimestepError> {
        let trajectory = self.shooting.motion(x)?.trajectory;
        let states = trajectory.exact_states(samples, self.structure.full().contacts().len());
        Ok(self.histories(&trajectory, label, states.into_iter()))
    }

    fn histories(
        &self,
        trajectory: &Trajectory,
        label: &str,
        states: impl Iterator<Item = (f64, Vec<ContactState>)>,
    ) -> Vec<TimeHistory> {
        let contacts = self.structure.full().contacts();
        let empty = |(i, of): (usize, &DofContact)| TimeHistory {
            instants: trajectory.contact_instants(i),
            ..TimeHistory::empty(label, of.side.sign() * of.gap)
        };
        let mut histories: Vec<TimeHistory> = contacts.iter().enumerate().map(empty).collect();
        let mut last = f64::NEG_INFINITY;
        for (t, states) in states {
            last = t.max(f64::next_up(last));
            for ((history, of), state) in histories.iter_mut().zip(contacts).zip(states) {
                // Where the contact is closed, its stop is deformed by its own compliance.
                let beyond =
                    |order: usize| of.side.sign() * (of.stop_compliance() * state.force[order] - state.gap[order]);
                history.push(last, [history.stop + beyond(0), beyond(1), beyond(2)], state.force[0]);
            }
        }
        histories
    }

    /// The harmonics of a motion that can be resonant with a mode of the structure.
    fn highest_harmonic(&mut self, omega: f64) -> usize {
        let highest = self.shooting.dynamics().omega().last().copied().unwrap_or(omega);
        self.harmonics.max(((1.2 * highest / omega).ceil() as usize).min(MOST_HARMONICS))
    }

    fn harmonic_energy(&mut self, reduced: &HarmonicCoefficients, omega: f64) -> Result<Vec<f64>, TimestepError> {
        let dynamics = self.shooting.dynamics();
        let of = |n: usize| {
            let q = harmonic(reduced, n);
            let ModalState { z, .. } = dynamics.state(&q, &vec![0.0; q.len()])?;
            Ok(0.25 * (n as f64 * omega).powi(2) * dot(&z, &z))
        };
        (0..=reduced.n_harmonics()).map(of).collect()
    }

    fn expand(&self, reduced: &HarmonicCoefficients) -> HarmonicCoefficients {
        let mut all = HarmonicCoefficients::zeros(self.structure.full().dofs().len(), reduced.n_harmonics());
        for n in 0..=reduced.n_harmonics() {
            let full = self.structure.expand(&harmonic(reduced, n));
            full.iter().enumerate().for_each(|(d, q)| all.of_mut(d)[n].re = *q);
        }
        all
    }
}

/// Without the rounding errors of the sines.
fn even(mut motion: HarmonicCoefficients) -> HarmonicCoefficients {
    (0..motion.n_coordinates()).for_each(|d| motion.of_mut(d).iter_mut().for_each(|q| q.im = 0.0));
    motion
}

/// The cosines of harmonic `n`.
fn harmonic(motion: &HarmonicCoefficients, n: usize) -> Vec<f64> {
    (0..motion.n_coordinates()).map(|d| motion.of(d)[n].re).collect()
}

/// The equations.
impl Deref for ModeShooting {
    type Target = Shooting;

    fn deref(&self) -> &Shooting {
        &self.shooting
    }
}

impl DerefMut for ModeShooting {
    fn deref_mut(&mut self) -> &mut Shooting {
        &mut self.shooting
    }
}

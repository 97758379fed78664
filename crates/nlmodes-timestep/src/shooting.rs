use std::f64::consts::{PI, TAU};

use nlmodes_continuation::{Continuation, ContinuationError, Linearization, ParametricSystem, Scaling};
use nlmodes_linalg::{Mat, column};

use crate::error::positive;
use crate::phase::dot;
use crate::{ContactDynamics, GrazingState, ModalState, TimestepError, Trajectory};

/// Scales of the dimensionless unknowns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShootingScales {
    /// Angular frequency, rad/s.
    pub omega: f64,
    /// Averaged kinetic energy, J.
    pub energy: f64,
}

/// Periodic motions that are even in time, by shooting over half a period, as a system for continuation.
///
/// ```text
/// v(T/2; z(0), v(0) = 0) = 0                        m equations
/// ln(E_av/E_ref) − p = 0 ,   E_av = (1/T) ∫ ½ żᵀż dt
/// ```
///
/// Unknowns are the m coordinates `z(0)` at an instant of zero velocity, and the frequency; the motion is symmetric in
/// time about that instant, so the velocity vanishes again after half a period if and only if the motion is periodic.
/// The parameter is that of mixed shooting-harmonic balance, the logarithm of the averaged kinetic energy. The motion
/// is exact, and so is the derivative: the monodromy matrix over half a period.
///
/// Unknown vector: `max(ω_k, ω_ref) z_k / √(2 E_ref)`, then `ω/ω_ref`.
#[derive(Debug)]
pub struct Shooting {
    dynamics: ContactDynamics,
    scales: ShootingScales,
    /// `z_k` of a unit of unknown k.
    units: Vec<f64>,
    pattern: u64,
}

/// A periodic motion.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct PeriodicMotion {
    /// Angular frequency, rad/s.
    pub omega: f64,
    /// The state at the beginning, at rest for a motion found by [`Shooting`].
    pub state: ModalState,
    /// Averaged kinetic energy, J.
    pub kinetic_energy: f64,
    /// Kinetic and strain energy, J.
    pub total_energy: f64,
    /// One period.
    pub trajectory: Trajectory,
}

impl Shooting {
    /// With scales that make the unknowns of order one.
    ///
    /// # Errors
    /// [`TimestepError::NotPositive`] for a scale.
    pub fn new(dynamics: ContactDynamics, scales: ShootingScales) -> Result<Self, TimestepError> {
        let reference = positive("reference frequency (rad/s)", scales.omega)?;
        let speed = (2.0 * positive("reference energy (J)", scales.energy)?).sqrt();
        let units = dynamics.omega().iter().map(|ω| speed / ω.max(reference)).collect();
        Ok(Self { dynamics, scales, units, pattern: 0 })
    }

    /// In the scales of linear mode `mode` (from 1) at the grazing amplitude, where the nonlinear mode begins; with the
    /// unknown vector of that point, whose parameter is zero, and the direction of growing amplitude (m + 2).
    ///
    /// # Errors
    /// [`TimestepError::NoGrazing`] if there is no such mode; errors of [`ContactDynamics::grazing`].
    pub fn from_grazing(dynamics: ContactDynamics, mode: usize) -> Result<(Self, Vec<f64>, Vec<f64>), TimestepError> {
        let (mut dynamics, k) = (dynamics, mode.wrapping_sub(1));
        let Some(&omega) = dynamics.omega().get(k) else {
            return Err(TimestepError::NoGrazing { mode, why: "there is no such mode with a frequency" });
        };
        let start = dynamics.grazing(omega)?;
        let shooting = Self::new(dynamics, ShootingScales { omega: start.omega, energy: start.energy })?;
        let (x, direction) = shooting.start(&start);
        Ok((shooting, x, direction))
    }

    /// Unknown vector at grazing, and the direction of growing amplitude (m + 2).
    pub fn start(&self, grazing: &GrazingState) -> (Vec<f64>, Vec<f64>) {
        let x = self.unknowns(&grazing.state, grazing.omega);
        let grows = grazing.amplitude.iter().zip(&self.units).map(|(z, unit)| z / unit);
        // The energy is proportional to the square of the amplitude; the frequency is constant.
        let direction = grows.chain([0.0, 2.0]).collect();
        (x, direction)
    }

    /// Scales of the unknowns.
    pub fn scales(&self) -> ShootingScales {
        self.scales
    }

    /// The structure.
    pub fn dynamics(&mut self) -> &mut ContactDynamics {
        &mut self.dynamics
    }

    /// Index of the frequency in the unknown vector.
    pub fn frequency_index(&self) -> usize {
        self.units.len()
    }

    /// Angular frequency of the unknown vector `x`, rad/s.
    pub fn omega(&self, x: &[f64]) -> f64 {
        x[self.units.len()] * self.scales.omega
    }

    /// Averaged kinetic energy at the parameter `p`, J.
    pub fn energy(&self, p: f64) -> f64 {
        self.scales.energy * p.exp()
    }

    /// Unknown vector of a motion through `state`, with its velocity set to zero.
    pub fn unknowns(&self, state: &ModalState, omega: f64) -> Vec<f64> {
        state.z.iter().zip(&self.units).map(|(z, unit)| z / unit).chain([omega / self.scales.omega]).collect()
    }

    /// The state at rest from which the motion of the unknown vector `x` starts.
    pub fn state(&self, x: &[f64]) -> ModalState {
        let z: Vec<f64> = x.iter().zip(&self.units).map(|(x, unit)| x * unit).collect();
        ModalState { v: vec![0.0; z.len()], z }
    }

    /// One period of the motion of the unknown vector `x`.
    ///
    /// # Errors
    /// Errors of [`ContactDynamics::propagate`].
    pub fn motion(&mut self, x: &[f64]) -> Result<PeriodicMotion, TimestepError> {
        let (state, omega) = (self.state(x), self.omega(x));
        PeriodicMotion::new(&mut self.dynamics, state, omega)
    }

    /// The periodic motion to which Newton's method converges from the unknown vector `x` at the parameter `p`.
    ///
    /// # Errors
    /// [`TimestepError::NotConverged`], or errors of [`ContactDynamics::propagate`].
    pub fn motion_near(&mut self, x: &[f64], p: f64) -> Result<PeriodicMotion, TimestepError> {
        let mut across = vec![0.0; x.len() + 1];
        across[x.len()] = 1.0;
        match Continuation::default().first_point(self, &[x, &[p]].concat(), &across, &mut ()) {
            Ok(Some(point)) => self.motion(&point.x),
            Err(ContinuationError::System(error)) => Err(error),
            Err(ContinuationError::Start(failure)) => {
                Err(TimestepError::NotConverged { residual: failure.residual, iterations: failure.iterations })
            }
            Ok(None) | Err(_) => Err(TimestepError::NotConverged { residual: f64::NAN, iterations: 0 }),
        }
    }

    fn hash(trajectory: &Trajectory) -> u64 {
        // FNV-1a over the sequence of closed contacts.
        let bits = trajectory.segments.iter().flat_map(|s| s.phase.closed.iter().map(|c| u64::from(*c)).chain([2]));
        bits.fold(0xcbf2_9ce4_8422_2325, |hash, bit| (hash ^ bit).wrapping_mul(0x0100_0000_01b3))
    }
}

impl PeriodicMotion {
    /// One period from `state` at the frequency `omega` (rad/s), periodic or not.
    ///
    /// # Errors
    /// Errors of [`ContactDynamics::propagate`].
    pub fn new(dynamics: &mut ContactDynamics, state: ModalState, omega: f64) -> Result<Self, TimestepError> {
        let trajectory = dynamics.propagate(&state, TAU / omega)?;
        Ok(Self {
            omega,
            kinetic_energy: trajectory.kinetic_integral() * omega / TAU,
            total_energy: trajectory.energies().first().copied().unwrap_or(0.0),
            state,
            trajectory,
        })
    }
}

impl ParametricSystem for Shooting {
    type Error = TimestepError;

    fn dim(&self) -> usize {
        self.units.len() + 1
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), TimestepError> {
        let (m, omega) = (self.units.len(), positive("frequency (rad/s)", self.omega(x))?);
        let half = self.dynamics.propagate(&self.state(x), PI / omega)?;
        self.pattern = Self::hash(&half);
        let speed = (2.0 * self.scales.energy).sqrt();
        let energy = positive("averaged kinetic energy (J)", half.kinetic_integral() * omega / PI)?;
        let mut gradient = vec![0.0; m];
        let z0 = Mat::from_fn(m, m, |i, j| if i == j { self.units[j] } else { 0.0 });
        let (_, v) = half.transition(z0, Mat::zeros(m, m), |segment, u, w| {
            let (by_u, by_v): (Vec<f64>, Vec<f64>) = (0..m).map(|k| segment.kinetic_gradient(k).into()).unzip();
            for (j, gradient) in gradient.iter_mut().enumerate() {
                *gradient += dot(&by_u, column(u, j)) + dot(&by_v, column(w, j));
            }
        });
        // T/2 = π/ω
        let half_by_frequency = -PI / (omega * omega) * self.scales.omega;
        let acceleration = half.final_acceleration();
        for i in 0..m {
            out.residual[i] = half.end.v[i] / speed;
            (0..m).for_each(|j| out.jacobian[(i, j)] = v[(i, j)] / speed);
            out.jacobian[(i, m)] = acceleration[i] * half_by_frequency / speed;
            out.jacobian[(i, m + 1)] = 0.0;
        }
        out.residual[m] = (energy / self.scales.energy).ln() - p;
        (0..m).for_each(|j| out.jacobian[(m, j)] = gradient[j] * omega / (PI * energy));
        let final_power = 0.5 * dot(&half.end.v, &half.end.v) * omega / PI;
        out.jacobian[(m, m)] = self.scales.omega / omega + final_power * half_by_frequency / energy;
        out.jacobian[(m, m + 1)] = -1.0;
        Ok(())
    }

    fn scaling(&self) -> Option<Scaling> {
        Some(Scaling::unit(self.dim()))
    }

    fn pattern(&self) -> u64 {
        self.pattern
    }
}

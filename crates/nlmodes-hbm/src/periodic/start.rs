use std::f64::consts::TAU;

use nlmodes_linalg::max_norm;

use super::structure::ModalStructure;
use super::system::PeriodicSystem;
use crate::{HbmError, Scales};

/// A linear mode at the amplitude at which it just touches: where its nonlinear modes begin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModalGrazing {
    /// Number of the mode, from 1.
    pub mode: usize,
    /// Angular eigenfrequency, rad/s.
    pub omega: f64,
    /// Damping ratio; of the mode alone where damping couples modes.
    pub damping_ratio: f64,
    /// Modal amplitude, m √kg; its sign brings the contact to its stop at τ = 0.
    pub amplitude: f64,
    /// Averaged kinetic energy, J.
    pub energy: f64,
    /// The contact that grazes.
    pub contact: usize,
    /// Its amplitude, m: its gap.
    pub length: f64,
}

/// The grazing point of open mode `mode` (from 1).
///
/// # Errors
/// [`HbmError::NoSuchMode`], [`HbmError::RigidBodyMode`], [`HbmError::NeverTouches`], [`HbmError::TouchesAtRest`] or
/// [`HbmError::PressedAtRest`].
pub fn modal_grazing(structure: &ModalStructure, mode: usize) -> Result<ModalGrazing, HbmError> {
    let m = structure.n_moving();
    if mode == 0 || mode > m {
        return Err(HbmError::NoSuchMode { mode, available: m });
    }
    if let Some(contact) = structure.gaps().iter().position(|g| *g < 0.0) {
        return Err(HbmError::PressedAtRest { contact, gap: structure.gaps()[contact] });
    }
    let k = mode - 1;
    let largest = max_norm(structure.omega_squared()[..m].iter().copied());
    let square = structure.omega_squared()[k];
    if square <= 1e-12 * largest {
        let first_elastic = structure.omega_squared().iter().position(|w| *w > 1e-12 * largest).map(|k| k + 1);
        return Err(HbmError::RigidBodyMode { mode, first_elastic });
    }
    let omega = square.sqrt();
    let row = |i: usize| structure.rows()[(i, k)];
    let moving = (0..structure.n_contacts()).filter(|&i| row(i) != 0.0);
    let first = moving.map(|i| (i, structure.gaps()[i] / row(i).abs())).min_by(|a, b| a.1.total_cmp(&b.1));
    let (contact, amplitude) = first.ok_or(HbmError::NeverTouches { mode, frequency_hz: omega / TAU, ratio: 0.0 })?;
    if amplitude <= 0.0 {
        return Err(HbmError::TouchesAtRest { contact, gap: structure.gaps()[contact] });
    }
    Ok(ModalGrazing {
        mode,
        omega,
        damping_ratio: structure.damping().entry(k, k) / (2.0 * omega),
        amplitude: -amplitude * row(contact).signum(),
        energy: 0.25 * square * amplitude * amplitude,
        contact,
        length: structure.gaps()[contact],
    })
}

impl ModalGrazing {
    /// Scales with which the problem has numbers near one.
    pub fn scales(&self) -> Scales {
        Scales { length: self.length, omega: self.omega, energy: self.energy }
    }

    /// Unknowns of a conservative or damped mode at grazing, where the parameter is zero. They are exact where damping
    /// couples no modes, else a guess.
    pub fn unknowns(&self, system: &PeriodicSystem) -> Vec<f64> {
        let mut x = self.cosines(system);
        let scales = system.scales;
        let extra = system.closing.n_unknowns();
        x.push(self.omega / scales.omega);
        if extra > 1 {
            let damped = !system.structure.damping().is_none();
            x.push(if damped { 2.0 * self.damping_ratio * self.omega / scales.omega } else { 0.0 });
        }
        x
    }

    /// Direction of growing amplitude for the unknowns and the parameter.
    pub fn direction(&self, system: &PeriodicSystem) -> Vec<f64> {
        let mut t = self.cosines(system);
        t.resize(t.len() + system.closing.n_unknowns(), 0.0);
        t.push(2.0);
        t
    }

    fn cosines(&self, system: &PeriodicSystem) -> Vec<f64> {
        let (k, unit) = (self.mode - 1, system.unit());
        let width = system.series().width();
        let mut x = vec![0.0; system.n_coefficients()];
        for (j, share) in system.response.of_mode(k).into_iter().enumerate() {
            x[j * width + 1] = share * self.amplitude / unit;
        }
        x
    }
}

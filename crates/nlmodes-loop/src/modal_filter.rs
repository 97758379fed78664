use num_complex::Complex64;

use crate::PhaseLoopError;
use crate::error::{finite, positive};

/// Most motion sensors of the control of harmonics.
pub const MAX_SENSORS: usize = 32;
/// Most linear modes that they tell apart.
pub const MAX_MODES: usize = 16;

/// Linear modes at the motion sensors: rows of `Φ⁺`, by which the displacements at the sensors become modal
/// coordinates, and what the damping of each mode takes.
///
/// ```text
/// η_k = Σ_d Φ⁺_kd x_d ,   xᴴ C x = Σ_k 2 ζ_k ω_k |η_k|²
/// ```
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModalFilter {
    sensors: usize,
    modes: usize,
    rows: [[f64; MAX_SENSORS]; MAX_MODES],
    /// `2 ζ_k ω_k`, 1/s.
    losses: [f64; MAX_MODES],
}

impl ModalFilter {
    /// No modes at no sensors.
    pub(crate) const NONE: Self =
        Self { sensors: 0, modes: 0, rows: [[0.0; MAX_SENSORS]; MAX_MODES], losses: [0.0; MAX_MODES] };

    /// No modes yet, at this number of sensors.
    ///
    /// # Errors
    /// [`PhaseLoopError::TooMany`].
    pub fn new(sensors: usize) -> Result<Self, PhaseLoopError> {
        if sensors > MAX_SENSORS {
            return Err(PhaseLoopError::TooMany { what: "motion sensors", given: sensors, most: MAX_SENSORS });
        }
        Ok(Self { sensors, ..Self::NONE })
    }

    /// The same with another mode: `row` has one entry a sensor, √kg; frequency in rad/s.
    ///
    /// # Errors
    /// [`PhaseLoopError::TooMany`], [`PhaseLoopError::Sensors`] for a row of another length, and unsuitable numbers.
    pub fn with_mode(mut self, row: &[f64], omega: f64, damping_ratio: f64) -> Result<Self, PhaseLoopError> {
        let too_many = PhaseLoopError::TooMany { what: "linear modes", given: self.modes + 1, most: MAX_MODES };
        if row.len() != self.sensors {
            return Err(PhaseLoopError::Sensors { sensors: self.sensors, expected: row.len(), drive: 0 });
        }
        for entry in row {
            finite("row of the modal filter (√kg)", *entry)?;
        }
        positive("frequency of a linear mode (rad/s)", omega)?;
        finite("damping ratio of a linear mode", damping_ratio)?;
        let (Some(mine), Some(loss)) = (self.rows.get_mut(self.modes), self.losses.get_mut(self.modes)) else {
            return Err(too_many);
        };
        mine.iter_mut().zip(row).for_each(|(mine, given)| *mine = *given);
        *loss = 2.0 * damping_ratio * omega;
        self.modes += 1;
        Ok(self)
    }

    /// Number of sensors.
    pub fn sensors(&self) -> usize {
        self.sensors
    }

    /// `xᴴ C x` of the displacements at the sensors, kg·m²/s.
    pub fn damping_form(&self, motion: &[Complex64]) -> f64 {
        let coordinate = |row: &[f64; MAX_SENSORS]| -> Complex64 {
            motion.iter().take(self.sensors).zip(row).map(|(x, entry)| x * entry).sum()
        };
        let of = |(row, loss): (&[f64; MAX_SENSORS], &f64)| loss * coordinate(row).norm_sqr();
        self.rows.iter().zip(&self.losses).take(self.modes).map(of).sum()
    }
}

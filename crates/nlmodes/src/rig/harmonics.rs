use std::f64::consts::PI;

use nlmodes_experiment::phase_loop::{
    AppropriationSettings, ForceAppropriation, LoopSettings, MAX_HARMONICS, ModalFilter, PhaseLoopError,
    ResponseQuantity,
};
use nlmodes_experiment::records::Quantity;
use nlmodes_modal::LinearModes;
use num_complex::Complex64;

use crate::rig::{RigError, RigSetup};

/// The harmonics of the force that are controlled beyond the first.
///
/// The control law is that of [`ForceAppropriation`]: each harmonic supplies the power dissipated by the damping of the
/// linear modes.
#[derive(Debug, Clone, PartialEq)]
pub struct ControlledHarmonics {
    /// The highest, from 2 on.
    pub harmonics: usize,
    /// Linear modes at motion sensors, with damping ratios.
    pub modes: LinearModes,
    /// Channels of these sensors, one per coordinate of the modes.
    pub channels: Vec<usize>,
    /// Index of the drive point among these coordinates.
    pub drive: usize,
}

/// Amplitude of the tones with which the answer of the force is measured, relative to the level.
pub(crate) const TONE: f64 = 0.1;
/// Number of time constants after which the detectors have settled.
const WAIT: f64 = 20.0;

/// Settling time of the detectors, s.
pub(crate) fn wait(pll: &LoopSettings) -> f64 {
    WAIT / pll.cut_off
}

/// The controller with this answer of the force to the drive, or with a placeholder until it is measured.
pub(crate) fn appropriation(
    rig: &RigSetup,
    pll: &LoopSettings,
    wanted: &ControlledHarmonics,
    transfer: Option<&[Complex64]>,
) -> Result<ForceAppropriation, RigError> {
    let quantities = wanted.channels.iter().map(|&channel| quantity(rig, channel)).collect::<Result<Vec<_>, _>>()?;
    let (modes, interval) = (modal_filter(&wanted.modes)?, rig.interval);
    let (harmonic, omega) = (MAX_HARMONICS, pll.range[1]);
    let limit = PI / (harmonic as f64 * omega);
    if interval >= limit {
        // Harmonics above the Nyquist frequency would be aliased.
        return Err(PhaseLoopError::AboveNyquist { harmonic, omega, limit }.into());
    }
    let settings =
        AppropriationSettings::new(wanted.harmonics, modes, &quantities, wanted.drive, interval, pll.cut_off)?;
    let unknown = vec![Complex64::ONE; wanted.harmonics.saturating_sub(1)];
    Ok(ForceAppropriation::new(settings, transfer.unwrap_or(&unknown))?)
}

/// Rows of `Φ⁺`: the modal coordinates of a displacement of one at each sensor in turn.
fn modal_filter(modes: &LinearModes) -> Result<ModalFilter, PhaseLoopError> {
    let sensors = modes.n_coordinates();
    let unit = |at: usize| (0..sensors).map(|d| f64::from(u8::from(d == at)).into()).collect::<Vec<Complex64>>();
    let columns: Vec<Vec<Complex64>> = (0..sensors).map(|at| modes.project(&unit(at))).collect();
    let figures = modes.omegas().iter().zip(modes.damping_ratios());
    figures.enumerate().try_fold(ModalFilter::new(sensors)?, |filter, (k, (omega, damping_ratio))| {
        let row: Vec<f64> = columns.iter().map(|column| column[k].re).collect();
        filter.with_mode(&row, *omega, *damping_ratio)
    })
}

/// Quantity of the sensor of this channel, if it is a motion.
fn quantity(rig: &RigSetup, channel: usize) -> Result<ResponseQuantity, RigError> {
    let missing = RigError::NoChannel { channel, channels: rig.sensors.len() };
    let sensor = rig.sensors.get(channel).ok_or(missing)?;
    match sensor.place.quantity() {
        Quantity::Displacement => Ok(ResponseQuantity::Displacement),
        Quantity::Velocity => Ok(ResponseQuantity::Velocity),
        Quantity::Acceleration => Ok(ResponseQuantity::Acceleration),
        other => {
            let (sensor, found) = (sensor.name.clone(), other.si_unit());
            Err(RigError::ResponseQuantity { sensor, expected: "a motion", found })
        }
    }
}

use std::f64::consts::PI;

use nlmodes_experiment::phase_loop::{
    AppropriationSettings, AppropriationState, ForceAppropriation, LoopSettings, MAX_HARMONICS, ModalFilter,
    PhaseLoopError, ResponseQuantity,
};
use nlmodes_experiment::records::Quantity;
use nlmodes_modal::LinearModes;
use num_complex::Complex64;

use crate::{Drive, RigError, VirtualRig};

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

/// The controller of a session, with its state.
#[derive(Debug, Clone)]
pub(crate) struct HarmonicControl {
    control: ForceAppropriation,
    pub(crate) state: AppropriationState,
    channels: Vec<usize>,
    motions: Vec<f64>,
    /// Sum of the errors of the harmonics, and the number of samples.
    missing: Vec<Complex64>,
    samples: usize,
}

impl HarmonicControl {
    /// Amplitude of the tones used to measure the transfer function of the force, relative to the level.
    pub(crate) const TONE: f64 = 0.1;
    /// Number of time constants after which the detector has settled.
    const WAIT: f64 = 20.0;

    /// A controller with this transfer function from drive to force, or with a placeholder until it is measured.
    pub(crate) fn new(
        rig: &VirtualRig,
        pll: &LoopSettings,
        wanted: &ControlledHarmonics,
        transfer: Option<&[Complex64]>,
    ) -> Result<Self, RigError> {
        let quantities =
            wanted.channels.iter().map(|&channel| quantity(rig, channel)).collect::<Result<Vec<_>, _>>()?;
        let (modes, interval) = (modal_filter(&wanted.modes)?, rig.setup().interval);
        let (harmonic, omega) = (MAX_HARMONICS, pll.range[1]);
        let limit = PI / (harmonic as f64 * omega);
        if interval >= limit {
            // Harmonics above the Nyquist frequency would be aliased.
            return Err(PhaseLoopError::AboveNyquist { harmonic, omega, limit }.into());
        }
        let settings =
            AppropriationSettings::new(wanted.harmonics, modes, &quantities, wanted.drive, interval, pll.cut_off)?;
        let unknown = vec![Complex64::ONE; wanted.harmonics.saturating_sub(1)];
        let control = ForceAppropriation::new(settings, transfer.unwrap_or(&unknown))?;
        let (state, motions) = (control.start(), vec![0.0; wanted.channels.len()]);
        let missing = vec![Complex64::ZERO; wanted.harmonics];
        Ok(Self { control, state, channels: wanted.channels.clone(), motions, missing, samples: 0 })
    }

    /// Settling time of the detectors, s.
    pub(crate) fn wait(&self) -> f64 {
        Self::WAIT / self.control.settings().cut_off
    }

    /// Processes the samples of this interval and adds its harmonics to the drive.
    pub(crate) fn step(
        &mut self,
        drive: &mut Drive,
        force: f64,
        read: &mut dyn FnMut(usize) -> Result<f64, RigError>,
    ) -> Result<(), RigError> {
        for (motion, &channel) in self.motions.iter_mut().zip(&self.channels) {
            *motion = read(channel)?;
        }
        let put = |into: &mut [Complex64], state: &AppropriationState| {
            into.iter_mut().zip(state.drive()).skip(1).for_each(|(mine, u)| *mine = *u);
        };
        put(&mut drive.amplitudes[0], &self.state);
        self.control.step(&mut self.state, drive.phase, drive.omega, force, &self.motions);
        put(&mut drive.amplitudes[1], &self.state);
        let off = self.state.wanted().iter().zip(self.state.force()).map(|(wanted, force)| wanted - force);
        self.missing.iter_mut().zip(off).for_each(|(sum, off)| *sum += off);
        self.samples += 1;
        Ok(())
    }

    /// Mean error of each harmonic relative to the fundamental, since the last call.
    pub(crate) fn take_off(&mut self) -> Vec<f64> {
        let size = self.state.force()[0].norm() * std::mem::take(&mut self.samples) as f64;
        self.missing.iter_mut().map(|sum| std::mem::take(sum).norm() / size).collect()
    }
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
fn quantity(rig: &VirtualRig, channel: usize) -> Result<ResponseQuantity, RigError> {
    let found = rig.channel(channel)?;
    match found.quantity {
        Quantity::Displacement => Ok(ResponseQuantity::Displacement),
        Quantity::Velocity => Ok(ResponseQuantity::Velocity),
        Quantity::Acceleration => Ok(ResponseQuantity::Acceleration),
        other => Err(RigError::ResponseQuantity { sensor: found.name, expected: "a motion", found: other.si_unit() }),
    }
}

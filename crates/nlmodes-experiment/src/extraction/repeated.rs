//! Values of all periods with those of single ones: what they scatter, and what the sampling rate leaves open.

use nlmodes_modal::LinearModes;

use crate::extraction::blocks::Blocks;
use crate::extraction::values::{Method, Values};
use crate::extraction::{ExcitationFigures, ExtractionError, Measured, ModalFigures, ModeErrors};

use num_complex::Complex64;

/// Values of one record.
#[derive(Debug)]
pub struct Repeated {
    pub all: Values,
    single: Vec<Values>,
    /// What noise adds to the power that damping ratios dissipate, W.
    by_noise: f64,
    /// The values where one of the errors that all periods share is as large as its standard error.
    shifted: Vec<Values>,
    /// By how much noise makes the apparent power seem larger.
    apparent: f64,
}

/// Standard error of the sampling rate, relative: its error is anywhere within the bound.
pub fn rate_deviation(rate_error: f64) -> f64 {
    rate_error / 3f64.sqrt()
}

/// Relative standard errors that all periods have in common.
#[derive(Debug)]
pub struct CommonErrors {
    /// Of the frequency, that of the sampling rate included.
    pub omega: f64,
    /// Of the sensitivity of each channel.
    pub channels: Vec<f64>,
    /// Of the shape of the excited mode at each position.
    pub shape: f64,
    /// Of what missing modes add to the motion.
    pub missing: f64,
}

impl CommonErrors {
    /// The values with each of them as large as its standard error.
    fn shifted(&self, method: &Method<'_>, all: &[Vec<Complex64>]) -> Result<Vec<Values>, ExtractionError> {
        let mut shifted = Vec::new();
        if self.omega > 0.0 {
            // Coefficients belong to phases, not to times: another frequency changes the derivatives, nothing else.
            shifted.push(Method { omega: method.omega * (1.0 + self.omega), ..method.clone() }.values(all)?);
        }
        for (i, error) in self.channels.iter().enumerate().filter(|(_, error)| **error > 0.0) {
            let mut coefficients = all.to_vec();
            coefficients[i].iter_mut().for_each(|q| *q *= 1.0 + error);
            shifted.push(method.values(&coefficients)?);
        }
        if let Some(missing) = &method.missing {
            let missing = Some(missing.larger_by(self.missing));
            shifted.push(Method { missing, ..method.clone() }.values(all)?);
        }
        for modes in method.modes.iter().filter(|_| self.shape > 0.0) {
            for row in 0..modes.n_coordinates() {
                let Some(modes) = bent(modes, row, method.mode, self.shape) else { continue };
                shifted.push(Method { modes: Some(modes), ..method.clone() }.values(all)?);
            }
        }
        Ok(shifted)
    }
}

/// Modes whose entry of one of them in a row is larger by a share.
fn bent(modes: &LinearModes, row: usize, mode: usize, share: f64) -> Option<LinearModes> {
    let entry = |d: usize, k: usize| modes.shape(d, k) * if (d, k) == (row, mode) { 1.0 + share } else { 1.0 };
    let shapes: Vec<Vec<f64>> =
        (0..modes.n_coordinates()).map(|d| (0..modes.n_modes()).map(|k| entry(d, k)).collect()).collect();
    LinearModes::new(modes.positions(), modes.omegas(), modes.damping_ratios(), &shapes).ok()
}

impl Repeated {
    /// Evaluates the coefficients of all periods and of single ones, with what errors common to all of them do; of so
    /// many samples.
    pub fn new(
        method: &Method<'_>,
        blocks: &Blocks,
        errors: &CommonErrors,
        n_samples: usize,
    ) -> Result<Self, ExtractionError> {
        let by_noise = method.dissipated_by_noise(n_samples);
        let apparent = method.apparent_by_noise(&blocks.all, n_samples);
        let single = blocks.single.iter().map(|q| method.values(q)).collect::<Result<_, _>>()?;
        let shifted = errors.shifted(method, &blocks.all)?;
        Ok(Self { all: method.values(&blocks.all)?, single, by_noise, shifted, apparent })
    }

    /// A figure with its uncertainty.
    pub fn measured(&self, of: impl Fn(&Values) -> Option<f64>) -> Option<Measured> {
        let repeated: Vec<f64> = self.single.iter().filter_map(&of).collect();
        let measured = Measured::new(of(&self.all)?, &repeated);
        let shifts = self.shifted.iter().filter_map(&of).map(|shifted| shifted - measured.value);
        Some(measured.and(shifts.map(|shift| shift * shift).sum::<f64>().sqrt()))
    }

    /// The figures of the excitation.
    pub fn excitation(&self) -> Option<ExcitationFigures> {
        let lags: Vec<f64> = self.single.iter().filter_map(|values| values.lag).collect();
        Some(ExcitationFigures {
            power: self.all.power?,
            fundamental_power: self.measured(|f| Some(f.power?.fundamental))?,
            total_power: self.measured(|f| Some(f.power?.active))?,
            pbmif: self.indicator()?,
            force: self.measured(|f| f.force)?,
            drive: self.measured(|f| f.drive)?,
            lag: Measured::angle(self.all.lag?, &lags),
            modal_lag: self.modal_lag(),
            phase_indicator: self.measured(|f| f.phase_indicator),
        })
    }

    /// Lag of the coordinate of the mode.
    fn modal_lag(&self) -> Option<Measured> {
        let lags: Vec<f64> = self.single.iter().filter_map(|values| values.modal_lag).collect();
        Some(Measured::angle(self.all.modal_lag?, &lags))
    }

    /// The mode indicator without what noise adds to the apparent power.
    fn indicator(&self) -> Option<Measured> {
        let measured = self.measured(|f| Some(f.power?.indicator()))?;
        let value = (measured.value * self.apparent).clamp(-1.0, 1.0);
        Some(Measured { value, ..measured })
    }

    /// The power of the force that the damping ratios do not take, which have their own errors.
    fn contact_dissipation(&self, errors: ModeErrors) -> Option<Measured> {
        let lost = |f: &Values| Some(f.power?.active - f.modal.as_ref()?.dissipated);
        let taken = self.all.modal.as_ref()?.dissipated - self.by_noise;
        let measured = self.measured(lost)?;
        let of_modes = taken * errors.damping.hypot(2.0 * errors.shape);
        Some(Measured { value: measured.value + self.by_noise, ..measured }.and(of_modes))
    }

    /// The modal figures.
    pub fn modal(&self, modes: Option<&LinearModes>, errors: ModeErrors) -> Option<ModalFigures> {
        let (modal, modes) = (self.all.modal.as_ref()?, modes?);
        let factor = |k: usize| self.measured(move |f| Some(f.modal.as_ref()?.participation.factors[k]));
        let of_harmonic = |n: usize| self.measured(move |f| f.modal.as_ref()?.dissipation.coefficients.get(n).copied());
        let harmonic_damping = (0..modal.dissipation.coefficients.len()).filter_map(of_harmonic).collect();
        let spreads = (0..modes.n_modes()).map(|k| factor(k).map_or(f64::NAN, |factor| factor.uncertainty));
        Some(ModalFigures {
            amplitude: self.measured(|f| Some(f.modal.as_ref()?.shape.modal_amplitude))?,
            shape: modal.shape.clone(),
            participation: modal.participation.clone(),
            participation_uncertainty: spreads.collect(),
            damping: self.measured(|f| f.modal.as_ref()?.damping),
            dissipation: modal.dissipation.clone(),
            harmonic_damping,
            contact_dissipation: self.contact_dissipation(errors),
            kinetic_energy: self.measured(|f| Some(f.modal.as_ref()?.harmonic_energy.iter().sum()))?,
            harmonic_energy: modal.harmonic_energy.clone(),
        })
    }
}

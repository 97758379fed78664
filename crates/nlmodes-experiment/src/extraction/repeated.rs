//! Values of all periods with those of single ones: what they scatter, and what the sampling rate leaves open.

use nlmodes_modal::{LinearDissipation, LinearModes};

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
    /// The values at a frequency that is higher by the standard error of the sampling rate, where that has one.
    stretched: Option<Values>,
}

/// Standard error of the sampling rate, relative: its error is anywhere within the bound.
pub fn rate_deviation(rate_error: f64) -> f64 {
    rate_error / 3f64.sqrt()
}

impl Repeated {
    /// Evaluates the coefficients of all periods and of single ones; `rate_error` is the bound of the sampling rate's
    /// relative error, beside the number of samples.
    pub fn new(
        method: &Method<'_>,
        all: &[Vec<Complex64>],
        single: &[Vec<Vec<Complex64>>],
        (rate_error, n_samples): (f64, usize),
    ) -> Result<Self, ExtractionError> {
        let by_noise = method.dissipated_by_noise(n_samples);
        // Coefficients belong to phases, not to times: another sampling rate changes the frequency at which they are
        // taken, nothing else.
        let stretched = Method { omega: method.omega * (1.0 + rate_deviation(rate_error)), ..method.clone() };
        let stretched = (rate_error > 0.0).then(|| stretched.values(all)).transpose()?;
        let single = single.iter().map(|q| method.values(q)).collect::<Result<_, _>>()?;
        Ok(Self { all: method.values(all)?, single, by_noise, stretched })
    }

    /// A figure with its uncertainty.
    pub fn measured(&self, of: impl Fn(&Values) -> Option<f64>) -> Option<Measured> {
        let repeated: Vec<f64> = self.single.iter().filter_map(&of).collect();
        let measured = Measured::new(of(&self.all)?, &repeated);
        let rate = self.stretched.as_ref().and_then(&of).map_or(0.0, |stretched| stretched - measured.value);
        Some(measured.and(rate))
    }

    /// The figures of the excitation.
    pub fn excitation(&self) -> Option<ExcitationFigures> {
        let lags: Vec<f64> = self.single.iter().filter_map(|values| values.lag).collect();
        Some(ExcitationFigures {
            power: self.all.power?,
            fundamental_power: self.measured(|f| Some(f.power?.fundamental))?,
            total_power: self.measured(|f| Some(f.power?.active))?,
            pbmif: self.measured(|f| Some(f.power?.indicator()))?,
            force: self.measured(|f| f.force)?,
            lag: Measured::angle(self.all.lag?, &lags),
        })
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
    pub fn modal(&self, modes: Option<&LinearModes>, errors: ModeErrors, omega: f64) -> Option<ModalFigures> {
        let (modal, modes) = (self.all.modal.as_ref()?, modes?);
        let factor = |k: usize| self.measured(move |f| Some(f.modal.as_ref()?.participation.factors[k]));
        let spreads = (0..modes.n_modes()).map(|k| factor(k).map_or(f64::NAN, |factor| factor.uncertainty));
        Some(ModalFigures {
            amplitude: self.measured(|f| Some(f.modal.as_ref()?.shape.modal_amplitude))?,
            shape: modal.shape.clone(),
            participation: modal.participation.clone(),
            participation_uncertainty: spreads.collect(),
            damping: self.measured(|f| f.modal.as_ref()?.damping),
            dissipation: LinearDissipation::new(modes, &modal.coordinates, omega),
            contact_dissipation: self.contact_dissipation(errors),
            kinetic_energy: self.measured(|f| Some(f.modal.as_ref()?.harmonic_energy.iter().sum()))?,
            harmonic_energy: modal.harmonic_energy.clone(),
        })
    }
}

//! The periods of a record that are looked at.

use crate::extraction::frequency::{from_phase, refine};
use crate::extraction::guess::strongest_frequency;
use crate::extraction::layout::Layout;
use crate::extraction::{ExtractionError, ExtractionSettings, Finding, Measured};
use crate::records::Record;

/// Fewest periods from which anything is extracted.
pub const FEWEST_PERIODS: usize = 2;
/// Harmonics by which the frequency is found.
const FREQUENCY_HARMONICS: usize = 40;

/// A whole number of periods at the end of a record.
#[derive(Debug, Clone, Copy)]
pub struct Window {
    /// First sample.
    pub first: usize,
    /// Number of samples, the nearest one to a whole number of periods.
    pub n_samples: usize,
    /// Number of periods.
    pub periods: usize,
    /// Frequency, rad/s.
    pub omega: f64,
    /// Frequency of the phase channel with its standard error, where that was taken.
    pub from_phase: Option<Measured>,
}

impl Window {
    /// Samples of a channel in the window.
    pub fn of<'a>(&self, samples: &'a [f64]) -> &'a [f64] {
        &samples[self.first..self.first + self.n_samples]
    }

    /// Highest harmonic that the sampling rate carries: its mirror image about half the rate must be told apart from
    /// it.
    pub fn nyquist_harmonics(&self, sample_rate: f64) -> usize {
        let half = 0.5 * sample_rate * std::f64::consts::TAU / self.omega;
        (half - 0.75 / self.periods as f64).max(0.0) as usize
    }
}

/// Finds the frequency, and the window that the settings ask for.
pub fn choose(
    record: &Record,
    layout: &Layout,
    settings: &ExtractionSettings,
    findings: &mut Vec<Finding>,
) -> Result<Window, ExtractionError> {
    let rate = record.sample_rate;
    let refuse =
        |finding, others: &[Finding]| ExtractionError::Refused { finding: Box::new(finding), others: others.to_vec() };
    let Some(reference) = layout.reference else {
        let consequence = "no usable channel measures a motion".into();
        return Err(refuse(Finding::ChannelMissing { channel: "response".into(), consequence }, findings));
    };
    let (name, samples) = (&record.channels[reference].name, &record.samples[reference][..record.n_samples()]);
    let guess = guess(record, layout, settings, samples)?;
    let periods = record.duration() * guess / std::f64::consts::TAU;
    // A guess from the spectrum of so short a record is itself good to a tenth of a period.
    if periods < FEWEST_PERIODS as f64 - 0.25 {
        return Err(refuse(Finding::TooShort { periods, wanted: FEWEST_PERIODS }, findings));
    }
    let lost = || ExtractionError::NoFrequency { guess_hz: guess / std::f64::consts::TAU, channel: name.clone() };
    let harmonics = |omega: f64| ((0.45 * rate * std::f64::consts::TAU / omega) as usize).min(FREQUENCY_HARMONICS);
    let find = |samples: &[f64], start: f64| {
        refine(samples, start / rate, harmonics(start).min(samples.len() / 8)).map(|step| step * rate)
    };
    // A record whose frequency changes has no common one: its last periods may.
    let omega = find(samples, guess).unwrap_or(guess);
    let periods = record.duration() * omega / std::f64::consts::TAU;
    // The last sample of a record of whole periods stands one interval before their end.
    let whole = (periods + 1e-6 + 0.5 * omega / rate / std::f64::consts::TAU) as usize;
    let wanted = settings.periods.unwrap_or(whole).max(FEWEST_PERIODS);
    if whole < FEWEST_PERIODS {
        return Err(refuse(Finding::TooShort { periods, wanted: FEWEST_PERIODS }, findings));
    }
    if whole < wanted {
        findings.push(Finding::TooShort { periods, wanted });
    }
    let periods = whole.min(wanted);
    let n_samples = ((periods as f64 * std::f64::consts::TAU * rate / omega).round() as usize).min(samples.len());
    let first = samples.len() - n_samples;
    let omega = find(&samples[first..], omega).ok_or_else(lost)?;
    let mut window = Window { first, n_samples, periods, omega, from_phase: None };
    if let Some(phase) = layout.phase.filter(|_| settings.frequency_from_phase) {
        let channel = &record.channels[phase].name;
        window.from_phase = Some(from_phase(window.of(&record.samples[phase]), rate, channel)?);
    }
    Ok(window)
}

/// First guess of the frequency, rad/s: given, or of the phase channel, or the strongest line of the reference.
fn guess(
    record: &Record,
    layout: &Layout,
    settings: &ExtractionSettings,
    reference: &[f64],
) -> Result<f64, ExtractionError> {
    if let Some(omega) = settings.omega {
        return Ok(omega);
    }
    if let Some(phase) = layout.phase {
        let channel = &record.channels[phase];
        return Ok(from_phase(&record.samples[phase], record.sample_rate, &channel.name)?.value);
    }
    let channel = layout.reference.map_or_else(String::new, |i| record.channels[i].name.clone());
    let found = strongest_frequency(reference).ok_or(ExtractionError::NoFrequency { guess_hz: 0.0, channel })?;
    Ok(found * record.sample_rate * std::f64::consts::TAU)
}

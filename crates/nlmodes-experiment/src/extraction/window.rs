//! The periods of a record that are looked at.

use std::f64::consts::TAU;
use std::ops::Range;

use crate::extraction::frequency::{from_phase, refine};
use crate::extraction::guess::Spectrum;
use crate::extraction::layout::Layout;
use crate::extraction::measured::spread;
use crate::extraction::{ExtractionError, ExtractionSettings, Finding, Measured, loss};
use crate::records::Record;

/// Fewest periods from which anything is extracted.
pub const FEWEST_PERIODS: usize = 2;
/// Harmonics by which the frequency is found.
pub const FREQUENCY_HARMONICS: usize = 40;
/// Factor about a given guess within which the frequency is searched.
const AROUND: f64 = 1.2;
/// Factor about the frequency of the linear mode within which that of its nonlinear mode is searched first.
const FAR: f64 = 3.0;
/// Samples of an interval of a long record by which its frequency is first guessed.
const STRETCH: usize = 1 << 18;
/// Most places at which lost samples are looked for.
const MAX_LOSSES: usize = 4;

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

    /// Highest harmonic that the sampling rate carries: its mirror image about half the rate must be distinguished from
    /// it.
    pub fn nyquist_harmonics(&self, sample_rate: f64) -> usize {
        let half = 0.5 * sample_rate * TAU / self.omega;
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
    let reference = layout.motion(findings)?;
    let (rate, samples) = (record.sample_rate, &record.samples[reference][..record.n_samples()]);
    let guess = guess(record, layout, settings, reference)?;
    let periods = record.duration() * guess / TAU;
    // A guess from the spectrum of so short a record is itself good to a tenth of a period.
    if periods < FEWEST_PERIODS as f64 - 0.25 {
        return Err(refuse(Finding::TooShort { periods, wanted: FEWEST_PERIODS }, findings));
    }
    let name = || record.channels[reference].name.clone();
    let lost = || ExtractionError::NoFrequency { guess_hz: guess / TAU, channel: name() };
    // A record whose frequency changes has no common one: its last periods may.
    let stretch = liveliest(samples);
    let nearer = if stretch.len() < samples.len() { find(&samples[stretch], guess, rate) } else { None };
    let guess = nearer.unwrap_or(guess);
    let omega = find(samples, guess, rate).unwrap_or(guess);
    let other = layout.other_signal(record).map(|other| &other[..samples.len()]);
    let sound = without_losses((samples, other), &name(), omega / rate, findings);
    let samples = &samples[sound.clone()];
    let omega = find(samples, omega, rate).unwrap_or(omega);
    let periods = samples.len() as f64 / rate * omega / TAU;
    // The last sample of a record of whole periods is one interval before their end.
    let whole = (periods + 1e-6 + 0.5 * omega / rate / TAU) as usize;
    let wanted = settings.periods.unwrap_or(whole).max(FEWEST_PERIODS);
    if whole < FEWEST_PERIODS {
        return Err(refuse(Finding::TooShort { periods, wanted: FEWEST_PERIODS }, findings));
    }
    if whole < wanted {
        findings.push(Finding::TooShort { periods, wanted });
    }
    let periods = whole.min(wanted);
    let n_samples = ((periods as f64 * TAU * rate / omega).round() as usize).min(samples.len());
    let first = samples.len() - n_samples;
    let omega = find(&samples[first..], omega, rate).ok_or_else(lost)?;
    let mut window = Window { first: sound.start + first, n_samples, periods, omega, from_phase: None };
    if let Some(phase) = layout.phase.filter(|_| settings.frequency_from_phase) {
        let channel = &record.channels[phase].name;
        window.from_phase = Some(from_phase(window.of(&record.samples[phase]), rate, channel)?);
    }
    Ok(window)
}

pub(super) fn refuse(finding: Finding, others: &[Finding]) -> ExtractionError {
    ExtractionError::Refused { finding: Box::new(finding), others: others.to_vec() }
}

/// The frequency (rad/s) next to a start by which the samples are most periodic.
fn find(samples: &[f64], start: f64, rate: f64) -> Option<f64> {
    let harmonics = ((0.45 * rate * TAU / start) as usize).min(FREQUENCY_HARMONICS);
    refine(samples, start / rate, harmonics.min(samples.len() / 8)).map(|step| step * rate)
}

/// The longest part of the samples in which none are lost; reports each loss. `step` is the advance of the phase (rad)
/// from sample to sample.
///
/// Beside the samples, those of another channel, which tell whether the first one has lost some alone.
fn without_losses(
    (samples, other): (&[f64], Option<&[f64]>),
    name: &str,
    step: f64,
    findings: &mut Vec<Finding>,
) -> Range<usize> {
    let mut sound = 0..samples.len();
    for _ in 0..MAX_LOSSES {
        let Some(found) = loss::find(&samples[sound.clone()], step) else { break };
        let place = sound.start + found.place.start..sound.start + found.place.end;
        let is_alone = other.is_some_and(|other| {
            let near = |loss: &loss::Loss| loss.place.start < found.place.end && found.place.start < loss.place.end;
            !loss::find(&other[sound.clone()], step).is_some_and(|loss| near(&loss))
        });
        findings.push(Finding::LostSamples {
            channel: is_alone.then(|| name.to_owned()),
            samples: found.samples,
            from: place.start,
            to: place.end,
        });
        let (before, after) = (sound.start..place.start, place.end..sound.end);
        sound = if before.len() > after.len() { before } else { after };
    }
    sound
}

/// The part of a long record with the largest scatter, for a first guess; all of a shorter one.
fn liveliest(samples: &[f64]) -> Range<usize> {
    let n = samples.len();
    if n < 2 * STRETCH {
        return 0..n;
    }
    let of = |k: usize| k * STRETCH..(k + 1) * STRETCH;
    let scatter = |k: &usize| spread(&samples[of(*k)]);
    // The last one where all are alike.
    (0..n / STRETCH).max_by(|a, b| scatter(a).total_cmp(&scatter(b))).map_or(0..n, of)
}

/// First guess of the frequency, rad/s: the peak next to the given one, or that of the phase channel, or the strongest
/// line of the reference.
pub fn guess(
    record: &Record,
    layout: &Layout,
    settings: &ExtractionSettings,
    reference: usize,
) -> Result<f64, ExtractionError> {
    if let Some(phase) = layout.phase.filter(|_| settings.omega.is_none()) {
        let channel = &record.channels[phase];
        return Ok(from_phase(&record.samples[phase], record.sample_rate, &channel.name)?.value);
    }
    let stretch = liveliest(&record.samples[reference][..record.n_samples()]);
    let spectrum = |i: usize| Spectrum::new(&record.samples[i][stretch.clone()]);
    let channel = &record.channels[reference];
    let lost = || ExtractionError::NoFrequency { guess_hz: 0.0, channel: channel.name.clone() };
    let own = match (spectrum(reference), settings.omega) {
        (Some(own), _) => own,
        (None, Some(omega)) => return Ok(omega),
        (None, None) => return Err(lost()),
    };
    let order = channel.quantity.time_derivative().unwrap_or(0);
    let per_sample = |omega: f64| omega / TAU / record.sample_rate;
    let between = |omega: f64, share: f64| own.lines(per_sample(omega / share), per_sample(omega * share));
    let force = layout.force.and_then(spectrum);
    if let Some(omega) = settings.omega {
        let near = own.peak(between(omega, AROUND), order, Some(force.as_ref().unwrap_or(&own)));
        return Ok(near.map_or(omega, |found| found * record.sample_rate * TAU));
    }
    let mode = settings.linear_modes.as_ref().and_then(|modes| modes.omegas().get(settings.mode - 1));
    let among = |lines: Range<usize>| {
        let with_force = own.peak(lines.clone(), order, Some(force.as_ref().unwrap_or(&own)));
        with_force.or_else(|| own.peak(lines, order, Some(&own)))
    };
    let near_mode = mode.and_then(|omega| among(between(*omega, FAR)));
    let anywhere = || among(own.all()).or_else(|| own.peak(own.all(), 0, None));
    let found = near_mode.or_else(anywhere).ok_or_else(lost)?;
    Ok(found * record.sample_rate * TAU)
}

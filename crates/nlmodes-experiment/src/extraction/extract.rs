use std::f64::consts::TAU;

use num_complex::Complex64;

use crate::extraction::blocks::{Blocks, take_out_delay};
use crate::extraction::contact::Evidence;
use crate::extraction::drift::Drift;
use crate::extraction::force_balance::ForceBalance;
use crate::extraction::guess::strongest_frequency;
use crate::extraction::judgement::Judgement;
use crate::extraction::layout::{Layout, Place, modes_at, row_at};
use crate::extraction::measured::spread;
use crate::extraction::missing::Missing;
use crate::extraction::repeated::{CommonErrors, Repeated, rate_deviation};
use crate::extraction::values::Method;
use crate::extraction::window::Window;
use crate::extraction::{
    BalanceFigures, ExcitationFigures, ExtractionError, ExtractionSettings, Finding, HarmonicFit, Measured,
    RecordExtraction, clipping, loss, quality, window,
};
use crate::records::{Channel, Record, Role};

/// Most harmonics that are fitted, and most that "all" means for the mode indicator, unless more are asked for: the
/// time grows with their third power.
const MAX_HARMONICS: usize = 1000;
/// Most samples from which the contact is evaluated, sample by sample and impact by impact: the last ones.
const CONTACT_SAMPLES: usize = 1 << 19;
/// Lag at phase resonance, degrees.
const RESONANCE_DEG: f64 = 90.0;
/// Scatter of the fundamental from period to period, over its size, from which on a vibration has no frequency.
const SCATTERED: f64 = 0.25;
/// Share of the fundamental that that of each period has at least where its phase is looked at.
const STEADY: f64 = 0.5;
/// Standard errors by which the two frequencies must differ to be reported.
const SIGNIFICANT: f64 = 5.0;

/// Turns a record into a point of a nonlinear mode.
///
/// Frequency: from the excitation phase where there is such a channel, else from the record itself. Fourier
/// coefficients: least squares on all harmonics over a whole number of periods at the end of the record, velocity and
/// acceleration integrated in the frequency domain. Modal amplitude, shape, participation and damping: eqs. (20)-(22),
/// (28), (30), normalised by mass through the linear modes. Power: eqs. (17)-(19). Every figure has the standard error
/// of the mean of its values in single periods, with what the sampling rate leaves open.
///
/// # Errors
/// [`ExtractionError`] if no frequency is found, or with the finding that prevents it. Findings that do not are in the
/// result.
pub fn extract(record: &Record, settings: &ExtractionSettings) -> Result<RecordExtraction, ExtractionError> {
    check(settings)?;
    let mut findings = Vec::new();
    quality::missing(record, &mut findings);
    let usable = quality::usable(record, &mut findings);
    let found = analysed(record, settings, &usable, findings.clone())?;
    if let Some(found) = beside_loss(record, settings, &usable, &found, &findings) {
        return Ok(found);
    }
    if let Some(found) = turned(record, settings, &usable, &found, &findings) {
        return Ok(found);
    }
    let (rest, mut culprits) = without_culprits(record, &usable, &found);
    if culprits.is_empty() {
        return Ok(found);
    }
    let Ok(mut found) = analysed(record, settings, &rest, findings) else { return Ok(found) };
    culprits.retain(|culprit| !found.findings.contains(culprit));
    found.findings.extend(culprits);
    Ok(found)
}

/// The analysis of the usable channels, with what was found before.
fn analysed(
    record: &Record,
    settings: &ExtractionSettings,
    usable: &[bool],
    mut findings: Vec<Finding>,
) -> Result<RecordExtraction, ExtractionError> {
    let layout = Layout::new(record, usable);
    quality::roles(&layout, settings.stop.is_some(), &mut findings);
    quality::unused(record, &layout, usable, &mut findings);
    let window = window::choose(record, &layout, settings, &mut findings)?;
    Analysis { record, settings, layout, window }.run(findings)
}

/// The analysis of the longer part beside the samples that a channel lost alone: behind them it is early by their
/// number against the others, which is set right.
fn beside_loss(
    record: &Record,
    settings: &ExtractionSettings,
    usable: &[bool],
    found: &RecordExtraction,
    before: &[Finding],
) -> Option<RecordExtraction> {
    let of_channel = |finding: &&Finding| matches!(finding, Finding::LostSamples { channel: Some(_), .. });
    let finding = found.findings.iter().find(of_channel)?;
    let Finding::LostSamples { channel: Some(channel), samples, from, to } = finding else { return None };
    let n = record.n_samples();
    let part = |samples: &[f64], range: std::ops::Range<usize>| samples[range.start..range.end].to_vec();
    let cut = |(channel_of, own): (&Channel, &Vec<f64>)| {
        if *from >= n.saturating_sub(*to) {
            return part(own, 0..*from);
        }
        let lost = if channel_of.name == *channel { *samples as isize } else { 0 };
        let kept = n - to - samples.abs() as usize;
        let start = to.saturating_add(samples.abs() as usize).saturating_add_signed(-lost);
        part(own, start.min(n - kept)..start.min(n - kept) + kept)
    };
    if *samples == 0.0 || *to + 2 * samples.abs() as usize >= n {
        return None;
    }
    let samples = record.channels.iter().zip(&record.samples).map(cut).collect();
    let part = Record { samples, ..record.clone() };
    let mut kept = analysed(&part, settings, usable, before.to_vec()).ok()?;
    kept.findings.push(finding.clone());
    Some(kept)
}

/// The analysis without the one of two channels at the drive point that is reversed, where the responses do not tell
/// which: the force brings in power with the other one, and takes it out with this one.
fn turned(
    record: &Record,
    settings: &ExtractionSettings,
    usable: &[bool],
    found: &RecordExtraction,
    before: &[Finding],
) -> Option<RecordExtraction> {
    let is_turned = |finding: &&Finding| match finding {
        Finding::ReversedChannel { alternatives, .. } => !alternatives.is_empty(),
        _ => false,
    };
    let Finding::ReversedChannel { channel, against, .. } = found.findings.iter().find(is_turned)? else {
        return None;
    };
    let own = record.channels.iter().position(|other| other.name == *channel)?;
    let is_twin = |i: &usize| {
        let (a, b) = (&record.channels[own], &record.channels[*i]);
        *i != own && usable[*i] && b.role == Role::DrivePoint && a.role == b.role && a.position == b.position
    };
    let twins: Vec<usize> = (0..usable.len()).filter(is_twin).collect();
    let [twin] = twins[..] else { return None };
    let without = |i: usize| {
        let rest: Vec<bool> = usable.iter().enumerate().map(|(j, usable)| *usable && j != i).collect();
        analysed(record, settings, &rest, before.to_vec()).ok()
    };
    let power = |found: &RecordExtraction| Some(found.excitation.as_ref()?.fundamental_power.value);
    let (with_twin, with_own) = (without(own)?, without(twin)?);
    let (mut kept, culprit) = match (power(&with_twin)? > 0.0, power(&with_own)? > 0.0) {
        (true, false) => (with_twin, own),
        (false, true) => (with_own, twin),
        _ => return None,
    };
    let channel = record.channels[culprit].name.clone();
    kept.findings.push(Finding::ReversedChannel { channel, against: against.clone(), alternatives: vec![] });
    Some(kept)
}

/// Relative standard error of the frequency; that of the sampling rate where there are too few periods for one.
fn omega_error(omega: &Measured, rate_error: f64) -> f64 {
    let error = omega.uncertainty / omega.value;
    if error.is_finite() { error } else { rate_deviation(rate_error) }
}

/// Which channels are left without those that were found reversed, exchanged, clipped or of a wrong scale, and the
/// findings that say so. A channel stays that is alone at the drive point or at the stop, and so do two that explain a
/// slip as well as each other.
fn without_culprits(record: &Record, usable: &[bool], found: &RecordExtraction) -> (Vec<bool>, Vec<Finding>) {
    let mut rest = usable.to_vec();
    let mut culprits = Vec::new();
    for finding in &found.findings {
        let names: &[String] = match finding {
            Finding::ReversedChannel { channel, alternatives, .. }
            | Finding::WrongScale { channel, alternatives, .. }
                if alternatives.is_empty() =>
            {
                std::slice::from_ref(channel)
            }
            Finding::Clipped { channel, .. } => std::slice::from_ref(channel),
            Finding::ExchangedChannels { channels } => channels,
            _ => continue,
        };
        let at: Vec<usize> = (0..rest.len()).filter(|i| names.contains(&record.channels[*i].name)).collect();
        if at.iter().all(|i| may_leave(record, &rest, *i)) && !at.is_empty() {
            at.iter().for_each(|i| rest[*i] = false);
            culprits.push(finding.clone());
        }
    }
    (rest, culprits)
}

/// Whether a response is one of several, and not alone where it is needed.
fn may_leave(record: &Record, usable: &[bool], channel: usize) -> bool {
    let own = &record.channels[channel];
    let others = || {
        let motions = |i: &usize| usable[*i] && record.channels[*i].quantity.time_derivative().is_some();
        (0..usable.len()).filter(motions).filter(|i| *i != channel).map(|i| &record.channels[i])
    };
    let neighbour = others().any(|other| other.position == own.position);
    let needed = own.role == Role::DrivePoint
        || record.with_role(Role::Contact).any(|i| record.channels[i].position == own.position);
    own.quantity.time_derivative().is_some() && others().count() >= 2 && (neighbour || !needed)
}

fn check(settings: &ExtractionSettings) -> Result<(), ExtractionError> {
    let modes = settings.linear_modes.as_ref().map_or(usize::MAX, |modes| modes.n_modes());
    let checks = [
        ("harmonics", settings.harmonics as f64, settings.harmonics > 0, "1 or more"),
        (
            "pbmif_harmonics",
            settings.pbmif_harmonics.unwrap_or(1) as f64,
            settings.pbmif_harmonics != Some(0),
            "1 or more",
        ),
        ("mode", settings.mode as f64, (1..=modes).contains(&settings.mode), "the number of a linear mode, from 1"),
        (
            "omega",
            settings.omega.unwrap_or(1.0),
            settings.omega.is_none_or(|omega| omega > 0.0 && omega.is_finite()),
            "a positive frequency, rad/s",
        ),
    ];
    match checks.into_iter().find(|(_, _, sound, _)| !sound) {
        Some((setting, value, _, expected)) => Err(ExtractionError::Setting { setting, value, expected }),
        None => Ok(()),
    }
}

struct Analysis<'a> {
    record: &'a Record,
    settings: &'a ExtractionSettings,
    layout: Layout,
    window: Window,
}

impl Analysis<'_> {
    fn run(mut self, mut findings: Vec<Finding>) -> Result<RecordExtraction, ExtractionError> {
        let (harmonics, power_harmonics, fitted) = self.harmonics(&mut findings);
        let record_omega = self.window.omega;
        let omega = self.window.from_phase.map_or(record_omega, |phase| phase.value);
        let fit = HarmonicFit::new(fitted, omega / self.record.sample_rate, self.window.n_samples)?;
        let blocks = self.blocks(&fit, &self.window, omega);
        self.clipping(&mut findings);
        self.aperiodic(&fit, &blocks, &mut findings);
        quality::sample_rate(self.record, &self.settings.tolerances, &mut findings);
        quality::silent(self.record, &mut self.layout, &blocks, (omega, self.window.n_samples), &mut findings);
        self.losses(&blocks, omega, &mut findings);
        let drift = self.drift(&blocks, omega, &mut findings);
        if drift.scatter > SCATTERED {
            let finding = Box::new(Finding::NotPeriodic { scatter: drift.scatter });
            return Err(ExtractionError::Refused { finding, others: findings });
        }
        let omega = self.frequency(&drift, omega, record_omega, &mut findings);
        let (modes, shape_places) = self.modes(&mut findings)?;
        let missing = self.missing(modes.as_ref(), &shape_places);
        let method = Method {
            layout: &self.layout,
            shape_places,
            modes,
            missing,
            mode: self.settings.mode - 1,
            omega: omega.value,
            noise: &blocks.noise,
            harmonics,
            power_harmonics,
        };
        let repeated = Repeated::new(&method, &blocks, &self.common_errors(&omega), self.window.n_samples)?;
        let window = Window { omega: omega.value, ..self.window };
        let recent = self.recent(&window, fitted)?;
        let (at_contact, fit, of_contact) =
            recent.as_ref().map_or((&window, &fit, &blocks), |(window, fit, blocks)| (window, fit, blocks));
        let evidence = Evidence {
            record: self.record,
            layout: &self.layout,
            window: at_contact,
            fit,
            blocks: of_contact,
            steady: !drift.is_drifting(&self.settings.tolerances, omega.value),
            periodic: !findings.iter().any(|finding| matches!(finding, Finding::Aperiodic { .. })),
        };
        let contact = evidence.figures(self.settings.stop.as_ref(), &mut findings);
        let (excitation, modal) =
            (repeated.excitation(), repeated.modal(method.modes.as_ref(), self.settings.mode_errors));
        let judgement = Judgement {
            record: self.record,
            settings: self.settings,
            layout: &self.layout,
            window: &window,
            method: &method,
            blocks: &blocks,
            values: &repeated.all,
        };
        self.excitation_findings(excitation.as_ref(), &mut findings);
        let damping = modal.as_ref().and_then(|modal| Some(modal.damping?.value));
        let before = findings.len();
        drift.transient(omega.value, damping, &self.settings.tolerances, &mut findings);
        let steady = findings.len() == before;
        if judgement.responses(&mut findings) {
            // A force is judged by a motion that is sound and steady.
            if steady {
                let power = excitation.as_ref().map(|excitation| excitation.fundamental_power);
                judgement.forces(power, contact.as_ref(), &mut findings);
            }
            judgement.gap(contact.as_ref(), &mut findings);
        }
        // What does not reach the stop has no force there, and a wrong force none that is left of it.
        let may_touch = self.settings.stop.is_some_and(|stop| judgement.may_reach(&stop));
        let is_forced = !findings.iter().any(|finding| {
            let force = self.layout.force.map(|i| self.record.channels[i].name.as_str());
            matches!(finding, Finding::ReversedForce { .. }) || force.is_some_and(|force| finding.spoils(force))
        });
        let balance = (evidence.periodic && may_touch && is_forced)
            .then(|| self.balance(&method, &blocks, omega.value))
            .flatten();
        if let Some((contact, balance)) = contact.as_ref().zip(balance.as_ref()) {
            judgement.cell(contact, balance, &mut findings);
        }
        Ok(RecordExtraction {
            record: self.record.name.clone(),
            omega,
            periods: self.window.periods,
            harmonics,
            positions: method.shape_places.iter().filter_map(|place| place.position).collect(),
            modal,
            motion: repeated.all.motion,
            excitation,
            contact,
            balance,
            findings,
        })
    }

    /// The modes that the places do not tell apart, where the forces that drive them are known.
    fn missing(&self, modes: Option<&nlmodes_modal::LinearModes>, places: &[Place]) -> Option<Missing> {
        let (given, known) = (self.settings.linear_modes.as_ref()?, modes?.n_modes());
        let row = |position: f64| row_at(given.positions(), position);
        let rows = places.iter().map(|place| row(place.position?)).collect::<Option<Vec<_>>>()?;
        let force = self.layout.force?;
        let drive = row(self.record.channels[force].position.or(self.layout.drive.as_ref()?.position)?)?;
        let stop = match (self.settings.stop, self.layout.contact) {
            (Some(stop), Some(contact)) => Some((row(stop.position)?, contact, if stop.positive { 1.0 } else { -1.0 })),
            // A stop whose force is not known drives them, too.
            (Some(_), None) => return None,
            (None, _) => None,
        };
        (known < given.n_modes()).then(|| Missing::new(given, known, &rows, (drive, force), stop))
    }

    /// The contact without its force, where the modes are known at the stop and where the force acts.
    fn balance(&self, method: &Method<'_>, blocks: &Blocks, omega: f64) -> Option<BalanceFigures> {
        let (modes, stop) = (self.settings.linear_modes.as_ref()?, self.settings.stop?);
        let row = |position: f64| row_at(modes.positions(), position);
        let rows = method.shape_places.iter().map(|place| row(place.position?)).collect::<Option<Vec<_>>>()?;
        let at_force = |i: usize| self.record.channels[i].position.or(self.layout.drive.as_ref()?.position);
        let drive = match self.layout.force {
            Some(channel) => Some((row(at_force(channel)?)?, channel)),
            None => None,
        };
        ForceBalance {
            modes,
            errors: self.settings.mode_errors,
            sensors: self.record.channels.iter().map(|channel| channel.uncertainty.unwrap_or(0.0)).collect(),
            places: &method.shape_places,
            rows,
            drive,
            stop: row(stop.position)?,
            settings: stop,
            blocks,
            omega,
            n_samples: self.window.n_samples,
        }
        .figures()
    }

    /// Harmonics of the shape, of the power, and of the fit.
    fn harmonics(&self, findings: &mut Vec<Finding>) -> (usize, usize, usize) {
        // The fit has as many unknowns as two for each harmonic and one for the mean.
        let limit = self.window.nyquist_harmonics(self.record.sample_rate).min((self.window.n_samples - 1) / 2).max(1);
        let mut within = |wanted: usize| {
            if wanted > limit {
                findings.push(Finding::AboveNyquist { wanted, used: limit });
            }
            wanted.min(limit)
        };
        let harmonics = within(self.settings.harmonics);
        let power = self.settings.pbmif_harmonics.map_or(limit.min(MAX_HARMONICS), &mut within);
        (harmonics, power, limit.min(MAX_HARMONICS).max(harmonics).max(power))
    }

    /// The last periods of a long record, from which the contact is evaluated sample by sample; `None` of a shorter
    /// one.
    fn recent(&self, window: &Window, fitted: usize) -> Result<Option<(Window, HarmonicFit, Blocks)>, ExtractionError> {
        if self.layout.contact.is_none() || window.n_samples <= CONTACT_SAMPLES {
            return Ok(None);
        }
        let step = window.omega / self.record.sample_rate;
        let periods = ((CONTACT_SAMPLES as f64 * step / TAU) as usize).max(window::FEWEST_PERIODS);
        let n_samples = ((periods as f64 * TAU / step).round() as usize).min(window.n_samples);
        let first = window.first + window.n_samples - n_samples;
        let recent = Window { first, n_samples, periods, ..*window };
        let fit = HarmonicFit::new(fitted, step, n_samples)?;
        let blocks = self.blocks(&fit, &recent, window.omega);
        Ok(Some((recent, fit, blocks)))
    }

    fn blocks(&self, fit: &HarmonicFit, window: &Window, omega: f64) -> Blocks {
        let unusable = vec![0.0; window.n_samples];
        let taken = |i: usize| {
            let samples = window.of(&self.record.samples[i]);
            if samples.iter().all(|x| x.is_finite()) && Some(i) != self.layout.phase { samples } else { &unusable }
        };
        let signals: Vec<&[f64]> = (0..self.record.channels.len()).map(taken).collect();
        let mut blocks = Blocks::new(fit, &signals, window.periods, self.record.sample_rate);
        for (i, channel) in self.record.channels.iter().enumerate().filter(|(_, channel)| channel.delay != 0.0) {
            take_out_delay(&mut blocks.all[i], omega, channel.delay);
            blocks.single.iter_mut().for_each(|q| take_out_delay(&mut q[i], omega, channel.delay));
        }
        blocks
    }

    fn clipping(&self, findings: &mut Vec<Finding>) {
        let per_period = self.window.n_samples as f64 / self.window.periods as f64;
        for (i, channel) in self.record.channels.iter().enumerate().filter(|(i, _)| Some(*i) != self.layout.phase) {
            clipping::check(channel, self.window.of(&self.record.samples[i]), per_period, findings);
        }
    }

    fn aperiodic(&self, fit: &HarmonicFit, blocks: &Blocks, findings: &mut Vec<Finding>) {
        let mut judged: Vec<usize> = self.layout.reference.into_iter().chain(self.layout.force).collect();
        judged.dedup();
        for i in judged {
            let signal = self.window.of(&self.record.samples[i]);
            let ratio = blocks.rest[i] / spread(signal);
            if ratio > self.settings.tolerances.aperiodic {
                // A channel with a delay has other coefficients by now.
                let own = fit.coefficients(&[signal]);
                let rest = fit.rest(signal, &own[0]);
                let strongest_hz = strongest_frequency(&rest).unwrap_or(f64::NAN) * self.record.sample_rate;
                let channel = self.record.channels[i].name.clone();
                findings.push(Finding::Aperiodic { channel, ratio, strongest_hz });
            }
        }
    }

    /// Errors that all periods share.
    fn common_errors(&self, omega: &Measured) -> CommonErrors {
        CommonErrors {
            omega: omega_error(omega, self.record.rate_error),
            channels: self.record.channels.iter().map(|channel| channel.uncertainty.unwrap_or(0.0)).collect(),
            shape: self.settings.shape_error,
            // Two entries of a shape over the square of a frequency.
            missing: {
                let errors = self.settings.mode_errors;
                (std::f64::consts::SQRT_2 * errors.shape).hypot(2.0 * errors.frequency)
            },
        }
    }

    /// Reports channels that lost samples alone: their phase steps, that of the reference does not.
    fn losses(&self, blocks: &Blocks, omega: f64, findings: &mut Vec<Finding>) {
        let n = blocks.single.len();
        let step = omega / self.record.sample_rate;
        let edge = |k: usize| self.window.first + (k * self.window.n_samples).div_euclid(n.max(1));
        for i in (0..self.record.channels.len()).filter(|i| self.layout.takes_part(*i)) {
            let size = |q: &Vec<Vec<Complex64>>| q[i].get(1).map_or(0.0, |q| q.norm());
            // A fundamental in noise has no phase.
            if blocks.single.iter().any(|q| size(q) < STEADY * size(&blocks.all)) {
                continue;
            }
            let phases = loss::unwrapped(blocks.single.iter().map(|q| q[i][1].arg()));
            let Some((k, samples)) = loss::in_phases(&phases, step) else { continue };
            let (from, to) = (edge(k.saturating_sub(1)), edge((k + 2).min(n)));
            let channel = Some(self.record.channels[i].name.clone());
            findings.push(Finding::LostSamples { channel, samples, from, to });
        }
    }

    /// The reference over the periods; reports where it drifts.
    fn drift(&self, blocks: &Blocks, omega: f64, findings: &mut Vec<Finding>) -> Drift {
        let none = [Complex64::default(); 2];
        let of = |q: &'_ [Vec<Complex64>]| -> Vec<Complex64> {
            let harmonics = |i: usize| q[i][..q[i].len().min(window::FREQUENCY_HARMONICS + 1)].to_vec();
            self.layout.reference.map_or_else(|| none.to_vec(), harmonics)
        };
        let single: Vec<Vec<Complex64>> = blocks.single.iter().map(|q| of(q)).collect();
        let single: Vec<&[Complex64]> = single.iter().map(Vec::as_slice).collect();
        let drift = Drift::new(&of(&blocks.all), &single, &blocks.centres);
        drift.report(omega, &self.settings.tolerances, findings);
        drift
    }

    /// The frequency with its standard error; reports a phase channel that runs at another frequency.
    fn frequency(&self, drift: &Drift, omega: f64, record_omega: f64, findings: &mut Vec<Finding>) -> Measured {
        let rate = omega * rate_deviation(self.record.rate_error);
        let Some(phase) = self.window.from_phase else {
            return Measured { value: omega, uncertainty: drift.omega_error }.and(rate);
        };
        let error = drift.omega_error.hypot(phase.uncertainty);
        let limit = (self.settings.tolerances.frequency_drift * omega).max(SIGNIFICANT * error);
        if (phase.value - record_omega).abs() > limit {
            let [phase_hz, record_hz] = [phase.value, record_omega].map(|omega| omega / TAU);
            findings.push(Finding::FrequencyDisagrees { phase_hz, record_hz });
        }
        Measured { value: omega, uncertainty: phase.uncertainty }.and(rate)
    }

    fn modes(
        &self,
        findings: &mut Vec<Finding>,
    ) -> Result<(Option<nlmodes_modal::LinearModes>, Vec<Place>), ExtractionError> {
        let places = &self.layout.places;
        let Some(given) = &self.settings.linear_modes else { return Ok((None, places.clone())) };
        match modes_at(given, places, &self.record.channels, findings) {
            Some((modes, at)) if self.settings.mode <= modes.n_modes() => {
                Ok((Some(modes), at.into_iter().map(|k| places[k].clone()).collect()))
            }
            _ => Ok((None, places.clone())),
        }
    }

    fn excitation_findings(&self, excitation: Option<&ExcitationFigures>, findings: &mut Vec<Finding>) {
        let Some(excitation) = excitation else { return };
        let tolerances = &self.settings.tolerances;
        let lag_deg = excitation.lag.value.to_degrees();
        if excitation.power.fundamental_factor() < tolerances.reversed {
            let (pbmif, harmonics) = (excitation.pbmif.value, excitation.power.harmonics);
            findings.push(Finding::ReversedForce { pbmif, harmonics });
        } else if (lag_deg - RESONANCE_DEG).abs() > tolerances.lag_deg {
            findings.push(Finding::NotLocked { lag_deg, target_deg: RESONANCE_DEG });
        }
    }
}

//! Free decay: frequency and damping of a mode over its amplitude, from the vibration after the drive is switched off.
//!
//! ```text
//! ω = dφ/dt ,   D = −(1/2ω) d ln J/dt ,   J = 2 E_kin/ω ,   E_kin = ¼ Σ_n (nω)² ‖η_n‖²
//! ```
//!
//! `J` is the action of a slow decay: `dE/dt = ω dJ/dt` whatever potential the contact has, so that `D` is the damping
//! ratio of the damped mode, `P/(4 ω E_kin)`, without the strain energy. For a linear mode it is that of its amplitude.

use std::f64::consts::TAU;
use std::ops::Range;

use nlmodes_modal::{LinearModes, noise_level};
use num_complex::Complex64;

use crate::extraction::layout::{Layout, Place, displacement, modes_at};
use crate::extraction::loss::least_squares;
use crate::extraction::measured::wrapped;
use crate::extraction::{ExtractionError, ExtractionSettings, Finding, HarmonicFit, Measured, quality, window};
use crate::records::Record;

/// Periods of a block.
const PERIODS: f64 = 3.0;
/// Blocks on either side of one over which its slopes are taken.
const BESIDE: usize = 3;
/// Error of a block's amplitude, relative, at which the decay ends in noise.
const NOISE: f64 = 0.01;
/// Share of its largest scatter below which the force is off.
const OFF: f64 = 0.05;

/// A free decay.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FreeDecay {
    /// From where on the vibration is free, s on the time axis of the record.
    pub from: f64,
    /// The points, in the order of time.
    pub points: Vec<DecayPoint>,
}

/// A point of a free decay.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct DecayPoint {
    /// Instant, s on the time axis of the record.
    pub time: f64,
    /// Frequency, rad/s.
    pub omega: Measured,
    /// Modal amplitude, m·√kg; without linear modes the amplitude of the displacement that determines the frequency.
    pub amplitude: Measured,
    /// Damping ratio.
    pub damping: Measured,
}

/// What a block of periods shows.
#[derive(Debug, Clone, Copy)]
struct Block {
    /// Middle, s from the first sample.
    time: f64,
    /// Phase, without jumps.
    phase: f64,
    /// Amplitude of the fundamental.
    amplitude: f64,
    /// `Σ n² ‖η_n‖²`.
    square: f64,
    /// Standard error of phase (rad) and amplitude (relative) by noise.
    error: f64,
}

/// The coordinates that are followed.
struct Followed<'a> {
    record: &'a Record,
    noise: Vec<f64>,
    /// Modes with the places of their rows, and the number of the one that is excited.
    modes: Option<(LinearModes, Vec<Place>, usize)>,
    reference: usize,
}

/// Follows the free vibration from `from` to `to` (s on the time axis of the record): by default from where the force
/// is off to the end, or to where noise ends it.
///
/// # Errors
/// [`ExtractionError`] without a motion or a frequency; [`Finding::TooShort`] where fewer than seven blocks of three
/// periods are left, which give one point.
pub fn free_decay(
    record: &Record,
    settings: &ExtractionSettings,
    from: Option<f64>,
    to: Option<f64>,
) -> Result<FreeDecay, ExtractionError> {
    let mut findings = Vec::new();
    let usable = quality::usable(record, &mut findings);
    let layout = Layout::new(record, &usable);
    let reference = layout.motion(&findings)?;
    let omega = window::guess(record, &layout, settings, reference)?;
    let modes = settings.linear_modes.as_ref().and_then(|modes| {
        let (modes, at) = modes_at(modes, &layout.places, &record.channels, &mut findings)?;
        let places = at.into_iter().map(|k| layout.places[k].clone()).collect();
        Some((modes, places, settings.mode - 1)).filter(|(modes, _, mode)| *mode < modes.n_modes())
    });
    let noise = record.samples.iter().map(|x| noise_level(x).max(f64::MIN_POSITIVE.sqrt())).collect();
    let index = |t: f64| ((t - record.start) * record.sample_rate).round().max(0.0) as usize;
    let first = from.map_or_else(|| released(record, &layout, omega), index);
    let range = first.min(record.n_samples())..to.map_or(record.n_samples(), index).min(record.n_samples());
    let followed = Followed { record, noise, modes, reference };
    let blocks = followed.blocks(range, omega)?;
    let wanted = 2 * BESIDE + 1;
    if blocks.len() < wanted {
        let (periods, wanted) = (PERIODS * blocks.len() as f64, (PERIODS * wanted as f64) as usize);
        return Err(window::refuse(Finding::TooShort { periods, wanted }, &findings));
    }
    let time = |t: f64| record.start + t;
    Ok(FreeDecay { from: time(first as f64 / record.sample_rate), points: points(&blocks, record.start) })
}

/// The first sample behind the last one at which the force is on.
fn released(record: &Record, layout: &Layout, omega: f64) -> usize {
    let Some(force) = layout.force else { return 0 };
    let force = &record.samples[force][..record.n_samples()];
    let length = ((TAU / omega * record.sample_rate).round() as usize).max(1);
    let scatter: Vec<f64> = force.chunks(length).map(|block| block.iter().map(|x| x * x).sum::<f64>().sqrt()).collect();
    let largest = scatter.iter().copied().fold(0.0, f64::max);
    // The block in which it ends is not free.
    scatter.iter().rposition(|own| *own > OFF * largest).map_or(0, |last| (last + 1) * length)
}

impl Followed<'_> {
    /// Blocks from the first sample on, until one is lost in noise.
    fn blocks(&self, range: Range<usize>, omega: f64) -> Result<Vec<Block>, ExtractionError> {
        let rate = self.record.sample_rate;
        let (mut at, mut step) = (range.start, omega / rate);
        let mut blocks: Vec<Block> = Vec::new();
        loop {
            let length = (PERIODS * TAU / step).round() as usize;
            if at + length > range.end {
                return Ok(blocks);
            }
            let block = self.block(at..at + length, step)?.filter(|block| block.error <= NOISE);
            let Some(mut block) = block else { return Ok(blocks) };
            if let Some(before) = blocks.last() {
                // The phase came on by about the present frequency.
                let due = before.phase + step * rate * (block.time - before.time);
                let ahead = wrapped(block.phase - due);
                block.phase = due + ahead;
                step += ahead / rate / (block.time - before.time);
            }
            blocks.push(block);
            at += length;
        }
    }

    /// What so many samples show; `None` where they show no vibration.
    fn block(&self, samples: Range<usize>, step: f64) -> Result<Option<Block>, ExtractionError> {
        let rate = self.record.sample_rate;
        let fit = HarmonicFit::of_block(step, samples.len())?;
        let harmonics = fit.n_harmonics();
        let signals: Vec<&[f64]> = self.record.samples.iter().map(|x| &x[samples.clone()]).collect();
        let found = fit.coefficients(&signals);
        let omega = step * rate;
        let of = |place: &Place, n: usize| displacement(place, &found, &self.noise, omega, n);
        let alone = || {
            let order = self.record.channels[self.reference].quantity.time_derivative().unwrap_or(0);
            Place { position: None, members: vec![(self.reference, order)] }
        };
        let (eta, mode): (Vec<Vec<Complex64>>, usize) = match &self.modes {
            Some((modes, places, mode)) => {
                let project = |n| modes.project(&places.iter().map(|place| of(place, n)).collect::<Vec<_>>());
                ((1..=harmonics).map(project).collect(), *mode)
            }
            None => ((1..=harmonics).map(|n| vec![of(&alone(), n)]).collect(), 0),
        };
        let square = |n: usize| eta[n].iter().map(|eta| eta.norm_sqr()).sum::<f64>();
        let rest = fit.rest(signals[self.reference], &found[self.reference]);
        let rms = (rest.iter().map(|x| x * x).sum::<f64>() / rest.len() as f64).sqrt();
        let error = rms * (2.0 / rest.len() as f64).sqrt() / found[self.reference][1].norm();
        let block = Block {
            time: 0.5 * (samples.start + samples.end - 1) as f64 / rate,
            phase: eta[0][mode].arg(),
            amplitude: square(0).sqrt(),
            square: (0..harmonics).map(|n| ((n + 1) as f64).powi(2) * square(n)).sum(),
            error,
        };
        let is_sound = block.phase.is_finite() && block.amplitude > 0.0 && error.is_finite();
        Ok(is_sound.then_some(block))
    }
}

/// Value and slope of a smooth course at the middle of its blocks, each with its standard error: of what the course
/// leaves, but at least of the noise, which few blocks tell badly.
fn course(times: &[f64], values: &[f64], at: f64, noise: f64) -> Option<[Measured; 2]> {
    let half = 0.5 * (times.last()? - times.first()?);
    let row = |(t, value): (&f64, &f64)| {
        let u = (t - at) / half;
        (vec![1.0, u, u * u], *value)
    };
    let rows: Vec<(Vec<f64>, f64)> = times.iter().zip(values).map(row).collect();
    let (found, errors, left) = least_squares(&rows)?;
    let larger = if left > 0.0 { (noise / left).max(1.0) } else { 1.0 };
    let measured = |i: usize, scale: f64| Measured { value: found[i] / scale, uncertainty: larger * errors[i] / scale };
    Some([measured(0, 1.0), measured(1, half)])
}

fn points(blocks: &[Block], start: f64) -> Vec<DecayPoint> {
    let times: Vec<f64> = blocks.iter().map(|block| block.time).collect();
    let phases: Vec<f64> = blocks.iter().map(|block| block.phase).collect();
    let near = |k: usize| k.saturating_sub(BESIDE)..(k + BESIDE + 1).min(blocks.len());
    let noise = |k: usize| near(k).map(|j| blocks[j].error).sum::<f64>() / near(k).len() as f64;
    let omega = |k: usize| {
        // The course about a uniform advance, whose phases are large.
        let at = times[k];
        let mean = (phases[near(k).end - 1] - phases[near(k).start]) / (times[near(k).end - 1] - times[near(k).start]);
        let rest: Vec<f64> = near(k).map(|j| phases[j] - phases[k] - mean * (times[j] - at)).collect();
        let [_, slope] = course(&times[near(k)], &rest, at, noise(k))?;
        Some(Measured { value: mean + slope.value, ..slope })
    };
    let omegas: Vec<Option<Measured>> = (0..blocks.len()).map(omega).collect();
    let point = |k: usize| {
        let omega = omegas[k]?;
        let action = |j: usize| Some((omegas[j]?.value * blocks[j].square).ln());
        let actions: Vec<f64> = near(k).map(action).collect::<Option<_>>()?;
        let sizes: Vec<f64> = near(k).map(|j| blocks[j].amplitude.ln()).collect();
        let [_, decay] = course(&times[near(k)], &actions, times[k], 2.0 * noise(k))?;
        let [size, _] = course(&times[near(k)], &sizes, times[k], noise(k))?;
        let amplitude = size.value.exp();
        Some(DecayPoint {
            time: start + times[k],
            omega,
            amplitude: Measured { value: amplitude, uncertainty: amplitude * size.uncertainty },
            damping: decay.times(-0.5 / omega.value),
        })
    };
    // Near the ends slopes would be those of one side.
    (BESIDE..blocks.len() - BESIDE).filter_map(point).collect()
}

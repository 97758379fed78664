//! The contact force, and the impacts at the stop.

use nlmodes_modal::{ContactInstant, ContactStiffness, Restitution, TimeHistory, noise_level};
use num_complex::Complex64;

use crate::extraction::blocks::Blocks;
use crate::extraction::folded::{self, Closed, Folded};
use crate::extraction::force_law::{self, ForceLaw};
use crate::extraction::layout::{Layout, Place, displacement, find, member};
use crate::extraction::loss::least_squares;
use crate::extraction::repeated::rate_deviation;
use crate::extraction::window::Window;
use crate::extraction::{ContactFigures, Finding, HarmonicFit, Measured, Stop};
use crate::records::{Quantity, Record};

/// Standard deviations of the noise from which on a force is one.
const DETECTED: f64 = 6.0;
/// How much further a force must reach on the side on which a stop would pull.
const PULLS: f64 = 5.0;
/// Standard deviations of the noise within which a force rests.
const RESTING: f64 = 4.0;
/// Share of the time that it must rest to have a level at which it does.
const OFTEN: f64 = 0.3;
/// Blocks below which their scatter tells little.
const FEW: f64 = 6.0;
/// Share of its peak from which on such a level is reported.
const OFFSET: f64 = 0.02;

/// Share of the peak above which samples count for the stiffness: below, the contact is only beginning.
const PRESSED: f64 = 0.1;
/// Exponents of a force that is no spring's: from a contact that stiffens, as Hertz's, to a cell that saturates.
const SPRING: std::ops::Range<f64> = 0.86..1.16;
/// Distance of the stop from where it is declared, over the gap, that is reported.
const GAP: f64 = 0.02;
/// Drift of a displacement over its root mean square that is reported.
const DRIFTS: f64 = 5e-3;
/// Samples of a contact from which on it shows how the stop yields.
const LASTS: f64 = 12.0;
/// Share of the closed time by which a force must be late to be reported.
const LATE: f64 = 0.01;
/// Standard errors within which the force begins at the declared gap.
const SURE: f64 = 3.0;
/// Standard errors that count.
const SIGNIFICANT: f64 = 5.0;

/// What the contact is evaluated from.
#[derive(Debug)]
#[non_exhaustive]
pub struct Evidence<'a> {
    pub record: &'a Record,
    pub layout: &'a Layout,
    pub window: &'a Window,
    pub fit: &'a HarmonicFit,
    pub blocks: &'a Blocks,
    /// Whether amplitude and frequency are those of all periods.
    pub steady: bool,
    /// Whether force and motion repeat themselves.
    pub periodic: bool,
}

/// A contact as the mean period shows it.
struct Shown {
    folded: Folded,
    spans: Vec<Closed>,
    law: Option<ForceLaw>,
    /// Displacement toward the stop at which the contact closes, m, where the stop yields.
    stop: Option<f64>,
    /// By how much the force is late, s.
    late: Option<f64>,
}

impl Evidence<'_> {
    /// Figures of the contact; `None` without a contact force.
    pub fn figures(&self, stop: Option<&Stop>, findings: &mut Vec<Finding>) -> Option<ContactFigures> {
        let channel = self.layout.contact?;
        let force = self.shifted(channel);
        self.sound(&force, channel, findings);
        let mut history = stop.and_then(|stop| self.history(&force, stop, findings));
        let shown = self.shown(&force, channel, history.as_ref());
        if let Some(history) = &mut history {
            history.instants = self.instants(&shown.spans);
            if let Some(stop) = shown.stop {
                crossings(history, stop);
            }
        }
        let touched = history.as_ref().filter(|_| !shown.spans.is_empty());
        let stiffness = touched.zip(stop).and_then(|(h, stop)| self.stiffness(h, &shown, stop.position));
        if let Some(stop) = stop.filter(|_| !shown.spans.is_empty() && self.periodic) {
            self.judged(&shown, stop, stiffness.as_ref(), channel, findings);
        }
        let closed = closed(&shown.spans);
        Some(ContactFigures {
            peak_force: self.peak(&force, &shown, channel),
            closed_fraction: closed / std::f64::consts::TAU,
            intervals_per_period: shown.spans.len() as f64,
            restitution: touched.and_then(|history| self.restitution(history, &shown)),
            stiffness,
            history,
        })
    }

    /// The mean period. The contact is closed where the displacement is beyond the place at which the force begins: the
    /// declared one, where the force does not tell another. Where the stop does not yield, or its displacement is not
    /// known, it is closed where there is a force.
    fn shown(&self, force: &[f64], channel: usize, history: Option<&TimeHistory>) -> Shown {
        let side = history.map_or(1.0, |history| if history.stop < 0.0 { -1.0 } else { 1.0 });
        let displacement: Vec<f64> =
            history.map_or_else(Vec::new, |history| history.displacement.iter().map(|x| side * x).collect());
        let noise = [noise_level(force).max(self.blocks.noise[channel]), noise_level(&displacement)];
        let folded = Folded::new(self.fit, force, &displacement, noise);
        if folded.peak() <= DETECTED * folded.force_error {
            return Shown { folded, spans: vec![], law: None, stop: None, late: None };
        }
        let declared = history.map(|history| side * history.stop).filter(|gap| folded.yields(*gap));
        let law = ForceLaw::of(&folded);
        // A cell that saturates bends the force as a whole, and with it the place at which it seems to begin.
        let sound = law.filter(|law| declared.is_none() || law.exponent > SPRING.start);
        // A law that does not explain the force tells no more than that the stop is far from where it was declared.
        let reach =
            |law: &ForceLaw, gap: f64| (SURE * law.stop_error).max(if law.explains { 0.0 } else { GAP * gap.abs() });
        let by_force = sound.map(|law| match declared {
            Some(gap) if (law.stop - gap).abs() < reach(&law, gap) => gap,
            _ => law.stop,
        });
        let late = |stop: Option<f64>| {
            let spans = folded.beyond(stop?);
            let delay = force_law::late(&folded, &spans, self.window.omega)?;
            (delay * self.window.omega > LATE * closed(&spans)).then_some(delay)
        };
        let late = late(declared).or_else(|| late(by_force));
        // A force that is late does not tell where it begins.
        let stop = if late.is_some() { declared.or(by_force) } else { by_force.or(declared) };
        let spans = stop.map_or_else(Vec::new, |stop| folded.beyond(stop));
        let stop = stop.filter(|_| !spans.is_empty());
        let spans = if spans.is_empty() { folded.pressed() } else { spans };
        Shown { folded, spans, law, stop, late }
    }

    /// Instants of touching and leaving in all periods, s from the first sample of the window.
    fn instants(&self, spans: &[Closed]) -> Vec<ContactInstant> {
        let turn = std::f64::consts::TAU;
        let step = self.fit.phase(1) - self.fit.phase(0);
        let at = |phase: f64| (phase - self.fit.phase(0)) / step / self.record.sample_rate;
        let end = (self.window.n_samples - 1) as f64 / self.record.sample_rate;
        let first = (self.fit.phase(0) / turn).floor() as i64 - 1;
        let last = first + self.window.periods as i64 + 3;
        let of = |(m, span): (i64, &Closed)| [span.touching, span.leaving].map(|phase| at(phase + turn * m as f64));
        let mut found: Vec<[f64; 2]> =
            (first..=last).flat_map(|m| spans.iter().map(move |span| of((m, span)))).collect();
        found.retain(|[touching, leaving]| *touching > 0.0 && *leaving < end);
        found.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let instant = |time, touching| ContactInstant { time, touching };
        found.iter().flat_map(|[touching, leaving]| [instant(*touching, true), instant(*leaving, false)]).collect()
    }

    /// Velocities at touching and leaving; where the stop yields for many samples they do not jump there.
    fn restitution(&self, history: &TimeHistory, shown: &Shown) -> Option<Restitution> {
        let step = self.fit.phase(1) - self.fit.phase(0);
        let shortest =
            shown.spans.iter().map(|span| (span.leaving - span.touching) / step).fold(f64::INFINITY, f64::min);
        let yields = shown.stop.is_some() && shortest > LASTS;
        let found = if yields { Restitution::of_yielding(history) } else { Restitution::of(history) };
        found.ok()
    }

    /// What does not fit among force, displacement and declared gap.
    fn judged(
        &self,
        shown: &Shown,
        stop: &Stop,
        stiffness: Option<&ContactStiffness>,
        channel: usize,
        findings: &mut Vec<Finding>,
    ) {
        let channel = || self.record.channels[channel].name.clone();
        let rings = force_law::rings(&shown.folded, &shown.spans);
        // What only fades behind the contact, without half a turn in as long a time, is late and does not ring.
        let half = std::f64::consts::PI;
        let fades = |harmonic: usize| shown.late.is_some() && (harmonic as f64) * closed(&shown.spans) < half;
        if let Some((share, harmonic)) = rings.filter(|(_, harmonic)| !fades(*harmonic)) {
            let frequency_hz = harmonic as f64 * self.window.omega / std::f64::consts::TAU;
            findings.push(Finding::CellRings { channel: channel(), share, frequency_hz });
        }
        if let Some(delay) = shown.late.filter(|_| rings.is_none_or(|(_, harmonic)| fades(harmonic))) {
            findings.push(Finding::CellLate { channel: channel(), delay });
        }
        let Some(law) = shown.law.filter(|_| shown.late.is_none()) else { return };
        if !SPRING.contains(&law.exponent) {
            findings.push(Finding::ContactCurved { channel: channel(), exponent: law.exponent });
        }
        // A displacement that is integrated has no zero.
        let place = find(&self.layout.places, stop.position).map(|k| &self.layout.places[k]);
        if place.is_none_or(|place| member(place, &self.record.channels, Quantity::Displacement).is_none()) {
            return;
        }
        let error = stiffness.map_or(0.0, |stiffness| stiffness.stop_error).max(law.stop_error);
        let off = (law.stop - stop.gap).abs();
        if off > GAP * stop.gap && off > SIGNIFICANT * error && stop.gap > 0.0 {
            findings.push(Finding::GapElsewhere { declared: stop.gap, found: law.stop, uncertainty: error });
        }
    }

    /// Reports a force whose peaks pull: its channel is reversed; or which does not rest at zero between them.
    fn sound(&self, force: &[f64], channel: usize, findings: &mut Vec<Finding>) {
        let mut sorted = force.to_vec();
        sorted.sort_by(f64::total_cmp);
        let [Some(low), Some(high)] = [sorted.first(), sorted.last()] else { return };
        let (rest, noise) = (sorted[sorted.len() / 2], noise_level(force));
        let channel = || self.record.channels[channel].name.clone();
        let width = (RESTING * noise).max(1e-3 * (high - low));
        let near = |level: f64| force.iter().filter(move |x| (**x - level).abs() <= width);
        let often = near(rest).count() as f64 > OFTEN * force.len() as f64;
        if often && rest.abs() > width.max(OFFSET * (high - rest).max(rest - low)) {
            findings.push(Finding::Offset { channel: channel(), offset: rest, peak: *high });
        }
        if rest - low > (DETECTED * noise).max(PULLS * (high - rest)) {
            findings.push(Finding::ReversedChannel {
                channel: channel(),
                against: "a stop, which cannot pull".into(),
                alternatives: vec![],
            });
        }
    }

    /// The contact stiffness; a displacement that is integrated depends on the sampling rate, which is in its error.
    ///
    /// There is none where a stop that yields has a force that does not rise with the displacement: the cell shows
    /// something else.
    fn stiffness(&self, history: &TimeHistory, shown: &Shown, position: f64) -> Option<ContactStiffness> {
        if shown.stop.is_some() && shown.law.is_none() {
            return None;
        }
        let least = shown.folded.threshold().max(PRESSED * shown.folded.peak());
        let pressed = |j: usize| shown.folded.force_at(self.fit.phase(j)) > least;
        let mut stiffness = ContactStiffness::of_pressed(history, pressed).ok()?;
        let place = &self.layout.places[find(&self.layout.places, position)?];
        let stated = |i: usize| self.record.channels[i].uncertainty.unwrap_or(0.0);
        let of_sensors = place.members.iter().map(|(i, _)| stated(*i)).fold(0.0, f64::max);
        let of_cell = self.layout.contact.map_or(0.0, stated);
        stiffness.stiffness_error = stiffness.stiffness_error.hypot(stiffness.stiffness * of_cell.hypot(of_sensors));
        if place.members.iter().all(|(_, order)| *order > 0) {
            let size = |omega: f64| displacement(place, &self.blocks.all, &self.blocks.noise, omega, 1).norm();
            let omega = self.window.omega;
            let change = size(omega * (1.0 + rate_deviation(self.record.rate_error))) / size(omega) - 1.0;
            stiffness.stiffness_error = stiffness.stiffness_error.hypot(stiffness.stiffness * change);
        }
        Some(stiffness)
    }

    /// Largest force of the mean period, without the noise of the cell as far as its harmonics are known; zero, with
    /// the noise as its error, where no force rises above the noise.
    fn peak(&self, force: &[f64], shown: &Shown, channel: usize) -> Measured {
        if shown.spans.is_empty() {
            return Measured { value: 0.0, uncertainty: noise_level(force) };
        }
        let (all, single) = (&self.blocks.all[channel], &self.blocks.single);
        let errors = self.squared_errors(channel);
        let weights = folded::without_noise(all, &errors);
        let weighted = |q: &[Complex64]| q.iter().zip(&weights).map(|(q, weight)| q * *weight).collect::<Vec<_>>();
        let (phase, value) = folded::largest(&weighted(all));
        let at_top = |q: &Vec<Vec<Complex64>>| {
            let term = |(n, q): (usize, &Complex64)| (q * Complex64::cis(n as f64 * phase)).re;
            weighted(&q[channel]).iter().enumerate().map(term).sum::<f64>()
        };
        let tops: Vec<f64> = single.iter().map(at_top).collect();
        // What was taken out with the noise.
        let taken =
            |((q, weight), error): ((&Complex64, &f64), &f64)| (1.0 - weight).powi(2) * (q.norm_sqr() - error).max(0.0);
        let lost: f64 = all.iter().zip(&weights).zip(&errors).map(taken).sum();
        let of_cell = self.record.channels[channel].uncertainty.unwrap_or(0.0);
        Measured::new(value, &tops).and((0.5 * lost).sqrt()).and(of_cell * value)
    }

    /// Squared standard errors of the harmonics of a channel: of their scatter from block to block, or of what all of
    /// them leave.
    fn squared_errors(&self, channel: usize) -> Vec<f64> {
        let (all, single) = (&self.blocks.all[channel], &self.blocks.single);
        let (blocks, n) = (single.len() as f64, self.window.n_samples as f64);
        let freedom = (n - 2.0 * all.len() as f64).max(1.0);
        let white = 4.0 * self.blocks.noise[channel].powi(2) / freedom;
        let scatter = |k: usize| {
            single.iter().map(|q| (q[channel][k] - all[k]).norm_sqr()).sum::<f64>() / blocks / (blocks - 1.0)
        };
        (0..all.len()).map(|k| if blocks < FEW { white } else { scatter(k) }).collect()
    }

    /// The displacement without its drift from period to period, which is reported.
    fn without_drift(&self, place: &Place, mut displacement: Vec<f64>, findings: &mut Vec<Finding>) -> Vec<f64> {
        let Some(channel) = member(place, &self.record.channels, Quantity::Displacement) else { return displacement };
        let centres = &self.blocks.centres;
        let half = 0.5 * self.window.n_samples as f64 / self.record.sample_rate;
        let powers = |t: f64| (0..4).map(|p| (t / half).powi(p)).collect::<Vec<f64>>();
        let means = self.blocks.single.iter().map(|q| q[channel][0].re);
        let rows: Vec<(Vec<f64>, f64)> = centres.iter().zip(means).map(|(t, mean)| (powers(*t), mean)).collect();
        let Some((course, errors, _)) = least_squares(&rows) else { return displacement };
        let at = |t: f64| powers(t).iter().zip(&course).skip(1).map(|(p, c)| p * c).sum::<f64>();
        let size = self.blocks.all[channel][1..].iter().map(|q| 0.5 * q.norm_sqr()).sum::<f64>().sqrt();
        let change = at(half) - at(-half);
        if !self.steady || change.abs() < (SIGNIFICANT * 2.0 * errors[1].hypot(errors[3])).max(DRIFTS * size) {
            return displacement;
        }
        findings.push(Finding::DisplacementDrift { channel: self.record.channels[channel].name.clone(), change });
        for (j, x) in displacement.iter_mut().enumerate() {
            *x -= at(j as f64 / self.record.sample_rate - half);
        }
        displacement
    }

    fn history(&self, force: &[f64], stop: &Stop, findings: &mut Vec<Finding>) -> Option<TimeHistory> {
        let Some(place) = find(&self.layout.places, stop.position).map(|k| &self.layout.places[k]) else {
            let consequence = "without the motion at the stop there is no restitution and no contact stiffness".into();
            let channel = format!("response at {} m", stop.position);
            findings.push(Finding::ChannelMissing { channel, consequence });
            return None;
        };
        let series = |quantity, order| match member(place, &self.record.channels, quantity) {
            Some(channel) => self.shifted(channel),
            None => self.synthesized(place, order),
        };
        Some(TimeHistory {
            label: self.record.name.clone(),
            time: (0..self.window.n_samples).map(|j| j as f64 / self.record.sample_rate).collect(),
            displacement: self.without_drift(place, series(Quantity::Displacement, 0), findings),
            velocity: series(Quantity::Velocity, 1),
            acceleration: series(Quantity::Acceleration, 2),
            force: force.to_vec(),
            stop: if stop.positive { stop.gap } else { -stop.gap },
            instants: vec![],
        })
    }

    /// A derivative of the displacement at a place from the harmonics of its channels.
    fn synthesized(&self, place: &Place, order: u32) -> Vec<f64> {
        let omega = self.window.omega;
        let derivative = |n: usize| {
            displacement(place, &self.blocks.all, &self.blocks.noise, omega, n)
                * Complex64::new(0.0, n as f64 * omega).powu(order)
        };
        let coefficients: Vec<Complex64> = (0..=self.fit.n_harmonics()).map(derivative).collect();
        self.fit.synthesize(&coefficients).0
    }

    /// Samples of a channel in the window without its delay, between samples by the cubic through four of them.
    fn shifted(&self, channel: usize) -> Vec<f64> {
        let delay = self.record.channels[channel].delay * self.record.sample_rate;
        let range = self.window.first..self.window.first + self.window.n_samples;
        range.map(|j| cubic(&self.record.samples[channel], j as f64 + delay)).collect()
    }
}

/// Moves the instants of a history to where the displacement itself is at the stop (m, toward it): where a line
/// through the samples about each comes there, as many as its noise takes.
fn crossings(history: &mut TimeHistory, stop: f64) {
    let side = if history.stop < 0.0 { -1.0 } else { 1.0 };
    let [Some(first), Some(second)] = [history.time.first(), history.time.get(1)] else { return };
    let interval = second - first;
    let noise = noise_level(&history.displacement);
    for instant in &mut history.instants {
        let at = (instant.time - first) / interval;
        let speed = history.velocity.get(at as usize).map_or(0.0, |v| v.abs());
        let reach = (3.0 * noise / (speed * interval)).clamp(2.0, 20.0);
        let near = ((at - reach).ceil().max(0.0) as usize)..((at + reach).floor() as usize + 1).min(history.time.len());
        let row = |j: usize| (vec![1.0, j as f64 - at], side * history.displacement[j] - stop);
        let rows: Vec<(Vec<f64>, f64)> = near.map(row).collect();
        let Some((line, ..)) = least_squares(&rows) else { continue };
        let moved = -line[0] / line[1];
        // A displacement that does not cross there tells nothing.
        if moved.abs() <= reach {
            instant.time += moved * interval;
        }
    }
}

/// Phase in which the contact is closed, rad.
fn closed(spans: &[Closed]) -> f64 {
    spans.iter().fold(0.0, |sum, span| sum + (span.leaving - span.touching))
}

/// Value between samples, by the Lagrange cubic; beyond the samples that at the end.
fn cubic(samples: &[f64], at: f64) -> f64 {
    let last = samples.len() - 1;
    let at = at.clamp(0.0, last as f64);
    let base = at.floor() as usize;
    let x = at - base as f64;
    let y = |k: isize| samples[(base as isize + k).clamp(0, last as isize) as usize];
    let (a, b, c, d) = (y(-1), y(0), y(1), y(2));
    b + x * ((c - a / 3.0 - b / 2.0 - d / 6.0) + x * ((a - 2.0 * b + c) / 2.0 + x * (d - a + 3.0 * (b - c)) / 6.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cubic_is_exact_for_cubics() {
        let p = |x: f64| 1.0 - x + 0.5 * x * x - 0.1 * x.powi(3);
        let samples: Vec<f64> = (0..10).map(|j| p(f64::from(j))).collect();
        for at in [1.0, 3.25, 6.9, 8.0] {
            assert!((cubic(&samples, at) - p(at)).abs() < 1e-11, "{at}");
        }
        for (at, end) in [(9.0, 9), (9.001, 9), (12.0, 9), (0.0, 0), (-0.001, 0), (-3.0, 0)] {
            assert_eq!(cubic(&samples, at), samples[end], "{at}");
        }
        // At the ends the neighbour that is missing is the last one again.
        let near = |at: f64| cubic(&[1.0, 1.0, 3.0, 3.0], at);
        assert!((near(1.5) - 2.0).abs() < 1e-15 && (near(0.5) - 0.875).abs() < 1e-15, "{} {}", near(1.5), near(0.5));
    }
}

//! The contact force, and the impacts at the stop.

use nlmodes_modal::{ContactStiffness, Restitution, TimeHistory, contact_intervals, noise_level};
use num_complex::Complex64;

use crate::extraction::layout::{Layout, Place, displacement, find, member};
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
/// Share of its peak from which on such a level is told.
const OFFSET: f64 = 0.02;

/// What the contact is evaluated from.
#[derive(Debug)]
#[non_exhaustive]
pub struct Evidence<'a> {
    pub record: &'a Record,
    pub layout: &'a Layout,
    pub window: &'a Window,
    pub fit: &'a HarmonicFit,
    pub coefficients: &'a [Vec<Complex64>],
    pub noise: &'a [f64],
}

impl Evidence<'_> {
    /// Figures of the contact; `None` without a contact force.
    pub fn figures(&self, stop: Option<&Stop>, findings: &mut Vec<Finding>) -> Option<ContactFigures> {
        let channel = self.layout.contact?;
        let force = self.shifted(channel);
        self.sound(&force, channel, findings);
        let history = stop.and_then(|stop| self.history(&force, stop, findings));
        let intervals = history.as_ref().and_then(|history| contact_intervals(history).ok()).unwrap_or_default();
        let closed = intervals.iter().fold(0.0, |sum, interval| sum + interval.leaving - interval.touching);
        Some(ContactFigures {
            peak_force: self.peak(&force),
            closed_fraction: closed / (self.window.n_samples as f64 / self.record.sample_rate),
            intervals_per_period: intervals.len() as f64 / self.window.periods as f64,
            restitution: history.as_ref().and_then(|history| Restitution::of(history).ok()),
            stiffness: history.as_ref().and_then(|history| self.stiffness(history, stop?.position)),
            history,
        })
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
    fn stiffness(&self, history: &TimeHistory, position: f64) -> Option<ContactStiffness> {
        let mut stiffness = ContactStiffness::of(history).ok()?;
        let place = &self.layout.places[find(&self.layout.places, position)?];
        if place.members.iter().all(|(_, order)| *order > 0) {
            let size = |omega: f64| displacement(place, self.coefficients, self.noise, omega, 1).norm();
            let omega = self.window.omega;
            let change = size(omega * (1.0 + rate_deviation(self.record.rate_error))) / size(omega) - 1.0;
            stiffness.stiffness_error = stiffness.stiffness_error.hypot(stiffness.stiffness * change);
        }
        Some(stiffness)
    }

    /// Mean of the largest forces of the single periods; zero, with the noise as its error, where no force rises above
    /// the noise.
    fn peak(&self, force: &[f64]) -> Measured {
        let noise = noise_level(force);
        if force.iter().all(|force| *force <= DETECTED * noise) {
            return Measured { value: 0.0, uncertainty: noise };
        }
        let (n, periods) = (force.len(), self.window.periods);
        let largest = |samples: &[f64]| samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let peaks: Vec<f64> = (0..periods).map(|k| largest(&force[k * n / periods..(k + 1) * n / periods])).collect();
        Measured::new(peaks.iter().sum::<f64>() / peaks.len() as f64, &peaks)
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
            displacement: series(Quantity::Displacement, 0),
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
            displacement(place, self.coefficients, self.noise, omega, n)
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

//! What the force over a period tells: peak, impulse, restitution, stiffness.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::{ForceBalance, Harmonics, Table};
use crate::extraction::Measured;
use crate::extraction::folded::{self, Closed, Folded};
use crate::extraction::layout::{displacement, find};
use crate::extraction::measured::spread;

/// Points of a period for each harmonic.
const POINTS: usize = 8;
/// Standard errors from which on a force is one.
const DETECTED: f64 = 4.0;
/// Share of a period about a contact that is not taken for rest.
const MARGIN: f64 = 0.01;
/// Share of the values of a period among which the force rests, at first sight.
const RESTS: f64 = 0.5;
/// Share of the peak above which the stop yields as its stiffness says.
const PRESSED: f64 = 0.1;
/// Share of the variance of the force that a line explains at least where the stop has a stiffness.
const ON_A_LINE: f64 = 0.5;

/// The contact as the motion tells it, without a force cell.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct BalanceFigures {
    /// Largest force of the mean period, N.
    pub peak_force: Measured,
    /// Integral of the force over a period, N s.
    pub impulse: Measured,
    /// Speed after over speed before a contact, mean over those of a period.
    pub restitution: Option<Measured>,
    /// Slope of the force over the displacement at the stop, N/m.
    pub stiffness: Option<Measured>,
    /// Share of time in contact.
    pub closed_fraction: f64,
    /// Harmonics `Λ_0 … Λ_H` of the force, N; phases count from the middle of the periods.
    pub force: Vec<Complex64>,
}

/// A period of force and motion at the stop.
struct Period {
    folded: Folded,
    spans: Vec<Closed>,
    /// Velocity toward the stop, harmonic by harmonic.
    velocity: Vec<Complex64>,
    /// Mean of `e^{inθ}` over the phases at which the force rests, from n = 1 on.
    rest: Vec<Complex64>,
}

impl ForceBalance<'_> {
    /// The figures; `None` where what the modes lack is within their errors.
    pub fn figures(&self) -> Option<BalanceFigures> {
        let table = self.table(self.modes.clone());
        let harmonics = self.harmonics(&table);
        let weights = Self::weights(&harmonics);
        let period = self.period(&table, &harmonics, &weights)?;
        let level = |force: &[Complex64]| -> f64 {
            let term = |((q, weight), rest): ((&Complex64, &f64), &Complex64)| weight * (q * rest).re;
            force.iter().zip(&weights).zip(&period.rest).map(term).sum()
        };
        let at = |force: &[Complex64], phase: f64| -> f64 {
            let term = |(n, (q, weight)): (usize, (&Complex64, &f64))| {
                weight * (q * Complex64::cis((n + 1) as f64 * phase)).re
            };
            force.iter().zip(&weights).enumerate().map(term).sum::<f64>() - level(force)
        };
        let (top, _) = folded::largest(&with_mean(&harmonics.force, &weights, 0.0));
        let evaluated: Vec<Vec<Complex64>> =
            self.blocks.single.iter().map(|q| self.again(&table, q, &harmonics.shares)).collect();
        let drawn = self.drawn(&harmonics.shares);
        let measured = |of: &dyn Fn(&[Complex64]) -> f64| {
            let singles: Vec<f64> = evaluated.iter().map(|force| of(force)).collect();
            let draws: Vec<f64> = drawn.iter().map(|force| of(force)).collect();
            let by_modes = if draws.is_empty() { 0.0 } else { spread(&draws) };
            Measured::new(of(&harmonics.force), &singles).and(by_modes)
        };
        let duration = TAU / self.omega;
        let mean = -level(&harmonics.force);
        let stiffness = self.stiffness(&period).map(|slope| {
            // As uncertain as the force from which it is taken, and as the line.
            let peak = measured(&|force| at(force, top));
            slope.and(slope.value * peak.uncertainty / peak.value)
        });
        Some(BalanceFigures {
            peak_force: measured(&|force| at(force, top)),
            impulse: measured(&|force| -level(force) * duration),
            restitution: self.restitution(&period),
            stiffness,
            closed_fraction: period.spans.iter().map(|span| span.leaving - span.touching).sum::<f64>() / TAU,
            force: with_mean(&harmonics.force, &weights, mean),
        })
    }

    /// What noise leaves of each harmonic.
    fn weights(harmonics: &Harmonics) -> Vec<f64> {
        let zero = Complex64::default();
        let all: Vec<Complex64> = std::iter::once(zero).chain(harmonics.force.iter().copied()).collect();
        let errors: Vec<f64> = std::iter::once(0.0).chain(harmonics.by_noise.iter().copied()).collect();
        folded::without_noise(&all, &errors).split_off(1)
    }

    fn period(&self, table: &Table, harmonics: &Harmonics, weights: &[f64]) -> Option<Period> {
        let used = weights.iter().rposition(|weight| *weight > 0.0)? + 1;
        let n = POINTS * used;
        let phases: Vec<f64> = (0..n).map(|j| TAU * j as f64 / n as f64).collect();
        let sampled = |q: &[Complex64]| -> Vec<f64> {
            let at = |phase: &f64| {
                let turn = Complex64::cis(*phase);
                q.iter().take(used + 1).rev().fold(Complex64::default(), |sum, q| sum * turn + q).re
            };
            phases.iter().map(at).collect()
        };
        let force = sampled(&with_mean(&harmonics.force, weights, 0.0));
        let error = |squares: &[f64]| {
            0.5 * squares.iter().zip(weights).map(|(square, weight)| weight * weight * square).sum::<f64>()
        };
        // From its lowest to its highest value a harmonic goes twice its amplitude.
        let swing = 2.0 * (2.0 * (error(&harmonics.by_noise) + error(&harmonics.by_modes))).sqrt();
        let motion = self.at_stop(table, harmonics);
        let has_mean = motion[0] != Complex64::default();
        let rate = |(n, q): (usize, &Complex64)| Complex64::new(0.0, n as f64 * self.omega) * q;
        let velocity: Vec<Complex64> = motion.iter().enumerate().map(rate).take(used + 1).collect();
        let mut folded = Folded {
            phase: phases.clone(),
            displacement: if has_mean { sampled(&motion) } else { vec![] },
            force_error: error(&harmonics.by_noise).sqrt(),
            displacement_error: 0.0,
            force,
        };
        // The force rests for half of the time at least: first by its lower values, then between the contacts.
        let mut sorted = folded.force.clone();
        sorted.sort_by(f64::total_cmp);
        let first = sorted[(RESTS * 0.5 * n as f64) as usize];
        folded.force.iter_mut().for_each(|force| *force -= first);
        if folded.peak() < DETECTED * swing {
            return None;
        }
        let spans = self.spans(&folded);
        let open = folded.open_bins(&spans, MARGIN * TAU);
        if open.is_empty() || spans.is_empty() {
            return None;
        }
        let level = open.iter().map(|i| folded.force[*i]).sum::<f64>() / open.len() as f64;
        folded.force.iter_mut().for_each(|force| *force -= level);
        let mean = |n: usize| open.iter().map(|i| Complex64::cis(n as f64 * phases[*i])).sum::<Complex64>();
        let rest = (1..=weights.len()).map(|n| if n <= used { mean(n) / open.len() as f64 } else { 0.0.into() });
        Some(Period { spans: self.spans(&folded), rest: rest.collect(), folded, velocity })
    }

    /// Where the displacement is beyond the declared gap, if it is known and comes there; else where there is a force.
    fn spans(&self, folded: &Folded) -> Vec<Closed> {
        let by_gap = if folded.yields(self.settings.gap) { folded.beyond(self.settings.gap) } else { vec![] };
        if by_gap.is_empty() { folded.pressed() } else { by_gap }
    }

    /// Displacement toward the stop: of the sensor there, or of the modes; without a mean where nothing measures it.
    fn at_stop(&self, table: &Table, harmonics: &Harmonics) -> Vec<Complex64> {
        let q = &self.blocks.all;
        let own = find(self.places, self.settings.position).map(|i| &self.places[i]);
        let of = |n: usize| match own {
            Some(place) => self.side() * displacement(place, q, &self.blocks.noise, self.omega, n),
            None if n == 0 => Complex64::default(),
            None => match &table.at_places {
                Some(modes) => {
                    let eta = modes.project(&self.motion(q, n));
                    eta.iter().zip(&table.stop).map(|(eta, stop)| eta * *stop).sum()
                }
                None => self.at_stop_by_forces(table, harmonics.force[n - 1], n),
            },
        };
        (0..=self.last()).map(of).collect()
    }

    /// Speeds where the contacts of the mean period begin and end.
    fn restitution(&self, period: &Period) -> Option<Measured> {
        let speed = |phase: f64| -> f64 {
            let term = |(n, v): (usize, &Complex64)| (v * Complex64::cis(n as f64 * phase)).re;
            period.velocity.iter().enumerate().map(term).sum()
        };
        let of = |span: &Closed| -speed(span.leaving) / speed(span.touching);
        let found: Vec<f64> = period.spans.iter().map(of).filter(|e| e.is_finite()).collect();
        let mean = found.iter().sum::<f64>() / found.len() as f64;
        // Points at which a contact begins and ends are known to half of their distance.
        let blurred = |span: &Closed, by: f64| {
            let step = by * TAU / period.folded.phase.len() as f64;
            -speed(span.leaving + step) / speed(span.touching - step)
        };
        let shifts = period.spans.iter().map(|span| 0.5 * (blurred(span, 0.5) - blurred(span, -0.5)).abs());
        let uncertainty = shifts.fold(0.0, f64::max);
        (!found.is_empty()).then_some(Measured { value: mean, uncertainty })
    }

    /// Slope of the line of force over displacement where the force presses: the mean of that of the force over the
    /// displacement and that of the displacement over the force, between which it is. None where they differ too much
    /// for the force to be on a line.
    fn stiffness(&self, period: &Period) -> Option<Measured> {
        let folded = &period.folded;
        let least = PRESSED * folded.peak();
        let pairs = || folded.displacement.iter().zip(&folded.force).filter(|(_, force)| **force > least);
        let count = pairs().count() as f64;
        let [x, force] = pairs().fold([0.0, 0.0], |sum, (x, f)| [sum[0] + x / count, sum[1] + f / count]);
        let products = pairs().fold([0.0; 3], |[xx, xf, ff], (u, f)| {
            let (u, f) = (u - x, f - force);
            [xx + u * u, xf + u * f, ff + f * f]
        });
        let [low, high] = [products[1] / products[0], products[2] / products[1]];
        (low > 0.0 && low >= ON_A_LINE * high)
            .then_some(Measured { value: 0.5 * (low + high), uncertainty: 0.5 * (high - low) })
    }
}

/// Weighted harmonics behind a mean.
fn with_mean(force: &[Complex64], weights: &[f64], mean: f64) -> Vec<Complex64> {
    std::iter::once(mean.into()).chain(force.iter().zip(weights).map(|(q, weight)| q * *weight)).collect()
}

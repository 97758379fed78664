//! Channels that are late or early against those they must agree with.

use nlmodes_modal::LinearModes;
use num_complex::Complex64;

use crate::extraction::blocks::Blocks;
use crate::extraction::layout::{Place, displacement, displacement_noise};
use crate::extraction::measured::{spread, wrapped};
use crate::extraction::{Finding, Tolerances};

/// Harmonics that are compared.
const HARMONICS: usize = 5;
/// Standard errors that a delay must exceed.
const SIGNIFICANT: f64 = 5.0;
/// Phases that scatter more than this (rad) are noise.
const CLEAR: f64 = 0.1;
/// Misfit of sensors with the linear modes, over noise, that counts as agreement.
const AGREEMENT: f64 = 5.0;
/// Fewest blocks whose scatter is an error.
const FEWEST: usize = 4;
/// What is not periodic, over the signal, from which on phases tell no delay.
const APERIODIC: f64 = 0.2;
/// A delay leaves amplitudes alone: within this share.
const SAME_SIZE: f64 = 0.05;

/// What is compared.
#[derive(Debug)]
#[non_exhaustive]
pub struct Comparison<'a> {
    pub blocks: &'a Blocks,
    pub names: Vec<&'a str>,
    pub omega: f64,
    pub sample_rate: f64,
    pub n_samples: usize,
    pub tolerances: Tolerances,
}

impl Comparison<'_> {
    /// Reports channels at one place that disagree in time.
    pub fn collocated(&self, places: &[Place], findings: &mut Vec<Finding>) {
        for place in places {
            let alone = |member: (usize, u32)| Place { position: place.position, members: vec![member] };
            let Some((first, others)) = place.members.split_first() else { continue };
            for other in others {
                if !(self.is_periodic(first.0) && self.is_periodic(other.0)) {
                    continue;
                }
                let against = self.names[first.0].to_owned();
                let ratio = |q: &[Vec<Complex64>], n: usize| {
                    self.displacement(&alone(*other), q, n) / self.displacement(&alone(*first), q, n)
                };
                self.report(self.delay(ratio), self.names[other.0], against, findings);
            }
        }
    }

    /// Reports the one place, if any, whose delay makes all others agree with the linear modes. It takes at least two
    /// more places than modes: one to see that something is wrong, one more to see where.
    pub fn against_modes(&self, modes: &LinearModes, places: &[Place], findings: &mut Vec<Finding>) {
        let periodic = places.iter().flat_map(|place| &place.members).all(|(i, _)| self.is_periodic(*i));
        if places.len() < modes.n_modes() + 2 || !periodic {
            return;
        }
        let everyone: Vec<usize> = (0..places.len()).collect();
        let q = &self.blocks.all;
        if self.misfit(modes, places, &everyone, q).is_none_or(|misfit| misfit < AGREEMENT) {
            return;
        }
        let without = |d: usize| everyone.iter().copied().filter(|i| *i != d).collect::<Vec<_>>();
        let misfits = everyone.iter().filter_map(|d| Some((*d, self.misfit(modes, places, &without(*d), q)?)));
        let Some((culprit, misfit)) = misfits.min_by(|a, b| a.1.total_cmp(&b.1)) else { return };
        if misfit > AGREEMENT {
            return;
        }
        let others = without(culprit);
        let ratio = |q: &[Vec<Complex64>], n: usize| {
            let predicted = self.predicted(modes, places, &others, culprit, q, n);
            predicted.map_or(Complex64::new(f64::NAN, 0.0), |p| self.displacement(&places[culprit], q, n) / p)
        };
        let size = ratio(q, 1).norm();
        if (size - 1.0).abs() < SAME_SIZE {
            let name = places[culprit].members.first().map_or("", |(i, _)| self.names[*i]);
            self.report(self.delay(ratio), name, "the other sensors and the linear modes".into(), findings);
        }
    }

    /// Whether a channel repeats itself so well, and so often, that its phases tell a delay.
    fn is_periodic(&self, channel: usize) -> bool {
        let size = self.blocks.all[channel].iter().skip(1).map(|q| 0.5 * q.norm_sqr()).sum::<f64>().sqrt();
        self.blocks.single.len() >= FEWEST && self.blocks.noise[channel] < APERIODIC * size
    }

    fn displacement(&self, place: &Place, q: &[Vec<Complex64>], n: usize) -> Complex64 {
        displacement(place, q, &self.blocks.noise, self.omega, n)
    }

    fn noise(&self, place: &Place, n: usize) -> f64 {
        displacement_noise(place, &self.blocks.noise, self.omega, n, self.n_samples)
    }

    /// Modal coordinates from some places, each weighted by its noise.
    fn weighted(
        &self,
        modes: &LinearModes,
        places: &[Place],
        rows: &[usize],
        q: &[Vec<Complex64>],
        n: usize,
    ) -> Option<(Vec<Complex64>, LinearModes, Vec<Complex64>)> {
        let scale: Vec<f64> = rows.iter().map(|d| 1.0 / self.noise(&places[*d], n)).collect();
        let shape = |(d, s): (&usize, &f64)| (0..modes.n_modes()).map(|k| modes.shape(*d, k) * s).collect::<Vec<_>>();
        let shapes: Vec<Vec<f64>> = rows.iter().zip(&scale).map(shape).collect();
        let positions: Vec<f64> = rows.iter().map(|d| modes.positions()[*d]).collect();
        let weighted = LinearModes::new(&positions, modes.omegas(), modes.damping_ratios(), &shapes).ok()?;
        let motion: Vec<Complex64> =
            rows.iter().zip(&scale).map(|(d, s)| self.displacement(&places[*d], q, n) * s).collect();
        Some((weighted.project(&motion), weighted, motion))
    }

    /// Root mean square of what the modes leave of the fundamental at these places, over its noise.
    fn misfit(&self, modes: &LinearModes, places: &[Place], rows: &[usize], q: &[Vec<Complex64>]) -> Option<f64> {
        let (eta, weighted, motion) = self.weighted(modes, places, rows, q, 1)?;
        let rest: f64 = weighted.expand(&eta).iter().zip(&motion).map(|(a, b)| (a - b).norm_sqr()).sum();
        let freedom = 2 * (rows.len() - modes.n_modes());
        (freedom > 0).then(|| (rest / freedom as f64).sqrt())
    }

    fn predicted(
        &self,
        modes: &LinearModes,
        places: &[Place],
        rows: &[usize],
        place: usize,
        q: &[Vec<Complex64>],
        n: usize,
    ) -> Option<Complex64> {
        let (eta, ..) = self.weighted(modes, places, rows, q, n)?;
        Some(eta.iter().enumerate().map(|(k, eta)| eta * modes.shape(place, k)).sum())
    }

    /// Delay (s) and its standard error from the phases of a ratio over the harmonics, each weighted by its scatter
    /// from block to block.
    fn delay(&self, ratio: impl Fn(&[Vec<Complex64>], usize) -> Complex64) -> Option<(f64, f64)> {
        let (mut sum, mut weights) = (0.0, 0.0);
        let highest = self.blocks.all.first().map_or(0, |q| q.len() - 1).min(HARMONICS);
        for n in 1..=highest {
            let angle = ratio(&self.blocks.all, n).arg();
            let near = |q: &Vec<Vec<Complex64>>| angle + wrapped(ratio(q, n).arg() - angle);
            let angles: Vec<f64> = self.blocks.single.iter().map(near).collect();
            let scatter = spread(&angles);
            if !(scatter < CLEAR && angle.abs() < 1.0) {
                continue;
            }
            let omega = n as f64 * self.omega;
            let weight = omega.powi(2) / (scatter.powi(2) / angles.len() as f64).max(1e-24);
            sum -= weight * angle / omega;
            weights += weight;
        }
        (weights > 0.0).then(|| (sum / weights, weights.sqrt().recip()))
    }

    fn report(&self, delay: Option<(f64, f64)>, channel: &str, against: String, findings: &mut Vec<Finding>) {
        let Some((delay, uncertainty)) = delay else { return };
        let samples = delay * self.sample_rate;
        if samples.abs() > self.tolerances.skew && delay.abs() > SIGNIFICANT * uncertainty {
            let degrees = (delay * self.omega).to_degrees();
            findings.push(Finding::Skew { channel: channel.to_owned(), delay, uncertainty, samples, degrees, against });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of half a second at 17.5 Hz.
    fn of_blocks(blocks: &Blocks) -> Comparison<'_> {
        let (omega, sample_rate, n_samples, tolerances) = (110.0, 1e4, 5000, Tolerances::default());
        Comparison { blocks, names: vec![], omega, sample_rate, n_samples, tolerances }
    }

    /// Of as few harmonics as there are, and with the weights of their phases: twice the harmonic has twice the phase.
    #[test]
    fn a_delay_is_told_by_the_phase_of_every_harmonic_that_is_there() {
        let delay = 3e-4;
        for highest in [1, 2, 4] {
            let late = |n: usize, more: f64| Complex64::cis(-(n as f64) * 110.0 * (delay + more));
            let of = |more: f64| vec![(0..=highest).map(|n| late(n, more)).collect::<Vec<_>>()];
            let single = (0..8).map(|k| of(1e-6 * (f64::from(k) - 3.5))).collect();
            let blocks = Blocks { all: of(0.0), single, centres: vec![], rest: vec![], noise: vec![] };
            let (found, error) = of_blocks(&blocks).delay(|q, n| q[0][n]).unwrap();
            assert!((found - delay).abs() < 1e-12, "{highest}: {found}");
            // Each harmonic has the same delay of the blocks: with as many it is not better known than by the square
            // root of their number.
            let one = 1e-6 * (42.0_f64 / 7.0 / 8.0).sqrt();
            assert!((error / (one / (highest as f64).sqrt()) - 1.0).abs() < 1e-6, "{highest}: {error}");
        }
        let blocks = Blocks { all: vec![], single: vec![], centres: vec![], rest: vec![], noise: vec![] };
        assert!(of_blocks(&blocks).delay(|_, _| Complex64::new(1.0, 0.0)).is_none());
    }

    /// Two modes at six places with noise of different sizes, many times: the mean square of the misfit is one.
    #[test]
    fn noise_alone_is_a_misfit_of_one() {
        let shape = |d: usize, k: usize| (1.3 * d as f64 * (k + 1) as f64 + 0.4).sin();
        let shapes: Vec<Vec<f64>> = (0..6).map(|d| (0..2).map(|k| shape(d, k)).collect()).collect();
        let positions: Vec<f64> = (0..6).map(f64::from).collect();
        let modes = LinearModes::new(&positions, &[100.0, 300.0], &[0.01; 2], &shapes).unwrap();
        let places: Vec<Place> =
            (0..6).map(|d| Place { position: Some(positions[d]), members: vec![(d, 0)] }).collect();
        let (noise, n_samples) = ([1e-3, 5e-3, 2e-3, 1e-3, 8e-3, 3e-3], 5000);
        let mut seed = 5_u64;
        let mut uniform = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let (mut squares, count) = (0.0, 400);
        for _ in 0..count {
            let fundamental = |d: usize, size: f64, draw: &mut dyn FnMut() -> f64| {
                let motion = Complex64::new(0.7, 0.2) * shape(d, 0) + Complex64::new(-0.1, 0.4) * shape(d, 1);
                // Uniform numbers of unit variance, in both parts.
                let own = size * (2.0 / n_samples as f64).sqrt() * 12_f64.sqrt();
                motion + Complex64::new(own * draw(), own * draw())
            };
            let all: Vec<Vec<Complex64>> =
                (0..6).map(|d| vec![Complex64::default(), fundamental(d, noise[d], &mut uniform)]).collect();
            let blocks = Blocks { all, single: vec![], centres: vec![], rest: vec![], noise: noise.to_vec() };
            let comparison = Comparison {
                blocks: &blocks,
                names: vec![""; 6],
                omega: 110.0,
                sample_rate: 1e4,
                n_samples,
                tolerances: Tolerances::default(),
            };
            squares += comparison.misfit(&modes, &places, &[0, 1, 2, 3, 4, 5], &blocks.all).unwrap().powi(2);
        }
        // Eight degrees of freedom a time: the mean of 400 is good to 2.5 %.
        assert!((squares / f64::from(count) - 1.0).abs() < 0.1, "{}", squares / f64::from(count));
    }
}

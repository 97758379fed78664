use std::collections::VecDeque;
use std::f64::consts::TAU;

use rand::SeedableRng;
use rand::rngs::Xoshiro256PlusPlus;
use rand_distr::{Distribution, Exp1};

use crate::rig::RigError;
use crate::rig::error::{finite, not_negative, positive};

/// What lies between a quantity and its samples, in the order in which the signal passes; by default nothing.
///
/// ```text
/// z = y + m a                          mass of a force cell on the side of the structure
/// z̈ + 2 ζ ω ż + ω² z = ω² y            resonance of a cell, anti-aliasing filter (ζ = 1/√2)
/// z(t − τ) + d t + h sin(2π f t) + noise
/// converter of so many bits; drop-outs, which repeat the last sample
/// ```
///
/// Cell and filter are states of the rig, as exact as its motion. The rest happens to samples.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chain {
    /// Mass that moves with the structure beyond a cell at the drive point, kg.
    pub mass: f64,
    /// Second-order stages one after the other.
    pub stages: Vec<Stage>,
    /// Delay `τ`, s.
    pub delay: f64,
    /// Drift `d`, units/s.
    pub drift: f64,
    /// Hum of the mains, if there is any.
    pub hum: Option<Hum>,
    /// Analogue-to-digital converter, if it is not perfect.
    pub converter: Option<Converter>,
    /// Drop-outs, if there are any.
    pub drop_outs: Option<DropOuts>,
}

/// A resonance with a static gain of one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    /// Angular eigenfrequency, rad/s.
    pub omega: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
}

/// Hum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hum {
    /// Amplitude, in the unit of the channel.
    pub amplitude: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
}

/// A converter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Converter {
    /// Largest size that it carries; beyond it clips. In the unit of the channel.
    pub range: f64,
    /// Bits, the sign included.
    pub bits: u32,
}

/// Drop-outs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DropOuts {
    /// How many a second, in the mean.
    pub rate: f64,
    /// Length of each, s.
    pub length: f64,
}

impl Stage {
    /// A Butterworth low-pass of second order.
    pub fn low_pass(cut_off_hz: f64) -> Self {
        Self { omega: TAU * cut_off_hz, damping_ratio: std::f64::consts::FRAC_1_SQRT_2 }
    }

    /// Flat in its delay, which is that of this time, s, for what is slow against it.
    pub(crate) fn of_delay(delay: f64) -> Self {
        let damping_ratio = 0.75_f64.sqrt();
        Self { omega: 2.0 * damping_ratio / delay, damping_ratio }
    }
}

impl Chain {
    pub(crate) fn check(&self) -> Result<(), RigError> {
        not_negative("mass of a cell (kg)", self.mass)?;
        not_negative("delay of a sensor (s)", self.delay)?;
        finite("drift of a sensor", self.drift)?;
        for stage in &self.stages {
            positive("frequency of a cell or filter (rad/s)", stage.omega)?;
            not_negative("damping ratio of a cell or filter", stage.damping_ratio)?;
        }
        if let Some(hum) = self.hum {
            finite("amplitude of the hum", hum.amplitude)?;
            positive("frequency of the hum (Hz)", hum.frequency_hz)?;
        }
        if let Some(converter) = self.converter {
            positive("range of a converter", converter.range)?;
            positive("bits of a converter less one", f64::from(converter.bits) - 1.0)?;
        }
        if let Some(drop_outs) = self.drop_outs {
            positive("rate of drop-outs (1/s)", drop_outs.rate)?;
            positive("length of drop-outs (s)", drop_outs.length)?;
        }
        Ok(())
    }

    /// The same without what happens to samples, but for the delay, which becomes a stage.
    pub(crate) fn smooth(&self) -> Self {
        let delay = (self.delay > 0.0).then(|| Stage::of_delay(self.delay));
        let stages = self.stages.iter().copied().chain(delay).collect();
        Self { mass: self.mass, stages, ..Self::default() }
    }
}

/// What a chain does to the samples of a channel.
#[derive(Debug, Clone)]
pub(crate) struct Samples {
    chain: Chain,
    /// Sampling interval, s.
    interval: f64,
    /// The last values of the quantity, the newest at the end.
    history: VecDeque<f64>,
    random: Xoshiro256PlusPlus,
    /// When the next drop-out begins, s.
    next: f64,
    last: Option<f64>,
}

impl Samples {
    pub(crate) fn new(chain: &Chain, interval: f64, seed: u64) -> Self {
        let random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut samples =
            Self { chain: chain.clone(), interval, history: VecDeque::new(), random, next: f64::INFINITY, last: None };
        samples.next = samples.pause();
        samples
    }

    /// Time between two drop-outs by lot, s.
    fn pause(&mut self) -> f64 {
        let unit: f64 = Exp1.sample(&mut self.random);
        self.chain.drop_outs.map_or(f64::INFINITY, |drop_outs| unit / drop_outs.rate)
    }

    /// The quantity at the next sample.
    pub(crate) fn push(&mut self, value: f64) {
        let needed = (self.chain.delay / self.interval).ceil() as usize + 3;
        self.history.push_back(value);
        while self.history.len() > needed {
            self.history.pop_front();
        }
    }

    /// The quantity a delay ago, with cubic interpolation; before the first sample it was as then.
    fn delayed(&self) -> f64 {
        let (whole, share) = {
            let samples = self.chain.delay / self.interval;
            (samples.floor(), samples.fract())
        };
        let at = |ago: f64| {
            let index = self.history.len() as f64 - 1.0 - ago.max(0.0);
            self.history.get(index.max(0.0) as usize).copied().unwrap_or(0.0)
        };
        if share == 0.0 {
            return at(whole);
        }
        // Nodes at one sample later and two earlier; less than a sample ago there is no later one.
        let first = if whole >= 1.0 { -1.0 } else { 0.0 };
        let nodes = [first, first + 1.0, first + 2.0, first + 3.0];
        let weight = |k: usize| -> f64 {
            (0..4).filter(|j| *j != k).map(|j| (share - nodes[j]) / (nodes[k] - nodes[j])).product()
        };
        (0..4).map(|k| weight(k) * at(whole + nodes[k])).sum()
    }

    /// The reading at `time`, with `noise` of the sensor.
    pub(crate) fn read(&mut self, time: f64, noise: f64) -> f64 {
        let hum = self.chain.hum.map_or(0.0, |hum| hum.amplitude * (TAU * hum.frequency_hz * time).sin());
        let mut value = self.delayed() + self.chain.drift * time + hum + noise;
        if let Some(Converter { range, bits }) = self.chain.converter {
            let step = range / 2.0_f64.powi(bits as i32 - 1);
            value = (value.clamp(-range, range - step) / step).round() * step;
        }
        if let (Some(drop_outs), Some(last)) = (self.chain.drop_outs, self.last) {
            if time >= self.next + drop_outs.length {
                self.next = time + self.pause();
            }
            if time >= self.next {
                return last;
            }
        }
        self.last = Some(value);
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INTERVAL: f64 = 1e-4;

    fn readings(chain: &Chain, of: impl Fn(f64) -> f64, count: usize) -> Vec<f64> {
        let mut samples = Samples::new(chain, INTERVAL, 3);
        let one = |k: usize| {
            let time = INTERVAL * k as f64;
            samples.push(of(time));
            samples.read(time, 0.0)
        };
        (0..count).map(one).collect()
    }

    #[test]
    fn a_delay_is_a_delay_also_of_parts_of_a_sample() {
        let of = |t: f64| (250.0 * t).sin();
        for delay in [1e-4, 3.3e-4, 0.4e-4, 7e-4] {
            let found = readings(&Chain { delay, ..Chain::default() }, of, 400);
            // The error of cubic interpolation is (ω h)⁴/24 at most outside of the nodes.
            let off = (20..400).map(|k| (found[k] - of(INTERVAL * k as f64 - delay)).abs()).fold(0.0, f64::max);
            assert!(off < 5e-8, "{delay}: {off}");
        }
    }

    #[test]
    fn drift_hum_and_converter_are_what_they_say() {
        let hum = Some(Hum { amplitude: 0.5, frequency_hz: 50.0 });
        let found = readings(&Chain { drift: 2.0, hum, ..Chain::default() }, |_| 1.0, 300);
        let expected = |k: usize| {
            let t = INTERVAL * k as f64;
            1.0 + 2.0 * t + 0.5 * (TAU * 50.0 * t).sin()
        };
        assert!((0..300).all(|k| (found[k] - expected(k)).abs() < 1e-12));
        let converter = Some(Converter { range: 1.0, bits: 8 });
        let found = readings(&Chain { converter, ..Chain::default() }, |t| 100.0 * (t - 0.01), 300);
        // 256 steps of 1/128 from −1 to 127/128.
        assert!(found.iter().all(|x| (x * 128.0).fract() == 0.0 && (-1.0..=127.0 / 128.0).contains(x)));
        assert!(found[0] == -1.0 && found[299] == 127.0 / 128.0 && (found[120] - 0.2).abs() <= 0.5 / 128.0);
    }

    #[test]
    fn drop_outs_repeat_the_last_sample_as_often_and_as_long_as_they_are_to() {
        let drop_outs = Some(DropOuts { rate: 5.0, length: 1e-2 });
        let found = readings(&Chain { drop_outs, ..Chain::default() }, |t| t, 400_000);
        let repeated = found.windows(2).filter(|pair| pair[0] == pair[1]).count() as f64 / 400_000.0;
        // 0.01 s in each 0.21 s; 190 of them, to one in fourteen.
        assert!((repeated * 21.0 - 1.0).abs() < 0.2, "{repeated}");
    }

    #[test]
    fn a_stage_of_a_delay_has_its_phase_for_slow_signals() {
        let (delay, omega) = (2e-4, 250.0);
        let Stage { omega: own, damping_ratio } = Stage::of_delay(delay);
        let lag = (2.0 * damping_ratio * own * omega).atan2(own * own - omega * omega);
        assert!((lag - omega * delay).abs() < 1e-7, "{lag}");
    }
}

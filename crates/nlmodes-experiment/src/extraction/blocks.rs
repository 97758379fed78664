//! Fourier coefficients of all periods together, and of single ones.

use num_complex::Complex64;

use crate::extraction::HarmonicFit;

/// Most blocks into which the periods are divided.
const MAX_BLOCKS: usize = 64;
/// Noise of a channel relative to its size below which it makes no difference.
const NOISELESS: f64 = 1e-12;

/// Coefficients of every channel: of all periods, and of each block of one or more periods.
#[derive(Debug, Clone)]
pub struct Blocks {
    /// Channels × harmonics, of all periods.
    pub all: Vec<Vec<Complex64>>,
    /// The same for each block.
    pub single: Vec<Vec<Vec<Complex64>>>,
    /// Instants of the middles of the blocks, s, from the middle of the window.
    pub centres: Vec<f64>,
    /// What the harmonics leave of each channel.
    pub rest: Vec<Vec<f64>>,
    /// Its root mean square, at least a trace of the signal's own.
    pub noise: Vec<f64>,
}

impl Blocks {
    /// Of the signals of a window of whole periods. Coefficients of a block are those of the whole plus those of what is left there: the
    /// rest is small, so that its leakage within a block is of second order.
    pub fn new(fit: &HarmonicFit, signals: &[&[f64]], periods: usize, sample_rate: f64) -> Self {
        let all = fit.coefficients(signals);
        let models = fit.signals(&all);
        let rest = |(signal, model): (&&[f64], &Vec<f64>)| signal.iter().zip(model).map(|(x, m)| x - m).collect();
        let rest: Vec<Vec<f64>> = signals.iter().zip(&models).map(rest).collect();
        let n = signals.first().map_or(0, |signal| signal.len());
        let per_block = periods.div_ceil(MAX_BLOCKS);
        let n_blocks = periods / per_block;
        let edge = |k: usize| (k * per_block * n / periods).min(n);
        let single = (0..n_blocks).map(|k| block(fit, &all, &rest, edge(k)..edge(k + 1))).collect();
        let middle = |k: usize| 0.5 * ((edge(k) + edge(k + 1)) as f64 - n as f64) / sample_rate;
        let rms = |x: &[f64]| (x.iter().map(|x| x * x).sum::<f64>() / x.len().max(1) as f64).sqrt();
        let noise = rest
            .iter()
            .zip(signals)
            .map(|(rest, signal)| rms(rest).max(NOISELESS * rms(signal)).max(f64::MIN_POSITIVE.sqrt()));
        Self { noise: noise.collect(), centres: (0..n_blocks).map(middle).collect(), all, single, rest }
    }
}

fn block(
    fit: &HarmonicFit,
    all: &[Vec<Complex64>],
    rest: &[Vec<f64>],
    samples: std::ops::Range<usize>,
) -> Vec<Vec<Complex64>> {
    let scale = 2.0 / samples.len().max(1) as f64;
    let mut coefficients = all.to_vec();
    let mut powers = vec![Complex64::default(); fit.n_harmonics() + 1];
    for j in samples {
        fit.powers(j, &mut powers);
        for (q, rest) in coefficients.iter_mut().zip(rest) {
            let x = scale * rest[j];
            q.iter_mut().zip(&powers).for_each(|(q, power)| *q += power.conj() * x);
        }
    }
    // The mean has half the factor.
    for (q, all) in coefficients.iter_mut().zip(all) {
        q[0] = 0.5 * (q[0] + all[0]);
    }
    coefficients
}

/// Takes the delay of a channel out of its coefficients: it recorded late, so harmonic `n` is turned forward by `nω·delay`.
pub fn take_out_delay(coefficients: &mut [Complex64], omega: f64, delay: f64) {
    for (n, q) in coefficients.iter_mut().enumerate() {
        *q *= Complex64::cis(n as f64 * omega * delay);
    }
}

//! Fourier coefficients of all periods together, and of single ones.

use std::ops::Range;

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
    /// Root mean square of what the harmonics leave of each channel.
    pub rest: Vec<f64>,
    /// The same, at least a trace of the signal's own.
    pub noise: Vec<f64>,
}

impl Blocks {
    /// Of the signals of a window of whole periods. Coefficients of a block are those of the whole plus those of what
    /// is left there: the rest is small, so that its leakage within a block is of second order.
    pub fn new(fit: &HarmonicFit, signals: &[&[f64]], periods: usize, sample_rate: f64) -> Self {
        let all = fit.coefficients(signals);
        let n = signals.first().map_or(0, |signal| signal.len());
        let per_block = periods.div_ceil(MAX_BLOCKS);
        let n_blocks = periods / per_block;
        let edge = |k: usize| (k * per_block * n / periods).min(n);
        let blocks: Vec<Range<usize>> = (0..n_blocks).map(|k| edge(k)..edge(k + 1)).collect();
        let (squares, sums) = fit.rests(signals, &all, &blocks);
        let single = blocks.iter().zip(&sums).map(|(samples, sums)| block(&all, sums, samples.len())).collect();
        let middle = |k: usize| 0.5 * ((edge(k) + edge(k + 1)) as f64 - n as f64) / sample_rate;
        let rms = |square: f64| (square / n.max(1) as f64).sqrt();
        let rest: Vec<f64> = squares.into_iter().map(rms).collect();
        let noise = rest.iter().zip(signals).map(|(rest, signal)| {
            let own = rms(signal.iter().map(|x| x * x).sum());
            rest.max(NOISELESS * own).max(f64::MIN_POSITIVE.sqrt())
        });
        Self { noise: noise.collect(), centres: (0..n_blocks).map(middle).collect(), all, single, rest }
    }
}

/// Coefficients of a block of so many samples, from `Σ_j x_j e^{inψ_j}` of what all harmonics leave there.
fn block(all: &[Vec<Complex64>], sums: &[Vec<Complex64>], samples: usize) -> Vec<Vec<Complex64>> {
    let scale = 2.0 / samples.max(1) as f64;
    let own = |(all, sums): (&Vec<Complex64>, &Vec<Complex64>)| {
        let mut q: Vec<Complex64> = all.iter().zip(sums).map(|(q, sum)| q + sum.conj() * scale).collect();
        // The mean has half the factor.
        q[0] = 0.5 * (q[0] + all[0]);
        q
    };
    all.iter().zip(sums).map(own).collect()
}

/// Takes the delay of a channel out of its coefficients: it recorded late, so harmonic `n` is turned forward by
/// `nω·delay`.
pub fn take_out_delay(coefficients: &mut [Complex64], omega: f64, delay: f64) {
    for (n, q) in coefficients.iter_mut().enumerate() {
        *q *= Complex64::cis(n as f64 * omega * delay);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four periods of 100 samples, each with its own mean and amplitudes: those of a block are its own discrete
    /// Fourier sums.
    #[test]
    fn blocks_have_their_own_means_and_amplitudes() {
        let (n, step) = (400, std::f64::consts::TAU / 100.0);
        let fit = HarmonicFit::new(3, step, n).unwrap();
        let at = |j: usize| {
            let (k, phase) = ((j / 100) as f64, fit.phase(j));
            1.0 + 0.1 * k * k + (1.0 + 0.02 * k) * (phase - 0.3 * k).cos() - 0.2 * (2.0 * phase).sin()
        };
        let signal: Vec<f64> = (0..n).map(at).collect();
        let blocks = Blocks::new(&fit, &[&signal], 4, 50.0);
        assert_eq!((blocks.single.len(), blocks.all.len()), (4, 1));
        for (k, found) in blocks.single.iter().enumerate() {
            let samples = 100 * k..100 * (k + 1);
            let mean = samples.clone().map(|j| signal[j]).sum::<f64>() / 100.0;
            assert!((found[0][0].re - mean).abs() < 1e-12 && found[0][0].im.abs() < 1e-12, "{k}: {}", found[0][0]);
            for (order, own) in found[0].iter().enumerate().skip(1) {
                let term = |j: usize| signal[j] * Complex64::cis(-(order as f64) * fit.phase(j)) / 50.0;
                let expected: Complex64 = samples.clone().map(term).sum();
                assert!((own - expected).norm() < 1e-12, "{k}, {order}: {own}");
            }
        }
        // Two seconds a period, counted from the middle.
        assert!(
            blocks.centres.iter().zip([-3.0, -1.0, 1.0, 3.0]).all(|(a, b)| (a - b).abs() < 1e-12),
            "{:?}",
            blocks.centres
        );
        let (model, _) = fit.synthesize(&blocks.all[0]);
        let rest: f64 = signal.iter().zip(&model).map(|(x, m)| (x - m).powi(2)).sum::<f64>() / n as f64;
        assert!((blocks.noise[0] / rest.sqrt() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn many_periods_share_blocks() {
        let fit = HarmonicFit::new(1, std::f64::consts::TAU / 10.0, 1300).unwrap();
        let signal: Vec<f64> = (0..1300).map(|j| fit.phase(j).cos()).collect();
        let blocks = Blocks::new(&fit, &[&signal], 130, 1.0);
        // Three periods each: 43 blocks, and one period is left.
        assert_eq!(blocks.single.len(), 43);
        assert!(blocks.single.iter().all(|q| (q[0][1] - 1.0).norm() < 1e-9 && q[0][0].norm() < 1e-9));
        // A signal without noise keeps a trace of its size as such.
        assert!((blocks.noise[0] * 1e12 - 0.5_f64.sqrt()).abs() < 1e-2, "{:e}", blocks.noise[0]);
    }

    #[test]
    fn a_delay_that_is_taken_out_turns_harmonics_forward() {
        let (omega, delay) = (30.0, 0.002);
        let mut q =
            [Complex64::new(2.0, 0.0), Complex64::cis(-omega * delay), Complex64::cis(0.4 - 2.0 * omega * delay)];
        take_out_delay(&mut q, omega, delay);
        let expected = [Complex64::new(2.0, 0.0), Complex64::ONE, Complex64::cis(0.4)];
        assert!(q.iter().zip(&expected).all(|(q, e)| (q - e).norm() < 1e-14), "{q:?}");
    }
}

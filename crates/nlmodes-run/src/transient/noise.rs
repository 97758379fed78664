//! Noise with an even spectrum in a band.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};
use rustfft::FftPlanner;

use crate::course::Cubics;

/// Instants in a period of the highest frequency: cubic pieces through values and rates are then right to 1e-6.
const PER_PERIOD: f64 = 32.0;

/// Most instants.
const MOST: usize = 1 << 25;

/// Noise of this effective value from `start` on for a length, as a sum of cosines of equal amplitude at all multiples
/// of the inverse of its length in the band, with phases from the seed.
///
/// # Errors
/// What is wrong with the band, in words.
pub fn noise(rms: f64, band_hz: [f64; 2], seed: u32, [start, length]: [f64; 2]) -> Result<Cubics, String> {
    let n = (length * PER_PERIOD * band_hz[1]).ceil().max(2.0);
    if n > MOST as f64 {
        return Err(format!("noise up to {} Hz over {length} s has too many instants: {n:e}", band_hz[1]));
    }
    let n = (n as usize).next_power_of_two();
    let interval = length / n as f64;
    let lines: Vec<usize> = (1..n / 2).filter(|k| within(*k as f64 / length, band_hz)).collect();
    if lines.is_empty() {
        let apart = 1.0 / length;
        return Err(format!("within {length} s the lines of a spectrum are {apart} Hz apart, and none is in the band"));
    }
    let amplitude = rms * (2.0 / lines.len() as f64).sqrt();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(u64::from(seed));
    let (mut values, mut rates) = (vec![Complex64::default(); n], vec![Complex64::default(); n]);
    for k in lines {
        let phase: f64 = TAU * random.random::<f64>();
        values[k] = Complex64::from_polar(amplitude, phase);
        rates[k] = values[k] * Complex64::new(0.0, TAU * k as f64 / length);
    }
    let inverse = FftPlanner::new().plan_fft_inverse(n);
    let real = |mut spectrum: Vec<Complex64>| -> Vec<f64> {
        inverse.process(&mut spectrum);
        // The last instant is the first one of the next period.
        spectrum.iter().chain(spectrum.first()).map(|z| z.re).collect()
    };
    let (values, rates) = (real(values), real(rates));
    Ok(Cubics { start, interval, values, rates })
}

fn within(hz: f64, [low, high]: [f64; 2]) -> bool {
    (low..=high).contains(&hz)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_its_effective_value_and_band_and_is_the_same_for_the_same_seed() {
        let of = |seed| noise(2.0, [10.0, 40.0], seed, [0.0, 3.0]).unwrap();
        let found = of(5);
        let n = found.values.len() - 1;
        let square = found.values[..n].iter().map(|v| v * v).sum::<f64>() / n as f64;
        assert!((square - 4.0).abs() < 1e-12, "{square}");
        // 91 lines of a third of a hertz, whose rates have the mean square of their frequencies.
        let expected: f64 = (30..=120).map(|k| (TAU * f64::from(k) / 3.0).powi(2)).sum::<f64>() / 91.0;
        let found_rate = found.rates[..n].iter().map(|v| v * v).sum::<f64>() / n as f64 / square;
        assert!((found_rate / expected - 1.0).abs() < 1e-12);
        assert_eq!(found.values, of(5).values);
        assert_ne!(found.values, of(6).values);
        assert!(noise(1.0, [10.1, 10.2], 0, [0.0, 1.0]).is_err());
    }
}

//! Whether a history has two lines.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rustfft::FftPlanner;

/// Lines of a history that is not periodic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoLines {
    /// The lowest difference of lines, in periods of the load: between 0 and ½.
    pub beat: f64,
    /// The strongest line that is no multiple of the load, as a multiple of its frequency.
    pub second: f64,
}

/// Share of the largest line, once those of the load are left out, above which a line counts.
const COUNTED: f64 = 3e-3;

/// Most multiples of the beat that are looked for.
const MULTIPLES: usize = 40;

/// By how many distances of lines of the spectrum a line may be off.
const OFF: f64 = 1.5;

/// The two frequencies of a history with `n` values in each period of the load, if all that counts in its spectrum
/// is a sum of multiples of these.
pub fn two_lines(values: &[f64], n: usize) -> Option<TwoLines> {
    let length = values.len();
    let periods = length / n;
    if periods < 64 {
        return None;
    }
    let mean = values.iter().sum::<f64>() / length as f64;
    // The window of Blackman and Harris: what leaks is below 1e-4 from four lines on.
    let window = |k: usize| {
        let turn = TAU * k as f64 / length as f64;
        0.35875 - 0.48829 * turn.cos() + 0.14128 * (2.0 * turn).cos() - 0.01168 * (3.0 * turn).cos()
    };
    let mut all: Vec<Complex64> =
        values.iter().enumerate().map(|(k, v)| Complex64::from((v - mean) * window(k))).collect();
    FftPlanner::new().plan_fft_forward(length).process(&mut all);
    // Lines are `1/periods` of the frequency of the load apart.
    let size: Vec<f64> = all[..length / 2].iter().map(|z| z.norm()).collect();
    let is_of_load = |k: usize| k % periods <= 4 || k % periods >= periods - 4;
    let largest = (0..size.len()).filter(|k| !is_of_load(*k)).map(|k| size[k]).fold(0.0, f64::max);
    let is_peak = |k: usize| size[k] >= size[k - 1] && size[k] > size[k + 1] && size[k] > COUNTED * largest;
    let peaks: Vec<usize> = (1..size.len() - 1).filter(|k| !is_of_load(*k) && is_peak(*k)).collect();
    let strongest = peaks.iter().copied().max_by(|a, b| size[*a].total_cmp(&size[*b]))?;
    let place = |k: usize| k as f64 + refined([size[k - 1], size[k], size[k + 1]]);
    let second = place(strongest) / periods as f64;
    let folded = |x: f64| (x - x.round()).abs();
    // The beat is the offset of a strong line, or a part of it.
    let fits = |beat: f64, at: f64| {
        (1..=MULTIPLES)
            .any(|m| (folded(at) - folded(m as f64 * beat)).abs() < OFF * (1.0 + m as f64 / 10.0) / periods as f64)
    };
    let beat = folded(second);
    let explained = peaks.iter().all(|k| fits(beat, place(*k) / periods as f64));
    // Where nearly every place is a multiple, that all are says nothing.
    let covered = (2 * MULTIPLES) as f64 * OFF * 2.0 / periods as f64;
    (explained && covered < 0.5).then_some(TwoLines { beat, second })
}

/// By how much a peak between three lines is off the middle one: a parabola through their logarithms.
fn refined(size: [f64; 3]) -> f64 {
    let [a, b, c] = size.map(|v| v.max(f64::MIN_POSITIVE).ln());
    let bend = a - 2.0 * b + c;
    if bend < 0.0 { (0.5 * (a - c) / bend).clamp(-0.5, 0.5) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_lines_and_their_sums_are_told_from_three_and_from_noise() {
        let at = |k: usize| k as f64 / 16.0;
        let of = |f: &dyn Fn(f64) -> f64| (0..16 * 1024).map(|k| f(at(k))).collect::<Vec<f64>>();
        let two = of(&|t| {
            let b = TAU * 0.234_567 * t;
            (TAU * t).cos() * (1.0 + 0.3 * b.cos()) + 0.05 * (2.0 * b + 0.3).cos()
        });
        let found = two_lines(&two, 16).unwrap();
        assert!((found.beat - 0.234_567).abs() < 1e-4, "{found:?}");
        let third = (TAU * 2.0_f64.sqrt(), 0.1);
        let three: Vec<f64> = two.iter().enumerate().map(|(k, v)| v + third.1 * (third.0 * at(k)).cos()).collect();
        assert_eq!(two_lines(&three, 16), None);
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let noisy: Vec<f64> = two.iter().map(|v| v + 2.0 * random()).collect();
        assert_eq!(two_lines(&noisy, 16), None);
    }
}

use nlmodes_modal::HarmonicBasis;

/// Frequency of the largest peak of the spectrum, in cycles a sample; `None` where there is none.
///
/// A Hann window keeps the mean and slow trends from covering the peak; its place between the lines comes from the
/// parabola through their logarithms.
pub fn strongest_frequency(signal: &[f64]) -> Option<f64> {
    let n = signal.len();
    let mean = signal.iter().sum::<f64>() / n as f64;
    let hann = |j: usize| 0.5 - 0.5 * (std::f64::consts::TAU * (j as f64 + 0.5) / n as f64).cos();
    let windowed: Vec<f64> = signal.iter().enumerate().map(|(j, x)| (x - mean) * hann(j)).collect();
    let lines = n.checked_sub(1)? / 2;
    let mut spectrum = vec![num_complex::Complex64::default(); lines + 1];
    HarmonicBasis::new(lines, n).ok()?.analyze(&windowed, &mut spectrum);
    let size: Vec<f64> = spectrum.iter().map(|z| z.norm()).collect();
    let peak = (1..lines).filter(|k| size[*k] > 0.0).max_by(|a, b| size[*a].total_cmp(&size[*b]))?;
    let [left, middle, right] = [size[peak - 1], size[peak], size[peak + 1]].map(|x| x.max(f64::MIN_POSITIVE).ln());
    let bend = left - 2.0 * middle + right;
    let shift = if bend < 0.0 { 0.5 * (left - right) / bend } else { 0.0 };
    Some((peak as f64 + shift.clamp(-0.5, 0.5)) / n as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_found_between_the_lines() {
        for periods in [2.0, 2.4, 3.3, 20.7] {
            let n = 1000;
            let f = periods / f64::from(n);
            let wave = |j: i32| (std::f64::consts::TAU * f * f64::from(j) + 0.4).cos();
            let signal: Vec<f64> = (0..n).map(|j| 5.0 + wave(j)).collect();
            let found = strongest_frequency(&signal).unwrap();
            // The parabola through the logarithms of a Hann window's lines is off by 0.016 lines at most.
            assert!((found - f).abs() < 0.02 / f64::from(n), "{periods}: {}", found * f64::from(n));
        }
        assert_eq!(strongest_frequency(&[1.0; 50]), None);
        assert_eq!(strongest_frequency(&[]), None);
    }
}

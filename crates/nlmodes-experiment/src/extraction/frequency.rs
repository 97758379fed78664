use std::borrow::Cow;

use crate::extraction::{ExtractionError, HarmonicFit, Measured};

/// Harmonics of the stages: the fundamental alone has the widest basin, all of them the least bias.
const STAGES: [usize; 3] = [1, 3, 10];
/// Most Gauss-Newton steps of a stage.
const MAX_STEPS: usize = 30;
/// Relative step at which a frequency is found; the steps converge quadratically, so that the one after it is lost in
/// rounding.
const CONVERGED: f64 = 1e-9;
/// The same for the stages before the last.
const NEAR: f64 = 1e-4;

/// Samples of a record from which on it is thinned out for the stages.
const MANY: usize = 1 << 17;
/// Samples of a period and harmonic that are left of it.
const LEFT: f64 = 4.0;
/// The same of a period, at least.
const LEAST: f64 = 32.0;

/// Refines a phase step (rad a sample) so that its harmonics fit the signal best: Gauss-Newton on the least-squares
/// problem in coefficients and frequency, with the coefficients eliminated (variable projection).
///
/// `harmonics` are taken in the end. `None` if it leaves the neighbourhood of the start, or finds nothing.
pub fn refine(signal: &[f64], start: f64, harmonics: usize) -> Option<f64> {
    let mut step = start;
    // Beyond half a line of the spectrum lies another minimum.
    let reach = 0.7 * std::f64::consts::TAU / signal.len() as f64;
    let harmonics = harmonics.max(1);
    for stage in STAGES.into_iter().filter(|stage| *stage < harmonics).chain(std::iter::once(harmonics)) {
        let enough = if stage == harmonics { CONVERGED } else { NEAR };
        let (thin, factor) = thinned(signal, start, stage);
        for _ in 0..MAX_STEPS {
            let change = gauss_newton(&thin, step * factor, stage)?;
            step *= 1.0 + change.clamp(-0.1, 0.1);
            if !step.is_finite() || (step - start).abs() > reach {
                return None;
            }
            if change.abs() < enough {
                break;
            }
        }
    }
    Some(step)
}

/// Means of as many neighbours as leave enough samples of a period for so many harmonics, where there are many, and how
/// many they are of: a periodic signal stays one of the same period.
fn thinned(signal: &[f64], step: f64, harmonics: usize) -> (Cow<'_, [f64]>, f64) {
    let wanted = (LEFT * harmonics as f64).max(LEAST);
    let factor = (std::f64::consts::TAU / step / wanted) as usize;
    if signal.len() < MANY || factor < 2 {
        return (Cow::Borrowed(signal), 1.0);
    }
    let mean = |near: &[f64]| near.iter().sum::<f64>() / factor as f64;
    (Cow::Owned(signal.chunks_exact(factor).map(mean).collect()), factor as f64)
}

/// Relative change of the frequency.
fn gauss_newton(signal: &[f64], step: f64, harmonics: usize) -> Option<f64> {
    let fit = HarmonicFit::new(harmonics, step, signal.len()).ok()?;
    let (model, slope) = fit.synthesize(&fit.coefficients(&[signal])[0]);
    // What the coefficients cannot give of a change in frequency.
    let (given, _) = fit.synthesize(&fit.coefficients(&[&slope])[0]);
    let own: Vec<f64> = slope.iter().zip(&given).map(|(slope, given)| slope - given).collect();
    let square: f64 = own.iter().map(|d| d * d).sum();
    let product: f64 = own.iter().zip(signal.iter().zip(&model)).map(|(d, (x, m))| d * (x - m)).sum();
    (square > 0.0).then_some(product / square)
}

/// Frequency (rad/s) of a phase channel over its samples, with its standard error: the slope of the line through the
/// unwrapped phase.
///
/// # Errors
/// [`ExtractionError::NoFrequency`] if the phase does not advance.
pub fn from_phase(phase: &[f64], sample_rate: f64, channel: &str) -> Result<Measured, ExtractionError> {
    let unwrapped = unwrap(phase);
    let n = unwrapped.len() as f64;
    let centre = 0.5 * (n - 1.0);
    let mean = unwrapped.iter().sum::<f64>() / n;
    let square: f64 = (0..unwrapped.len()).map(|j| (j as f64 - centre).powi(2)).sum();
    let product: f64 = unwrapped.iter().enumerate().map(|(j, x)| (j as f64 - centre) * (x - mean)).sum();
    let slope = product / square;
    let rest: f64 = unwrapped.iter().enumerate().map(|(j, x)| (x - mean - slope * (j as f64 - centre)).powi(2)).sum();
    if !(slope > 0.0 && slope < std::f64::consts::PI) {
        let guess_hz = slope * sample_rate / std::f64::consts::TAU;
        return Err(ExtractionError::NoFrequency { guess_hz, channel: channel.to_owned() });
    }
    let error = (rest / (n - 2.0).max(1.0) / square).sqrt();
    Ok(Measured { value: slope * sample_rate, uncertainty: error * sample_rate })
}

/// The phase without the jumps of full turns.
fn unwrap(phase: &[f64]) -> Vec<f64> {
    let mut turns = 0.0;
    let mut unwrapped = Vec::with_capacity(phase.len());
    for (j, x) in phase.iter().enumerate() {
        if j > 0 {
            turns -= std::f64::consts::TAU * ((x - phase[j - 1]) / std::f64::consts::TAU).round();
        }
        unwrapped.push(x + turns);
    }
    unwrapped
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn signal(f: f64, periods: f64, rate: f64) -> Vec<f64> {
        let n = (periods * rate / f) as usize;
        let wave = |t: f64| {
            1.0 + (TAU * f * t + 0.3).cos() + 0.2 * (2.0 * TAU * f * t).sin() + 0.05 * (7.0 * TAU * f * t + 1.0).cos()
        };
        (0..n).map(|j| wave(j as f64 / rate)).collect()
    }

    #[test]
    fn the_frequency_of_a_clean_signal_is_found_to_rounding() {
        for periods in [2.0, 2.6, 5.3, 20.0] {
            let (f, rate) = (40.1, 20_000.0);
            let found = refine(&signal(f, periods, rate), TAU * f / rate * (1.0 + 0.2 / periods), 20).unwrap();
            assert!((found * rate / TAU / f - 1.0).abs() < 1e-11, "{periods}: {}", found * rate / TAU);
        }
    }

    /// Twenty seconds, of which means are taken.
    #[test]
    fn long_records_have_the_same_frequency() {
        let (f, rate) = (40.1, 51_200.0);
        let long = signal(f, 400.0, rate);
        assert!(long.len() > MANY && thinned(&long, TAU * f / rate, 20).1 > 10.0);
        let found = refine(&long, TAU * f / rate * (1.0 + 3e-4), 20).unwrap();
        assert!((found * rate / TAU / f - 1.0).abs() < 1e-11, "{}", found * rate / TAU);
    }

    #[test]
    fn far_from_any_frequency_none_is_found() {
        assert_eq!(refine(&signal(40.1, 20.0, 20_000.0), TAU * 60.0 / 20_000.0, 5), None);
        assert_eq!(refine(&[0.0; 500], 0.1, 5), None);
    }

    #[test]
    fn a_phase_that_wraps_has_its_slope() {
        let phase: Vec<f64> = (0..5000).map(|j| (6.1 + 0.013 * f64::from(j)) % TAU).collect();
        let found = from_phase(&phase, 20_000.0, "p").unwrap();
        assert!((found.value - 260.0).abs() < 1e-9 && found.uncertainty < 1e-9, "{found:?}");
        assert!(from_phase(&[1.0; 10], 1.0, "p").is_err());
    }

    /// With a part that is not periodic the least of the squares is not zero; the frequency is the fixed point of
    /// Gauss-Newton.
    #[test]
    fn the_frequency_found_is_a_stationary_point_of_the_least_squares() {
        let (f, rate, periods) = (40.1, 20_000.0, 5.3);
        let mut disturbed = signal(f, periods, rate);
        disturbed.iter_mut().enumerate().for_each(|(j, x)| *x += 0.3 * (TAU * 61.7 * j as f64 / rate).cos());
        let found = refine(&disturbed, TAU * f / rate * 1.01, 20).unwrap();
        let change = gauss_newton(&disturbed, found, 20).unwrap();
        assert!(change.abs() < 1e-9, "{change:e}");
        let left = |step: f64| {
            let fit = HarmonicFit::new(20, step, disturbed.len()).unwrap();
            let (model, _) = fit.synthesize(&fit.coefficients(&[&disturbed])[0]);
            disturbed.iter().zip(&model).map(|(x, m)| (x - m).powi(2)).sum::<f64>()
        };
        assert!(left(found * 1.0001) > left(found) && left(found * 0.9999) > left(found));
    }

    /// A slope has the standard error of the textbook: the scatter about the line over the spread of the instants.
    #[test]
    fn the_slope_of_a_phase_has_its_standard_error() {
        let n = 400;
        let noise = |j: i32| if j % 2 == 0 { 0.01 } else { -0.01 };
        let phase: Vec<f64> = (0..n).map(|j| (0.3 + 0.05 * f64::from(j) + noise(j)) % TAU).collect();
        let found = from_phase(&phase, 1000.0, "p").unwrap();
        let spread: f64 = (0..n).map(|j| (f64::from(j) - 199.5).powi(2)).sum();
        let expected = 1000.0 * 0.01 * (f64::from(n) / f64::from(n - 2) / spread).sqrt();
        assert!((found.value - 50.0).abs() < 3.0 * expected, "{found:?}");
        assert!((found.uncertainty / expected - 1.0).abs() < 1e-4, "{found:?} {expected}");
    }
}

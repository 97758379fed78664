//! Frequency and amplitude over the periods.

use num_complex::Complex64;

use crate::extraction::loss::least_squares;
use crate::extraction::measured::wrapped;
use crate::extraction::{Finding, Tolerances};

/// Standard errors that a drift must exceed to be reported.
const SIGNIFICANT: f64 = 5.0;
/// Steps to the phase of a block.
const STEPS: usize = 2;
/// Share of the force's power from which on that of growth or decay is reported.
const SMALL: f64 = 0.1;

/// Fundamental of the reference over the blocks.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Drift {
    /// Standard error of the frequency, rad/s.
    pub omega_error: f64,
    /// Change of frequency over the window, rad/s, with its standard error.
    pub omega_change: (f64, f64),
    /// Change of the amplitude over the window, relative, with its standard error.
    pub amplitude_change: (f64, f64),
    /// Rate at which the amplitude grows, 1/s, with its standard error.
    pub growth: (f64, f64),
    /// Scatter about a smooth course from block to block, over the amplitude.
    pub scatter: f64,
}

impl Drift {
    /// Of the harmonics (from the mean on) of the blocks, at their instants (s), next to those of all. A single block
    /// tells nothing.
    pub fn new(all: &[Complex64], single: &[&[Complex64]], centres: &[f64]) -> Self {
        let phases: Vec<f64> = single.iter().map(|q| phase(all, q)).collect();
        let sizes: Vec<f64> = single.iter().map(|q| (q[1] / all[1]).norm()).collect();
        let duration = match centres {
            [first, .., last] => (last - first) * centres.len() as f64 / (centres.len() - 1) as f64,
            _ => f64::NAN,
        };
        let half = 0.5 * duration;
        let line = fit(centres, &phases, |t| t / half);
        // Phase u² − mean: the frequency changes by 4/half from one end of the window to the other.
        let mean = centres.iter().map(|t| (t / half).powi(2)).sum::<f64>() / centres.len() as f64;
        let bend = fit(centres, &phases, |t| (t / half).powi(2) - mean);
        let slope = fit(centres, &sizes, |t| t / half);
        let logarithms: Vec<f64> = sizes.iter().map(|size| size.ln()).collect();
        let growth = fit(centres, &logarithms, |t| t / half);
        Self {
            scatter: scatter(&phases, &logarithms),
            omega_error: line.1 / half * persistence(&phases),
            omega_change: (4.0 * bend.0 / half, 4.0 * bend.1 / half),
            amplitude_change: (2.0 * slope.0, 2.0 * slope.1),
            growth: (growth.0 / half, growth.1 / half),
        }
    }

    /// Reports drifts that exceed tolerance and noise.
    pub fn report(&self, omega: f64, tolerances: &Tolerances, findings: &mut Vec<Finding>) {
        if self.frequency_drifts(tolerances, omega) {
            let change = self.omega_change.0;
            let change_hz = change / std::f64::consts::TAU;
            findings.push(Finding::FrequencyDrift { change_hz, relative: change / omega });
        }
        if self.amplitude_drifts(tolerances) {
            findings.push(Finding::AmplitudeDrift { relative: self.amplitude_change.0 });
        }
    }

    /// Whether frequency or amplitude drift beyond tolerance and noise.
    pub fn is_drifting(&self, tolerances: &Tolerances, omega: f64) -> bool {
        self.frequency_drifts(tolerances, omega) || self.amplitude_drifts(tolerances)
    }

    fn frequency_drifts(&self, tolerances: &Tolerances, omega: f64) -> bool {
        let (change, error) = self.omega_change;
        change.abs() > (tolerances.frequency_drift * omega).max(SIGNIFICANT * error)
    }

    fn amplitude_drifts(&self, tolerances: &Tolerances) -> bool {
        let (relative, error) = self.amplitude_change;
        relative.abs() > tolerances.amplitude_drift.max(SIGNIFICANT * error)
    }

    /// Reports a vibration whose own energy is not small against what the force brings in: `damping` is what its power
    /// gives, eq. (28).
    pub fn transient(&self, omega: f64, damping: Option<f64>, tolerances: &Tolerances, findings: &mut Vec<Finding>) {
        let (rate, error) = self.growth;
        let own = rate.abs() / omega;
        if self.amplitude_drifts(tolerances) && damping.is_none_or(|damping| own > SMALL * damping.abs()) {
            findings.push(Finding::Transient {
                damping: -rate / omega,
                uncertainty: error / omega,
                from_force: damping,
            });
        }
    }
}

/// Phase of the fundamental by which a block is behind all of them: that of all harmonics together, as the frequency is
/// found by all of them.
fn phase(all: &[Complex64], block: &[Complex64]) -> f64 {
    let weight: f64 = all.iter().enumerate().map(|(n, q)| (n as f64).powi(2) * q.norm_sqr()).sum();
    let mut phase = (block[1] / all[1]).arg();
    for _ in 0..STEPS {
        let term = |(n, (q, own)): (usize, (&Complex64, &Complex64))| {
            n as f64 * (q.conj() * own * Complex64::cis(-(n as f64) * phase)).im
        };
        phase += all.iter().zip(block).enumerate().map(term).sum::<f64>() / weight;
    }
    wrapped(phase)
}

/// Root mean square that parabolas leave of phase and logarithm of the size; zero with too few blocks for that.
fn scatter(phases: &[f64], logarithms: &[f64]) -> f64 {
    let left = |values: &[f64]| {
        let row = |(k, x): (usize, &f64)| (vec![1.0, k as f64, (k as f64).powi(2)], *x);
        let rows: Vec<(Vec<f64>, f64)> = values.iter().enumerate().map(row).collect();
        least_squares(&rows).map_or(0.0, |(_, _, left)| left)
    };
    left(phases).hypot(left(logarithms))
}

/// By how much the error of a slope is larger than that of independent values, where neighbours about the line are
/// alike: by `√((1 + ρ)/(1 − ρ))` of their correlation ρ, as far as that is significant.
fn persistence(values: &[f64]) -> f64 {
    let row = |(k, x): (usize, &f64)| (vec![1.0, k as f64], *x);
    let rows: Vec<(Vec<f64>, f64)> = values.iter().enumerate().map(row).collect();
    let Some((line, ..)) = least_squares(&rows) else { return 1.0 };
    let rest: Vec<f64> = rows.iter().map(|(row, x)| x - line[0] - line[1] * row[1]).collect();
    let square: f64 = rest.iter().map(|x| x * x).sum();
    let together: f64 = rest.windows(2).map(|pair| pair[0] * pair[1]).sum();
    let n = values.len() as f64;
    let correlation = (together / square).clamp(-0.99, 0.99);
    if correlation > 2.0 / n.sqrt() { ((1.0 + correlation) / (1.0 - correlation)).sqrt() } else { 1.0 }
}

/// Factor of a shape in the values, beside line and mean where the shape is even, with its standard error; NaN with
/// fewer than four values.
fn fit(t: &[f64], values: &[f64], shape: impl Fn(f64) -> f64) -> (f64, f64) {
    let n = values.len() as f64;
    if n < 4.0 {
        return (f64::NAN, f64::NAN);
    }
    let centre = t.iter().sum::<f64>() / n;
    let shapes: Vec<f64> = t.iter().map(|t| shape(*t)).collect();
    let (mean, mean_shape) = (values.iter().sum::<f64>() / n, shapes.iter().sum::<f64>() / n);
    let (mut square, mut product) = (0.0, 0.0);
    for (s, x) in shapes.iter().zip(values) {
        square += (s - mean_shape).powi(2);
        product += (s - mean_shape) * (x - mean);
    }
    let factor = product / square;
    // Scatter about shape and line together: blocks are even in time, so both are orthogonal or the same.
    let line: f64 = t.iter().zip(values).map(|(t, x)| (t - centre) * (x - mean)).sum::<f64>()
        / t.iter().map(|t| (t - centre).powi(2)).sum::<f64>();
    let odd = (shape(1.0) + shape(-1.0)).abs() < 1e-12 * shape(1.0).abs();
    let rest = |(t, (s, x)): (&f64, (&f64, &f64))| {
        let line = if odd { 0.0 } else { line * (t - centre) };
        (x - mean - line - factor * (s - mean_shape)).powi(2)
    };
    let rest: f64 = t.iter().zip(shapes.iter().zip(values)).map(rest).sum();
    (factor, (rest / (n - 3.0).max(1.0) / square).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chirp_and_a_decay_have_their_numbers() {
        let centres: Vec<f64> = (0..20).map(|k| (f64::from(k) - 9.5) * 0.025).collect();
        let all = Complex64::new(0.3, -0.4);
        // Frequency 2 rad/s higher at the end of the half second than at its beginning; 1 % less amplitude.
        let all = [Complex64::default(), all];
        let single: Vec<[Complex64; 2]> = centres
            .iter()
            .map(|t| all.map(|q| q * Complex64::from_polar(1.0 - 0.01 * t / 0.5, 2.0 * t * t / (2.0 * 0.5))))
            .collect();
        let single: Vec<&[Complex64]> = single.iter().map(|q| &q[..]).collect();
        let drift = Drift::new(&all, &single, &centres);
        assert!((drift.omega_change.0 - 2.0).abs() < 1e-9, "{drift:?}");
        assert!((drift.amplitude_change.0 + 0.01).abs() < 1e-9, "{drift:?}");
        let mut findings = vec![];
        drift.report(250.0, &Tolerances::default(), &mut findings);
        let names: Vec<&str> = findings.iter().map(Finding::name).collect();
        assert_eq!(names, ["frequency-drift", "amplitude-drift"]);
        Drift::new(&all, &[&all[..]; 3], &centres[..3]).report(250.0, &Tolerances::default(), &mut findings);
        assert_eq!(findings.len(), 2);
    }

    /// A parabola beside a line that both have their centre elsewhere, with a rest that is orthogonal to both: factor
    /// and standard error of the textbook.
    #[test]
    fn a_shape_beside_a_line_has_its_factor_and_its_standard_error() {
        let rest = [-7.0, 5.0, 7.0, 3.0, -3.0, -7.0, -5.0, 7.0];
        for centre in [0.0, 10.0, -3.0] {
            let t: Vec<f64> = (0..8).map(|j| centre + f64::from(j) - 3.5).collect();
            let shape = |t: f64| (t - centre).powi(2) - 5.25;
            let values: Vec<f64> =
                t.iter().zip(rest).map(|(t, r)| 3.0 + 0.2 * t + 0.7 * shape(*t) + 1e-3 * r).collect();
            let (factor, error) = fit(&t, &values, shape);
            // Σ r² = 264, Σ shape² = 168; three numbers were taken from eight.
            let expected = 1e-3 * (264.0_f64 / 5.0 / 168.0).sqrt();
            assert!((factor - 0.7).abs() < 1e-13 && (error / expected - 1.0).abs() < 1e-9, "{factor} {error}");
        }
    }
}

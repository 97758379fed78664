use nlmodes_modal::HarmonicCoefficients;
use num_complex::Complex64;

use crate::Trajectory;
use crate::trajectory::Segment;

/// Below this phase a mode is treated as a drift.
const STILL: f64 = 1e-7;

impl Trajectory {
    /// Fourier coefficients of all degrees of freedom, eqs. (7), (14), with the trajectory as one period:
    /// `q_n = (2/T) ∫ q e^{−inωt} dt`, half of that for `n = 0`.
    ///
    /// The integrals over the segments between contact instants have closed forms, so the coefficients are exact
    /// however few there are.
    pub fn harmonics(&self, n_harmonics: usize) -> HarmonicCoefficients {
        let n = self.segments.first().map_or(0, |s| s.phase.offset.len());
        let mut all = HarmonicCoefficients::zeros(n, n_harmonics);
        let period = self.duration();
        for segment in &self.segments {
            for harmonic in 0..=n_harmonics {
                let nu = std::f64::consts::TAU * harmonic as f64 / period;
                let scale = if harmonic == 0 { 1.0 } else { 2.0 } / period;
                segment.add_harmonic(nu, scale, |d, share| all.of_mut(d)[harmonic] += share);
            }
        }
        (0..n).for_each(|d| all.of_mut(d)[0].im = 0.0);
        all
    }
}

impl Segment {
    /// `scale ∫ q e^{−iνt} dt` of each degree of freedom over the segment.
    fn add_harmonic(&self, nu: f64, scale: f64, mut add: impl FnMut(usize, Complex64)) {
        let (phase, length) = (&self.phase, self.to - self.from);
        let shift = scale * Complex64::cis(-nu * self.from);
        let u: Vec<Complex64> = (0..phase.omega.len())
            .map(|k| {
                let push = phase.push.get(k).copied().unwrap_or(0.0);
                let own = modal_integral(phase.omega[k], self.start.u[k], self.start.v[k], nu, length);
                shift * (own + if push == 0.0 { Complex64::default() } else { push * fall_transform(nu, length) })
            })
            .collect();
        let still = shift * exponential_integral(-nu, length);
        for (d, offset) in phase.offset.iter().enumerate() {
            let sum: Complex64 = u.iter().enumerate().map(|(k, u)| u * phase.shapes[(d, k)]).sum();
            add(d, sum + still * *offset);
        }
    }
}

/// `∫₀ᴸ (u cos ωs + v sin(ωs)/ω) e^{−iνs} ds`.
fn modal_integral(omega: f64, u: f64, v: f64, nu: f64, length: f64) -> Complex64 {
    if omega * length < STILL {
        return u * exponential_integral(-nu, length) + v * drift_integral(nu, length);
    }
    let amplitude = 0.5 * Complex64::new(u, -v / omega);
    amplitude * exponential_integral(omega - nu, length) + amplitude.conj() * exponential_integral(-omega - nu, length)
}

/// `∫₀ᴸ e^{iαs} ds = L e^{iαL/2} sin(αL/2)/(αL/2)`.
fn exponential_integral(alpha: f64, length: f64) -> Complex64 {
    let half = 0.5 * alpha * length;
    let sinc = if half.abs() < 1e-4 { 1.0 - half * half / 6.0 } else { half.sin() / half };
    length * sinc * Complex64::cis(half)
}

/// `∫₀ᴸ s e^{−iνs} ds`.
fn drift_integral(nu: f64, length: f64) -> Complex64 {
    let phase = nu * length;
    if phase < 1e-3 {
        // Series: the closed form below has lost half of its digits there.
        return length * length * Complex64::new(0.5 - phase * phase / 8.0, -phase / 3.0);
    }
    (Complex64::cis(-phase) * Complex64::new(1.0, phase) - 1.0) / (nu * nu)
}

/// `∫₀ᴸ ½ s² e^{−iνs} ds`.
fn fall_transform(nu: f64, length: f64) -> Complex64 {
    let phase = nu * length;
    if phase < FEW_TERMS {
        let (mut term, mut sum) = (Complex64::from(0.5), Complex64::default());
        for m in 0..TERMS {
            sum += term / (m as f64 + 3.0);
            term *= Complex64::new(0.0, -phase) / (m as f64 + 1.0);
        }
        return length.powi(3) * sum;
    }
    Complex64::new(0.0, 1.0 / nu) * (0.5 * length * length * Complex64::cis(-phase) - drift_integral(nu, length))
}

/// Phase below which `TERMS` terms of its series tell the integral of a fall to the last digit.
const FEW_TERMS: f64 = 0.5;
const TERMS: usize = 14;

#[cfg(test)]
mod tests {
    use super::*;

    /// `∫₀ᴸ f(s) e^{−iνs} ds` by Simpson's rule.
    fn numeric(f: impl Fn(f64) -> f64, nu: f64, length: f64) -> Complex64 {
        let n = 4000;
        let at = |j: usize| {
            let s = length * j as f64 / n as f64;
            let weight = if j == 0 || j == n {
                1.0
            } else if j % 2 == 1 {
                4.0
            } else {
                2.0
            };
            Complex64::cis(-nu * s) * (weight * f(s))
        };
        (0..=n).map(at).sum::<Complex64>() * (length / (3 * n) as f64)
    }

    #[test]
    fn integrals_of_drifts_and_oscillations_are_those_by_simpsons_rule() {
        for length in [0.7, 3.0] {
            // On both sides of the switch from the closed form of a drift to its series, at a phase of 1e-3.
            for nu in [0.0, 1e-5, 2e-4, 9e-4, 1.6e-3, 0.3, 4.0].map(|phase| phase / length) {
                let found = drift_integral(nu, length);
                let expected = numeric(|s| s, nu, length);
                assert!((found - expected).norm() < 1e-10 * length * length, "{nu}: {found} {expected}");
                let (found, expected) = (fall_transform(nu, length), numeric(|s| 0.5 * s * s, nu, length));
                assert!((found - expected).norm() < 1e-10 * length.powi(3), "{nu}: {found} {expected}");
                let found = exponential_integral(-nu, length);
                assert!((found - numeric(|_| 1.0, nu, length)).norm() < 1e-12 * length, "{nu}: {found}");
                for omega in [0.0_f64, 1e-8, 0.4, 2.0, nu] {
                    let motion = |s: f64| {
                        0.3 * (omega * s).cos() - 1.1 * if omega > 0.0 { (omega * s).sin() / omega } else { s }
                    };
                    let (found, expected) = (modal_integral(omega, 0.3, -1.1, nu, length), numeric(motion, nu, length));
                    // Near ω = 0 a drift is the difference of two large numbers.
                    let tolerance = if omega * length > 0.0 && omega * length < 1e-2 { 1e-7 } else { 1e-9 };
                    assert!(
                        (found - expected).norm() < tolerance * (1.0 + length * length),
                        "{nu} {omega}: {found} {expected}"
                    );
                }
            }
        }
    }
}

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
                shift * (own + if push == 0.0 { Complex64::default() } else { push * moment(2, -nu, length) })
            })
            .collect();
        let still = shift * moment(0, -nu, length);
        for (d, offset) in phase.offset.iter().enumerate() {
            let sum: Complex64 = u.iter().enumerate().map(|(k, u)| u * phase.shapes[(d, k)]).sum();
            add(d, sum + still * *offset);
        }
    }
}

/// `∫₀ᴸ (u cos ωs + v sin(ωs)/ω) e^{−iνs} ds`.
fn modal_integral(omega: f64, u: f64, v: f64, nu: f64, length: f64) -> Complex64 {
    if omega * length < STILL {
        return u * moment(0, -nu, length) + v * moment(1, -nu, length);
    }
    let amplitude = 0.5 * Complex64::new(u, -v / omega);
    amplitude * moment(0, omega - nu, length) + amplitude.conj() * moment(0, -omega - nu, length)
}

/// `∫₀ᴸ sᵏ/k! e^{iαs} ds`.
fn moment(k: i32, alpha: f64, length: f64) -> Complex64 {
    length.powi(k + 1) * moment_of_one(k, Complex64::new(0.0, alpha * length))
}

/// `∫₀¹ sᵏ/k! e^{zs} ds`: by parts, or by its power series where that would lose digits.
fn moment_of_one(k: i32, z: Complex64) -> Complex64 {
    let inverse = 1.0 / (1..=k).map(f64::from).product::<f64>();
    if z.norm() >= 1.0 {
        let rest = if k == 0 { Complex64::ONE } else { moment_of_one(k - 1, z) };
        return (inverse * z.exp() - rest) / z;
    }
    let (mut term, mut sum, mut m) = (Complex64::from(inverse), Complex64::ZERO, 0);
    while term.norm() > f64::EPSILON * f64::EPSILON {
        sum += term / f64::from(m + k + 1);
        m += 1;
        term *= z / f64::from(m);
    }
    sum
}

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
            // On both sides of the switch from integration by parts to the series, at a phase of one.
            for nu in [0.0, 1e-5, 1.6e-3, 0.3, 0.999, 1.001, 4.0].map(|phase| phase / length) {
                let found = moment(1, -nu, length);
                let expected = numeric(|s| s, nu, length);
                assert!((found - expected).norm() < 1e-10 * length * length, "{nu}: {found} {expected}");
                let (found, expected) = (moment(2, -nu, length), numeric(|s| 0.5 * s * s, nu, length));
                assert!((found - expected).norm() < 1e-10 * length.powi(3), "{nu}: {found} {expected}");
                let found = moment(0, -nu, length);
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

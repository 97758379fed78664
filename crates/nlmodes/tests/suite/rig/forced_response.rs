//! A level of the rig compared with the damped forced response by harmonic balance, which shares no code with it.

use std::f64::consts::TAU;

use nlmodes::rig::{ControlChannels, Exciter, RigSetup, Session};
use nlmodes_experiment::phase_loop::{LevelSchedule, LoopSettings, Resonance, SteadyCriteria, TestSettings};
use nlmodes_linalg::{DenseLu, Mat};
use nlmodes_modal::HarmonicBasis;
use num_complex::Complex64;

use crate::rig::analysis::{amplitudes, samples};
use crate::rig::beam;

/// Up to 4.1 kHz, beyond the highest mode.
const HARMONICS: usize = 100;
const SAMPLES: usize = 4096;
const STIFFNESS: f64 = 2.3e6;

/// `λ = k max(0, w − g)` in harmonics, with `w_n = H_tf F δ_n1 − H_tt λ_n`, and a lag of 90 degrees at the drive point.
/// Unknowns: real and imaginary parts of `λ_n`, then `ω`.
struct Balance<'a> {
    setup: &'a RigSetup,
    force: f64,
    basis: HarmonicBasis,
}

impl Balance<'_> {
    fn receptance(&self, at: &[f64], from: &[f64], ω: f64) -> Complex64 {
        let structure = &self.setup.structure;
        let mode = |k: usize| {
            let (ωk, ζ) = (structure.omega[k], structure.damping_ratios[k]);
            at[k] * from[k] / Complex64::new(ωk * ωk - ω * ω, 2.0 * ζ * ωk * ω)
        };
        (0..structure.modes()).map(mode).sum()
    }

    fn tip(&self) -> &[f64] {
        &self.setup.stop.as_ref().unwrap().shape
    }

    /// Tip displacement over a period.
    fn displacement(&mut self, λ: &[Complex64], ω: f64) -> Vec<f64> {
        let of = |n: usize| -self.receptance(self.tip(), self.tip(), n as f64 * ω) * λ[n];
        let mut w: Vec<Complex64> = (0..=HARMONICS).map(of).collect();
        w[1] += self.receptance(self.tip(), &self.setup.drive_point.shape, ω) * self.force;
        let mut motion = vec![0.0; SAMPLES];
        self.basis.synthesize(&w, &mut motion);
        motion
    }

    fn analyze(&mut self, samples: &[f64]) -> Vec<Complex64> {
        let mut coefficients = vec![Complex64::ZERO; HARMONICS + 1];
        self.basis.analyze(samples, &mut coefficients);
        coefficients
    }

    fn residual(&mut self, x: &[f64]) -> Vec<f64> {
        let (λ, ω) = unpack(x);
        let pressed: Vec<f64> = self.displacement(&λ, ω).iter().map(|w| STIFFNESS * (w - beam::GAP).max(0.0)).collect();
        let difference: Vec<Complex64> = self.analyze(&pressed).iter().zip(&λ).map(|(p, λ)| λ - p).collect();
        let at = &self.setup.drive_point;
        let drive = (self.receptance(&at.shape, &at.shape, ω) + at.residual) * self.force
            - self.receptance(&at.shape, self.tip(), ω) * λ[1];
        pack(&difference, 1e8 * drive.re)
    }

    /// One Newton step; returns the largest change of the contact force, N.
    fn improve(&mut self, x: &mut [f64]) -> f64 {
        let n = x.len();
        let (residual, (λ, ω)) = (self.residual(x), unpack(x));
        let closed: Vec<bool> = self.displacement(&λ, ω).iter().map(|w| *w > beam::GAP).collect();
        let mut jacobian = Mat::zeros(n, n);
        for j in 0..n {
            let column = if j + 1 == n || j == 1 || j == 2 {
                // The frequency, and the fundamental, which also moves the drive point, by finite differences.
                let h = if j + 1 == n { 1e-5 } else { 1e-4 };
                let mut moved = x.to_vec();
                moved[j] += h;
                self.residual(&moved).iter().zip(&residual).map(|(a, b)| (a - b) / h).collect()
            } else {
                self.column(j, n, ω, &closed)
            };
            (0..n).for_each(|i| jacobian[(i, j)] = column[i]);
        }
        let mut step = residual;
        DenseLu::factor(&jacobian).unwrap().solve_in_place(&mut step);
        x.iter_mut().zip(&step).for_each(|(x, s)| *x -= s);
        step.iter().fold(0.0f64, |m, s| m.max(s.abs()))
    }

    /// Derivative with respect to one part of one harmonic of the contact force.
    fn column(&mut self, j: usize, n: usize, ω: f64, closed: &[bool]) -> Vec<f64> {
        let mut unit = vec![0.0; n];
        unit[j] = 1.0;
        let (λ, _) = unpack(&unit);
        let w: Vec<Complex64> =
            (0..=HARMONICS).map(|n| -self.receptance(self.tip(), self.tip(), n as f64 * ω) * λ[n]).collect();
        let mut motion = vec![0.0; SAMPLES];
        self.basis.synthesize(&w, &mut motion);
        motion.iter_mut().zip(closed).for_each(|(w, closed)| *w = if *closed { STIFFNESS * *w } else { 0.0 });
        let difference: Vec<Complex64> = self.analyze(&motion).iter().zip(&λ).map(|(p, λ)| λ - p).collect();
        pack(&difference, 0.0)
    }
}

fn unpack(x: &[f64]) -> (Vec<Complex64>, f64) {
    let harmonic = |n: usize| if n == 0 { x[0].into() } else { Complex64::new(x[2 * n - 1], x[2 * n]) };
    ((0..=HARMONICS).map(harmonic).collect(), x[x.len() - 1])
}

fn pack(λ: &[Complex64], last: f64) -> Vec<f64> {
    let mut x = vec![λ[0].re];
    λ[1..].iter().for_each(|z| x.extend([z.re, z.im]));
    x.push(last);
    x
}

#[test]
fn a_level_has_the_frequency_of_the_damped_forced_response() {
    let setup = beam::setup(Exciter::IdealForce);
    let resonance = Resonance { omega: TAU * beam::FREQUENCIES_HZ[0], damping_ratio: beam::DAMPING_RATIOS[0] };
    let settings = LoopSettings::new(resonance, TAU * 40.0, beam::INTERVAL);
    let control = TestSettings::new(settings, LevelSchedule::new(&[4.4]).unwrap());
    let channels = ControlChannels::new(beam::FORCE, beam::DRIVE_DISPLACEMENT);
    let mut session = Session::new(setup.clone(), &control, channels).unwrap();
    session.run(2.0).unwrap();
    session.go(5.4, 2.0).unwrap();
    let strict = SteadyCriteria {
        lag: 1e-4,
        frequency_drift: 1e-7,
        amplitude_drift: 1e-6,
        spread: 1e-5,
        confidence: 0.0,
        ..SteadyCriteria::default()
    };
    let (_, findings) = session.settle(&strict).unwrap();
    assert!(findings.is_empty(), "{findings:?}");
    let (record, steady) = session.record(1.0).unwrap();
    // Newton's method from the recorded contact force, in the phase of the measured one.
    let turn = Complex64::cis(-amplitudes(&record, "force", 1)[0].arg());
    let mean = samples(&record, "f_contact").iter().sum::<f64>() / record.n_samples() as f64;
    let mut λ = vec![Complex64::from(mean)];
    let recorded = amplitudes(&record, "f_contact", HARMONICS);
    λ.extend(recorded.iter().enumerate().map(|(k, z)| z * turn.powu(k as u32 + 1)));
    let mut x = pack(&λ, steady.omega + 0.02);
    let mut balance = Balance { setup: &setup, force: 5.4, basis: HarmonicBasis::new(HARMONICS, SAMPLES).unwrap() };
    let converged = (0..20).any(|_| balance.improve(&mut x) < 1e-8);
    assert!(converged, "{:?}", balance.residual(&x).iter().fold(0.0f64, |m, r| m.max(r.abs())));
    let (found, ω) = unpack(&x);
    assert!((steady.omega - ω).abs() < TAU * 1e-3, "{} {} Hz", steady.omega / TAU, ω / TAU);
    // The mean is taken over 41.15 periods: up to a contact more or less, a share of 1/41 of it, is missing.
    assert!((found[0].re / mean - 1.0).abs() < 0.025, "{} {mean}", found[0].re);
}

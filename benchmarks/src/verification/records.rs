//! Records that were made from known motions.

use std::f64::consts::TAU;

use nlmodes::experiment::extraction::{ExtractionSettings, RecordExtraction, Stop, extract};
use nlmodes::experiment::records::{Channel, Quantity, Record, Role};
use nlmodes::modal::LinearModes;
use num_complex::Complex64;

use super::tools::Bilinear;
use super::{Case, Check, Kind};
use crate::Failure;

const RATE: f64 = 20_000.0;
const LEAK: &str = "whole periods are cut out between samples: what is left of leakage";

pub(super) const CASES: &[Case] = &[
    Case {
        name: "harmonics-of-a-signal",
        problem: "A displacement of eight harmonics with amplitudes `1/n²` and phases `0.3n`, 41.3104 Hz, 20 kHz, \
            9683 samples: no whole number of periods.\nFrequency, and amplitudes of harmonics 1, 3, 8.",
        kind: Kind::Exact,
        reference: "the numbers that the signal was made from",
        remark: "",
        compute: || harmonics(Quantity::Displacement),
    },
    Case {
        name: "harmonics-of-an-acceleration",
        problem: "The same motion, measured by an accelerometer.\nFrequency, and amplitudes of the displacement.",
        kind: Kind::Exact,
        reference: "the numbers that the signal was made from",
        remark: "",
        compute: || harmonics(Quantity::Acceleration),
    },
    Case {
        name: "noise-is-averaged",
        problem: "The same displacement with 1 % of white noise, ten seeds.\nMean deviation of the frequency over its \
            stated uncertainty, as a root mean square.",
        kind: Kind::Exact,
        reference: "1: the stated uncertainty is a standard error",
        remark: "",
        compute: noise,
    },
    Case {
        name: "mode-indicator",
        problem: "Force `cos θ`, velocity `cos θ + ½ cos 2θ` at the drive point: a force that is not \
            appropriated.\nPower-based mode indicator, active power, with both signs of the force.",
        kind: Kind::Exact,
        reference: "`P = ½`, `S = ½ √(1 + ¼)`: `±2/√5`",
        remark: "eq. (19) of the paper has a minus sign and is stated to reach +1; here a perfect force has +1",
        compute: indicator,
    },
    Case {
        name: "damping-of-a-linear-mode",
        problem: "One mode at 40.1 Hz with 0.19 % damping at its undamped frequency, force and acceleration at three \
            positions.\nDamping coefficient, modal amplitude, lag.",
        kind: Kind::Exact,
        reference: "`ζ`; `Fφ/(2ζω²)`; 90°",
        remark: "",
        compute: damping,
    },
    Case {
        name: "lag-of-the-drive-point",
        problem: "The same mode driven 0.1 % below its frequency.\nLag of the displacement.",
        kind: Kind::Exact,
        reference: "`arctan(2ζr/(1 − r²))`",
        remark: "",
        compute: lag,
    },
    Case {
        name: "stiffness-of-a-stop",
        problem: "A mass of 1 kg on (80π)² = 63 165.47 N/m (40 Hz) with a stop of 4·10⁵ N/m at 1 mm, 0.3 mm beyond \
            it: displacement, velocity and contact force, 40 kHz.\nContact stiffness, where the stop is, share of \
            time in contact, restitution.",
        kind: Kind::Exact,
        reference: "two harmonic arcs; the motion is symmetric about the contact: restitution 1",
        remark: "",
        compute: stop,
    },
    Case {
        name: "frequency-from-a-phase-channel",
        problem: "The phase of the generator at 41.3104 Hz, modulo 2π, beside one displacement.\nFrequency.",
        kind: Kind::Exact,
        reference: "the number that the phase was made from",
        remark: "",
        compute: phase,
    },
];

fn omega() -> f64 {
    TAU * 41.3104
}

fn motion() -> Vec<Complex64> {
    let term = |n: usize| Complex64::from_polar(1e-3 / (n * n) as f64, 0.3 * n as f64);
    std::iter::once(Complex64::default()).chain((1..=8).map(term)).collect()
}

/// `Re Σ (inω)^order q_n e^{inωt}` at the sampling instants.
fn sampled(q: &[Complex64], omega: f64, order: u32, rate: f64, n: usize) -> Vec<f64> {
    let at = |t: f64| -> f64 {
        let term = |(k, q): (usize, &Complex64)| {
            (Complex64::new(0.0, k as f64 * omega).powu(order) * q * Complex64::cis(k as f64 * omega * t)).re
        };
        q.iter().enumerate().map(term).sum()
    };
    (0..n).map(|j| at(j as f64 / rate)).collect()
}

fn order(quantity: Quantity) -> u32 {
    match quantity {
        Quantity::Velocity => 1,
        Quantity::Acceleration => 2,
        _ => 0,
    }
}

fn one_channel(quantity: Quantity) -> Record {
    let samples = sampled(&motion(), omega(), order(quantity), RATE, 9683);
    Record::new("made", RATE).with(Channel::new("x", quantity, Role::Response, Some(0.5)), samples)
}

fn harmonics(quantity: Quantity) -> Result<Vec<Check>, Failure> {
    let settings = ExtractionSettings { harmonics: 8, ..ExtractionSettings::default() };
    let found = extract(&one_channel(quantity), &settings)?;
    let mut checks = vec![Check::relative("frequency, Hz", found.omega.value / TAU, 41.3104, 1e-8, LEAK)];
    for n in [1, 3, 8] {
        let amplitude = found.motion.of(0)[n].norm();
        checks.push(Check::of_size(
            format!("amplitude of harmonic {n}, m"),
            [amplitude, motion()[n].norm(), 1e-3],
            1e-6,
            LEAK,
        ));
    }
    Ok(checks)
}

/// Normal numbers from a seed: xorshift64* and Box and Muller.
struct Normal(u64);

impl Normal {
    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn draw(&mut self) -> f64 {
        let (a, b) = (self.uniform().max(1e-300), self.uniform());
        (-2.0 * a.ln()).sqrt() * (TAU * b).cos()
    }
}

fn noise() -> Result<Vec<Check>, Failure> {
    let settings = ExtractionSettings { harmonics: 8, ..ExtractionSettings::default() };
    let mut squares = 0.0;
    for seed in 1..=10_u64 {
        let mut record = one_channel(Quantity::Displacement);
        let mut normal = Normal(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        record.samples[0].iter_mut().for_each(|x| *x += 1e-5 * normal.draw());
        let found = extract(&record, &settings)?.omega;
        squares += ((found.value - omega()) / found.uncertainty).powi(2);
    }
    let pull = (squares / 10.0_f64).sqrt();
    Ok(vec![Check::of_size(
        "root mean square",
        [pull, 1.0, 1.0],
        0.5,
        "ten draws: 22 % of scatter, and uncertainties that are estimated themselves",
    )])
}

fn indicator() -> Result<Vec<Check>, Failure> {
    let (rate, n, omega) = (5000.0, 4321, TAU * 33.3);
    let velocity = [0.0.into(), Complex64::ONE, Complex64::new(0.5, 0.0)];
    let mut checks = Vec::new();
    for sign in [1.0, -1.0] {
        let record = Record::new("distorted", rate)
            .with(
                Channel::new("f", Quantity::Force, Role::Excitation, Some(0.0)),
                sampled(&[0.0.into(), sign.into()], omega, 0, rate, n),
            )
            .with(
                Channel::new("v", Quantity::Velocity, Role::DrivePoint, Some(0.0)),
                sampled(&velocity, omega, 0, rate, n),
            );
        let settings = ExtractionSettings { pbmif_harmonics: Some(10), ..ExtractionSettings::default() };
        let found = extract(&record, &settings)?.excitation.ok_or("no excitation")?;
        checks.push(Check::relative(
            format!("indicator, force times {sign}"),
            found.pbmif.value,
            sign * 2.0 / 5.0_f64.sqrt(),
            1e-6,
            LEAK,
        ));
        checks.push(Check::relative(
            format!("power of the fundamental, force times {sign}, W"),
            found.fundamental_power.value,
            sign * 0.5,
            1e-6,
            LEAK,
        ));
    }
    Ok(checks)
}

const ZETA: f64 = 0.0019;
const SHAPE: [f64; 3] = [0.3, 1.1, 1.9];
const PLACES: [f64; 3] = [0.1, 0.4, 0.6];

/// One mode under 2 N at its first position, at `ratio` times its frequency.
fn one_mode(ratio: f64) -> Result<(f64, RecordExtraction), Failure> {
    let natural = TAU * 40.1;
    let omega = ratio * natural;
    let eta = 2.0 * SHAPE[0] / Complex64::new(natural * natural - omega * omega, 2.0 * ZETA * natural * omega);
    let n = 12_345;
    let signal = |q: Complex64, order: u32| sampled(&[Complex64::default(), q], omega, order, RATE, n);
    let mut record = Record::new("linear", RATE)
        .with(Channel::new("f", Quantity::Force, Role::Excitation, Some(PLACES[0])), signal(2.0.into(), 0))
        .with(Channel::new("x", Quantity::Displacement, Role::DrivePoint, Some(PLACES[0])), signal(eta * SHAPE[0], 0));
    for (k, (shape, place)) in SHAPE.iter().zip(PLACES).enumerate().skip(1) {
        let channel = Channel::new(format!("a{k}"), Quantity::Acceleration, Role::Response, Some(place));
        record = record.with(channel, signal(eta * *shape, 2));
    }
    let rows: Vec<Vec<f64>> = SHAPE.iter().map(|s| vec![*s]).collect();
    let modes = LinearModes::new(&PLACES, &[natural], &[ZETA], &rows)?;
    let settings = ExtractionSettings { harmonics: 3, linear_modes: Some(modes), ..ExtractionSettings::default() };
    Ok((eta.norm(), extract(&record, &settings)?))
}

fn damping() -> Result<Vec<Check>, Failure> {
    let (amplitude, found) = one_mode(1.0)?;
    let modal = found.modal.ok_or("no modal quantities")?;
    let lag = found.excitation.ok_or("no excitation")?.lag.value;
    let exact = 2.0 * SHAPE[0] / (2.0 * ZETA * (TAU * 40.1).powi(2));
    Ok(vec![
        Check::relative("damping coefficient", modal.damping.ok_or("no damping")?.value, ZETA, 1e-6, LEAK),
        Check::relative("modal amplitude, m √kg", modal.amplitude.value, exact, 1e-6, LEAK),
        Check::relative("modal amplitude of the signal, m √kg", amplitude, exact, 1e-12, "the case itself"),
        Check::of_size("lag, degrees", [lag.to_degrees(), 90.0, 90.0], 1e-6, LEAK),
    ])
}

fn lag() -> Result<Vec<Check>, Failure> {
    let ratio = 0.999;
    let (_, found) = one_mode(ratio)?;
    let lag = found.excitation.ok_or("no excitation")?.lag.value;
    let exact = (2.0 * ZETA * ratio).atan2(1.0 - ratio * ratio);
    Ok(vec![Check::of_size("lag, degrees", [lag.to_degrees(), exact.to_degrees(), 90.0], 1e-6, LEAK)])
}

fn stop() -> Result<Vec<Check>, Failure> {
    let (k, k_s, gap, rate) = ((TAU * 40.0).powi(2), 4e5, 1e-3, 40_000.0);
    let closed = Bilinear { m: 1.0, k, k_s, gap, top: 1.3e-3, two_sided: false };
    let n = 10_000;
    let states: Vec<[f64; 2]> = (0..n).map(|j| closed.state(j as f64 / rate)).collect();
    let channel = |name: &str, quantity, role| Channel::new(name, quantity, role, Some(0.5));
    let record = Record::new("stop", rate)
        .with(channel("x", Quantity::Displacement, Role::Response), states.iter().map(|s| s[0]).collect())
        .with(channel("v", Quantity::Velocity, Role::Response), states.iter().map(|s| s[1]).collect())
        .with(
            channel("f", Quantity::Force, Role::Contact),
            states.iter().map(|s| k_s * (s[0] - gap).max(0.0)).collect(),
        );
    let settings =
        ExtractionSettings { stop: Some(Stop { position: 0.5, gap, positive: true }), ..ExtractionSettings::default() };
    let found = extract(&record, &settings)?;
    let contact = found.contact.ok_or("no contact")?;
    let stiffness = contact.stiffness.ok_or("no stiffness")?;
    let restitution = contact.restitution.ok_or("no restitution")?.statistics().mean;
    Ok(vec![
        Check::relative("frequency, Hz", found.omega.value / TAU, closed.omega() / TAU, 1e-6, LEAK),
        Check::relative(
            "contact stiffness, N/m",
            stiffness.stiffness,
            k_s,
            1e-6,
            "the samples lie on the line: rounding",
        ),
        Check::relative("place of the stop, m", stiffness.stop, gap, 1e-6, "the samples lie on the line: rounding"),
        Check::relative(
            "share of contact",
            contact.closed_fraction,
            closed.share(),
            0.05,
            "two samples of some forty at the ends of a contact",
        ),
        Check::relative(
            "restitution",
            restitution,
            1.0,
            0.02,
            "velocities four samples before and after the contact, where it is 1 % off its top",
        ),
    ])
}

fn phase() -> Result<Vec<Check>, Failure> {
    let mut record = one_channel(Quantity::Displacement);
    let phase = (0..9683).map(|j| (0.4 + omega() * f64::from(j) / RATE) % TAU).collect();
    record = record.with(Channel::new("p", Quantity::Phase, Role::ExcitationPhase, None), phase);
    let found = extract(&record, &ExtractionSettings { harmonics: 8, ..ExtractionSettings::default() })?;
    Ok(vec![Check::relative("frequency, Hz", found.omega.value / TAU, 41.3104, 1e-10, "rounding of the phase")])
}

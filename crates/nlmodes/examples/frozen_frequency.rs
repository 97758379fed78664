//! Is phase resonance stable without the loop? Periodic responses of the paper's beam to an ideal force, with their
//! Floquet multipliers, and the behaviour after the frequency is frozen.
//!
//! ```text
//! cargo run -p nlmodes --example frozen_frequency -- FORCE…
//! ```
//!
//! At each force and lag the response is the fixed point of the map over one period of the drive, found by Newton's
//! method with the frequency as an unknown and the lag as an equation, so that folds over frequency do not matter. The
//! period is an integer number of sampling intervals. A response is stable at fixed frequency if all eigenvalues of the
//! derivative of the map are inside the unit circle.

#![allow(mixed_script_confusables, dead_code)]

#[path = "../tests/suite/rig/beam.rs"]
mod beam;

use std::error::Error;
use std::f64::consts::TAU;

use nlmodes::rig::{
    ControlChannels, Drive, Exciter, MotionQuantity, RigSetup, Sensor, SensorPlace, Session, VirtualRig,
};
use nlmodes_experiment::phase_loop::{LevelSchedule, LoopSettings, Resonance, TestSettings};
use nlmodes_linalg::{DenseLu, Mat, eigenvalues};
use num_complex::Complex64;

type Outcome<T> = Result<T, Box<dyn Error>>;

/// Samples per period.
const SAMPLES: usize = 480;
const MODES: usize = beam::FREQUENCIES_HZ.len();
const STATES: usize = 2 * MODES;

/// The driven beam at one frequency. States are modal coordinates and velocities divided by the first eigenfrequency,
/// m√kg.
struct Driven {
    rig: VirtualRig,
    force: f64,
    omega: f64,
}

/// The state after a period, and the fundamental of the displacement at the drive point relative to the phase of the
/// force.
struct Period {
    state: Vec<f64>,
    response: Complex64,
}

fn scale() -> f64 {
    TAU * beam::FREQUENCIES_HZ[0]
}

fn setup() -> RigSetup {
    let mut setup = beam::setup(Exciter::IdealForce);
    for k in 0..MODES {
        let shape = (0..MODES).map(|j| f64::from(u8::from(j == k))).collect();
        let place = SensorPlace::Point { motion: MotionQuantity::Velocity, position: 0.0, shape };
        setup.sensors.push(Sensor::new(format!("modal_velocity_{k}"), place, 0.0));
    }
    setup
}

fn state(rig: &VirtualRig) -> Outcome<Vec<f64>> {
    let first = rig.setup().sensors.len() - MODES;
    let velocities = (0..MODES).map(|k| Ok(rig.exact(first + k)? / scale())).collect::<Outcome<Vec<f64>>>()?;
    Ok(rig.modal_coordinates().into_iter().chain(velocities).collect())
}

impl Driven {
    fn new(force: f64, omega: f64) -> Outcome<Self> {
        let rig = VirtualRig::new(RigSetup { interval: TAU / omega / SAMPLES as f64, ..setup() })?;
        Ok(Self { rig, force, omega })
    }

    fn period(&mut self, from: &[f64]) -> Outcome<Period> {
        let velocities: Vec<f64> = from[MODES..].iter().map(|v| v * scale()).collect();
        self.rig.set_motion(&from[..MODES], &velocities)?;
        let mut response = Complex64::default();
        for k in 0..SAMPLES {
            let phase = TAU * k as f64 / SAMPLES as f64;
            self.rig.advance(&Drive::sine([self.force; 2], phase, self.omega))?;
            let after = TAU * (k + 1) as f64 / SAMPLES as f64;
            response += self.rig.exact(beam::DRIVE_DISPLACEMENT)? * Complex64::cis(-after) * (2.0 / SAMPLES as f64);
        }
        Ok(Period { state: state(&self.rig)?, response })
    }

    /// Derivative of the map and of the response with respect to the state.
    fn derivative(&mut self, at: &[f64]) -> Outcome<(Mat<f64>, Vec<Complex64>)> {
        let step = 1e-7 * at.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let (mut map, mut response) = (Mat::zeros(STATES, STATES), Vec::new());
        for j in 0..STATES {
            let mut shifted = |by: f64| {
                let mut x = at.to_vec();
                x[j] += by;
                self.period(&x)
            };
            let (plus, minus) = (shifted(step)?, shifted(-step)?);
            (0..STATES).for_each(|i| map[(i, j)] = (plus.state[i] - minus.state[i]) / (2.0 * step));
            response.push((plus.response - minus.response) / (2.0 * step));
        }
        Ok((map, response))
    }
}

/// Lag of the displacement beyond `target`, rad.
fn lag_beyond(response: Complex64, target: f64) -> f64 {
    (response.conj() * Complex64::cis(-target)).arg()
}

/// A periodic response with this lag: state at phase 0, frequency, and the derivative of its map.
fn resonance(force: f64, lag: f64, mut x: Vec<f64>, mut omega: f64) -> Outcome<(Vec<f64>, f64, Mat<f64>, Complex64)> {
    for _ in 0..40 {
        let mut driven = Driven::new(force, omega)?;
        let period = driven.period(&x)?;
        let (map, response) = driven.derivative(&x)?;
        let dω = 1e-6 * omega;
        let by_omega = {
            let [plus, minus] = [dω, -dω].map(|d| Driven::new(force, omega + d).and_then(|mut d| d.period(&x)));
            let (plus, minus) = (plus?, minus?);
            let states: Vec<f64> = plus.state.iter().zip(&minus.state).map(|(p, m)| (p - m) / (2.0 * dω)).collect();
            (states, (lag_beyond(plus.response, lag) - lag_beyond(minus.response, lag)) / (2.0 * dω))
        };
        let mut jacobian = Mat::zeros(STATES + 1, STATES + 1);
        let mut step: Vec<f64> = vec![0.0; STATES + 1];
        for i in 0..STATES {
            for j in 0..STATES {
                jacobian[(i, j)] = map[(i, j)] - f64::from(u8::from(i == j));
            }
            jacobian[(i, STATES)] = by_omega.0[i] * scale();
            // arg X' = Im(dX/X); the lag is −arg X.
            jacobian[(STATES, i)] = -(response[i] / period.response).im * 1e-4;
            step[i] = x[i] - period.state[i];
        }
        jacobian[(STATES, STATES)] = by_omega.1 * scale() * 1e-4;
        step[STATES] = -lag_beyond(period.response, lag) * 1e-4;
        DenseLu::factor(&jacobian)?.solve_in_place(&mut step);
        let size = x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let change = step[..STATES].iter().fold(step[STATES].abs() * size, |m, s| m.max(s.abs())) / size;
        let share = (0.05 / change).min(1.0);
        x.iter_mut().zip(&step).for_each(|(x, s)| *x += share * s);
        omega += share * step[STATES] * scale();
        if change < 1e-9 {
            return Ok((x, omega, map, period.response));
        }
    }
    Err("no periodic response found".into())
}

/// State at phase 0 and frequency of the loop at this force, after this many seconds.
fn locked(force: f64, seconds: f64) -> Outcome<(Vec<f64>, f64)> {
    let resonance = Resonance { omega: scale(), damping_ratio: beam::DAMPING_RATIOS[0] };
    let settings =
        LoopSettings { cut_off: 0.1 * resonance.omega, ..LoopSettings::new(resonance, TAU * 40.0, beam::INTERVAL) };
    let control = TestSettings::new(settings, LevelSchedule::new(&[4.0])?);
    let channels = ControlChannels::new(beam::FORCE, beam::DRIVE_DISPLACEMENT);
    let mut session = Session::new(setup(), &control, channels)?;
    session.run(5.0)?;
    session.go(force, 2.0)?;
    session.run(seconds)?;
    let mut before = session.state().phase().drive_phase();
    loop {
        session.step()?;
        let phase = session.state().phase().drive_phase();
        if phase < before {
            return Ok((state(session.rig())?, session.state().phase().omega()));
        }
        before = phase;
    }
}

/// Response at the drive point over the periods after a disturbance of the state, m.
fn frozen(force: f64, omega: f64, from: &[f64], factor: f64, periods: usize) -> Outcome<Vec<f64>> {
    let mut driven = Driven::new(force, omega)?;
    let mut x: Vec<f64> = from.iter().map(|x| factor * x).collect();
    let mut found = Vec::new();
    for _ in 0..periods {
        let period = driven.period(&x)?;
        found.push(period.response.norm());
        x = period.state;
    }
    Ok(found)
}

fn main() -> Outcome<()> {
    let forces: Vec<f64> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    for force in forces {
        let (mut x, mut omega) = locked(force, 30.0)?;
        println!("force {force} N: the loop is at {:.5} Hz", omega / TAU);
        let mut at_resonance = None;
        for degrees in [90.0_f64, 91.0, 92.0, 95.0, 100.0, 85.0, 80.0] {
            if let (true, Some(found)) = (degrees < 90.0, &at_resonance) {
                (x, omega) = Clone::clone(found);
            }
            let (state, frequency, map, response) = match resonance(force, degrees.to_radians(), x.clone(), omega) {
                Ok(found) => found,
                Err(error) => {
                    println!("  lag {degrees}: {error}");
                    continue;
                }
            };
            (x, omega) = (state, frequency);
            let mut multipliers = eigenvalues(&map)?;
            multipliers.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
            let shown: Vec<String> =
                multipliers[..4].iter().map(|μ| format!("{:.5} ({:.4}{:+.4}i)", μ.norm(), μ.re, μ.im)).collect();
            println!(
                "  lag {degrees}: {:.5} Hz, {:.4} µm, |μ| = {}",
                omega / TAU,
                1e6 * response.norm(),
                shown.join(", ")
            );
            if degrees == 90.0 {
                at_resonance = Some((x.clone(), omega));
            }
        }
        let Some((x, omega)) = at_resonance else { continue };
        for (name, shift, factor) in [
            ("as it is", 0.0, 1.0),
            ("0.1 % larger", 0.0, 1.001),
            ("0.1 % smaller", 0.0, 0.999),
            ("3 % smaller", 0.0, 0.97),
            ("0.02 Hz higher", 0.02, 1.0),
            ("0.02 Hz lower", -0.02, 1.0),
            ("0.1 Hz higher", 0.1, 1.0),
        ] {
            let found = frozen(force, omega + TAU * shift, &x, factor, 1200)?;
            let last = &found[1100..];
            let (low, high) = last.iter().fold((f64::MAX, 0.0_f64), |(l, h), v| (l.min(*v), h.max(*v)));
            println!(
                "  frozen, {name}: {:.3} µm becomes {:.3} to {:.3} µm in 30 s",
                1e6 * found[0],
                1e6 * low,
                1e6 * high
            );
        }
    }
    Ok(())
}

//! Motions against a stop in closed form, for tests and for the gallery.

use nlmodes_modal::{
    BranchEnd, ContactInstant, Coordinate, Event, HarmonicCoefficients, ModalBranch, ModalPoint, TimeHistory,
};
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Angular frequency of the oscillator without contact, rad/s.
const OMEGA_0: f64 = TAU * 60.0;
const MASS: f64 = 2.0;
/// Position of the rigid stop, m.
pub const STOP: f64 = 0.5;

/// Frequency of an oscillator that bounces off a rigid stop: `π ω₀ / (π − arccos(g₀/a))`.
pub fn omega(amplitude: f64) -> f64 {
    PI * OMEGA_0 / (PI - (STOP / amplitude).acos())
}

/// Complex amplitude of harmonic `n` of the flight `x = −a cos(ω₀t)`, |t| ≤ T/2, by the trapezoidal rule.
fn harmonic(amplitude: f64, n: usize) -> Complex64 {
    let (omega, samples) = (omega(amplitude), 4000);
    let sum = (0..samples).map(|k| {
        let tau = TAU * ((f64::from(k) + 0.5) / f64::from(samples) - 0.5);
        -amplitude * (OMEGA_0 * tau / omega).cos() * Complex64::cis(-(n as f64) * tau)
    });
    sum.sum::<Complex64>() * if n == 0 { 1.0 } else { 2.0 } / f64::from(samples)
}

fn point(amplitude: f64, coordinates: &[Coordinate], n_harmonics: usize) -> ModalPoint {
    let mut coefficients = HarmonicCoefficients::zeros(coordinates.len(), n_harmonics);
    let tip: Vec<Complex64> = (0..=n_harmonics).map(|n| harmonic(amplitude, n)).collect();
    for (d, coordinate) in coordinates.iter().enumerate() {
        let shape = (FRAC_PI_2 * coordinate.position / 20.0).sin();
        coefficients.of_mut(d).iter_mut().zip(&tip).for_each(|(q, tip)| *q = tip * shape);
    }
    let energy = 0.5 * MASS * (OMEGA_0 * amplitude).powi(2);
    ModalPoint {
        omega: omega(amplitude),
        coefficients,
        kinetic_energy: 0.5 * energy,
        total_energy: energy,
        modal_amplitude: tip[1].norm() * MASS.sqrt(),
        fundamental: tip[1].re,
        peak: STOP,
        contact_intervals: usize::from(amplitude > STOP),
        peak_contact_force: 0.1 + amplitude / 3.0,
        residual: 1.234_567_890_123_456_7e-13,
        ..ModalPoint::default()
    }
}

/// A rod of 20 m whose tip bounces off the stop, with `n` points and two kinds of coordinates.
pub fn rod(n: usize, n_harmonics: usize) -> ModalBranch {
    let coordinate = |k: usize, kind: &str| Coordinate { position: 0.5 * k as f64, kind: kind.into() };
    let coordinates: Vec<Coordinate> =
        (1..=40).flat_map(|k| [coordinate(k, "axial"), coordinate(k, "rotation")]).collect();
    let amplitude = |k: usize| STOP * (1.0 + 2.0 * (k as f64 / n.max(2) as f64).powi(2));
    let mut points: Vec<ModalPoint> = (0..n).map(|k| point(amplitude(k), &coordinates, n_harmonics)).collect();
    if let Some(first) = points.first_mut() {
        first.events.push(Event::Grazing);
    }
    branch("exact", coordinates, Some(78), points)
}

fn branch(
    label: &str,
    coordinates: Vec<Coordinate>,
    contact_coordinate: Option<usize>,
    points: Vec<ModalPoint>,
) -> ModalBranch {
    let end = BranchEnd::given("enough points");
    ModalBranch { label: label.into(), coordinates, contact_coordinate, stop: Some(STOP), points, end }
}

/// A branch with the loop of an internal resonance, with folds, a kink and a branch point.
pub fn looped(n: usize) -> ModalBranch {
    let mut branch = rod(n, 1);
    branch.label = "MS-HBM, 3 harmonics".into();
    for (k, point) in branch.points.iter_mut().enumerate() {
        let s = k as f64 / n as f64;
        let bump = (-((s - 0.4) / 0.06).powi(2)).exp();
        let backwards = (TAU * 2.0 * (s - 0.4) / 0.3).sin() * bump;
        point.omega -= TAU * 2.5 * backwards;
        point.kinetic_energy *= 1.0 + 0.25 * (TAU * 2.0 * (s - 0.36) / 0.3).sin() * bump;
    }
    let marks =
        [(36, Event::Fold), (43, Event::Fold), (46, Event::BranchPoint), (60, Event::Kink), (70, Event::FrequencyFold)];
    for (percent, event) in marks {
        if let Some(point) = branch.points.get_mut(percent * n / 100) {
            point.events.push(event);
        }
    }
    branch
}

/// Two periods of an oscillator against a stop of stiffness `k_c` (N/m) at 1.03 mm, in closed form.
pub fn history(label: &str, k_c: f64) -> TimeHistory {
    let (mass, stiffness, stop, amplitude) = (0.2, 0.2 * (TAU * 40.0).powi(2), 1.03e-3, 1.5e-3);
    let (omega_0, omega_c) = ((stiffness / mass).sqrt(), ((stiffness + k_c) / mass).sqrt());
    let rest = k_c * stop / (stiffness + k_c);
    let flight = (PI - f64::acos(stop / amplitude)) / omega_0;
    let speed = omega_0 * f64::sqrt(amplitude * amplitude - stop * stop);
    let depth = (stop - rest).hypot(speed / omega_c);
    let touch = ((stop - rest) / depth).acos() / omega_c;
    let period = 2.0 * (flight + touch);
    let time: Vec<f64> = (0..=2000).map(|k| period * f64::from(k) / 1000.0).collect();
    // Distance in time from the middle of the flight.
    let local = |t: f64| (t / period - (t / period).round()) * period;
    let state = |t: f64| {
        let t = local(t);
        if t.abs() <= flight {
            let (sin, cos) = (omega_0 * t).sin_cos();
            (-amplitude * cos, amplitude * omega_0 * sin)
        } else {
            let (sin, cos) = (omega_c * (t.abs() - 0.5 * period)).sin_cos();
            (rest + depth * cos, -depth * omega_c * sin * t.signum())
        }
    };
    let displacement: Vec<f64> = time.iter().map(|t| state(*t).0).collect();
    let force: Vec<f64> = displacement.iter().map(|x| k_c * (x - stop).max(0.0)).collect();
    let acceleration = displacement.iter().zip(&force).map(|(x, f)| -(stiffness * x + f) / mass).collect();
    let instant = |time: f64, touching: bool| ContactInstant { time, touching };
    TimeHistory {
        label: label.into(),
        velocity: time.iter().map(|t| state(*t).1).collect(),
        instants: [0.0, period]
            .into_iter()
            .flat_map(|start| [instant(start + flight, true), instant(start + period - flight, false)])
            .collect(),
        time,
        displacement,
        acceleration,
        force,
        stop,
    }
}

//! Quantities of a record, computed here independently of any extraction: Fourier coefficients over the drive phase,
//! modal coordinates by least squares, power.

use nlmodes::rig::{DRIVE_PHASE, RigSetup, SensorPlace};
use nlmodes_experiment::records::{Quantity, Record};
use nlmodes_linalg::{DenseLu, Mat};
use num_complex::Complex64;

/// Quantities of one level.
pub struct Figures {
    /// Complex amplitudes of the fundamental in modal coordinates, m·√kg.
    pub modal: Vec<Complex64>,
    /// `√Σ |q_k|²`, eqs. (21), (22).
    pub amplitude: f64,
    /// Eq. (28).
    pub damping: f64,
    /// Eqs. (17)-(19), positive for a force that supplies power.
    pub pbmif: f64,
    /// Lag of the drive point's displacement, rad.
    pub lag: f64,
}

/// Samples of the channel of this name.
pub fn samples<'a>(record: &'a Record, name: &str) -> &'a [f64] {
    &record.samples[record.channels.iter().position(|channel| channel.name == name).unwrap()]
}

/// Coefficients of the harmonics 1 to `harmonics` in the frame of the drive. A squared Hann window over n periods has
/// side lobes below n⁻⁵ at a neighbouring harmonic.
pub fn amplitudes(record: &Record, channel: &str, harmonics: usize) -> Vec<Complex64> {
    let (phase, samples) = (samples(record, DRIVE_PHASE), samples(record, channel));
    let (mut sums, mut weights) = (vec![Complex64::ZERO; harmonics], 0.0);
    for (k, (y, θ)) in samples.iter().zip(phase).enumerate() {
        let share = (k as f64 + 0.5) / samples.len() as f64;
        let weight = (std::f64::consts::PI * share).sin().powi(4);
        let (wave, mut power) = (Complex64::cis(-θ), Complex64::new(2.0 * weight * y, 0.0));
        weights += weight;
        for sum in &mut sums {
            power *= wave;
            *sum += power;
        }
    }
    sums.iter().map(|sum| sum / weights).collect()
}

/// Figures of a record of `setup` at the angular frequency `omega`.
pub fn figures(setup: &RigSetup, record: &Record, omega: f64, harmonics: usize) -> Figures {
    let force = amplitudes(record, "force", harmonics);
    let velocity = amplitudes(record, "v_ex", harmonics);
    let power = |n: usize| 0.5 * (force[n] * velocity[n].conj()).re;
    let active: f64 = (0..harmonics).map(power).sum();
    let square = |z: &[Complex64]| z.iter().map(|z| 0.5 * z.norm_sqr()).sum::<f64>();
    let modal = modal_coordinates(setup, record, omega);
    let amplitude = modal.iter().map(|q| q.norm_sqr()).sum::<f64>().sqrt();
    Figures {
        damping: power(0) / (amplitude.powi(2) * omega.powi(3)),
        pbmif: active / (square(&force) * square(&velocity)).sqrt(),
        lag: (force[0] * amplitudes(record, "x_ex", 1)[0].conj()).arg(),
        modal,
        amplitude,
    }
}

/// Least squares fit of the mode shapes to the fundamental of the accelerometers and of the tip.
fn modal_coordinates(setup: &RigSetup, record: &Record, omega: f64) -> Vec<Complex64> {
    let modes = setup.structure.modes();
    let (mut normal, mut right) = (Mat::zeros(modes, modes), vec![Complex64::ZERO; modes]);
    for sensor in &setup.sensors {
        let Some(shape) = shape_of(setup, &sensor.place) else { continue };
        let scale = match sensor.place.quantity() {
            Quantity::Displacement => 1.0,
            Quantity::Acceleration => -1.0 / omega.powi(2),
            _ => continue,
        };
        let x = amplitudes(record, &sensor.name, 1)[0] * scale;
        for i in 0..modes {
            right[i] += shape[i] * x;
            (0..modes).for_each(|j| normal[(i, j)] += shape[i] * shape[j]);
        }
    }
    let lu = DenseLu::factor(&normal).unwrap();
    let solve = |part: fn(&Complex64) -> f64| {
        let mut x: Vec<f64> = right.iter().map(part).collect();
        lu.solve_in_place(&mut x);
        x
    };
    solve(|z| z.re).into_iter().zip(solve(|z| z.im)).map(|(re, im)| Complex64::new(re, im)).collect()
}

fn shape_of<'a>(setup: &'a RigSetup, place: &'a SensorPlace) -> Option<&'a [f64]> {
    match place {
        SensorPlace::Point { shape, .. } => Some(shape),
        SensorPlace::StopPoint(_) => setup.stop.as_ref().map(|stop| stop.shape.as_slice()),
        _ => None,
    }
}

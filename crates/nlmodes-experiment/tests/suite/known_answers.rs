//! Extraction from records whose answer is known in closed form.

use crate::support;

use std::f64::consts::{FRAC_PI_2, TAU};

use nlmodes_experiment::extraction::{ExtractionSettings, RecordExtraction, Stop, extract};
use nlmodes_experiment::records::{Channel, Quantity, Record, Role};
use num_complex::Complex64;
use support::{Motion, Normal, POSITIONS, modes, sampled};

fn settings() -> ExtractionSettings {
    ExtractionSettings { linear_modes: Some(modes()), pbmif_harmonics: Some(20), ..ExtractionSettings::default() }
}

fn omega() -> f64 {
    TAU * 41.3104
}

/// Largest deviation from the motion that the record was made from, over the largest amplitude; phases relative to the
/// fundamental at the tip.
fn deviation(found: &RecordExtraction, made: &Motion) -> f64 {
    let (tip, shift) = (made.at(3), found.motion.of(3)[1].arg() - made.at(3)[1].arg());
    let compare = |(d, n): (usize, usize)| {
        let turned = found.motion.of(d)[n] * Complex64::cis(-(n as f64) * shift);
        (turned - made.at(d)[n]).norm()
    };
    // Accelerometers give no mean.
    let pairs = (0..4).flat_map(|d| (1..=20).map(move |n| (d, n)));
    pairs.map(compare).fold(0.0, f64::max) / tip[1].norm()
}

#[test]
fn coefficients_do_not_leak_from_two_periods_nor_from_twenty() {
    let made = Motion::example(omega(), 20);
    for (periods, limit) in [(2.0, 1e-5), (2.9, 1e-5), (20.0, 1e-6), (20.4, 1e-6)] {
        let n = (periods * TAU * 20_000.0 / omega()).round() as usize;
        let found = extract(&made.record(20_000.0, n, 0.0, 1), &settings()).unwrap();
        assert_eq!(found.periods, periods as usize);
        assert!((found.omega.value / omega() - 1.0).abs() < limit * 1e-3, "{:?}", found.omega);
        assert!(deviation(&found, &made) < limit, "{periods}: {:e}", deviation(&found, &made));
        assert_eq!(found.finding_names(), "");
    }
}

#[test]
fn noise_is_averaged_down_and_leaves_no_bias_beyond_its_uncertainty() {
    let made = Motion::example(omega(), 20);
    let exact = extract(&made.record(20_000.0, 9683, 0.0, 1), &settings()).unwrap();
    let (mut squares, mut count) = (0.0, 0);
    for seed in 0..6 {
        let noisy = extract(&made.record(20_000.0, 9683, 3e-3, 100 + seed), &settings()).unwrap();
        let (modal, clean) = (noisy.modal.unwrap(), exact.modal.as_ref().unwrap());
        let (excitation, clean_excitation) = (noisy.excitation.unwrap(), exact.excitation.as_ref().unwrap());
        for (noisy, clean) in [
            (noisy.omega, exact.omega.value),
            (modal.amplitude, clean.amplitude.value),
            (modal.damping.unwrap(), clean.damping.unwrap().value),
            (excitation.lag, clean_excitation.lag.value),
            (excitation.force, clean_excitation.force.value),
        ] {
            squares += ((noisy.value - clean) / noisy.uncertainty).powi(2);
            count += 1;
            assert!((noisy.value / clean - 1.0).abs() < 1e-3, "{noisy:?} {clean}");
        }
    }
    // Root mean square of 30 deviations over their standard errors: one, give or take 13 %, and more since the errors
    // are estimates.
    let pull = (squares / f64::from(count)).sqrt();
    assert!((0.6..1.5).contains(&pull), "{pull}");
}

#[test]
fn modal_amplitude_participation_and_damping_are_those_of_the_modal_coordinates() {
    let made = Motion::example(omega(), 20);
    let found = extract(&made.record(20_000.0, 9683, 0.0, 1), &settings()).unwrap();
    let modal = found.modal.unwrap();
    let q = made.eta.iter().map(|eta| eta[1].norm_sqr()).sum::<f64>().sqrt();
    assert!((modal.amplitude.value / q - 1.0).abs() < 1e-9);
    let drive = made.at(0);
    let p1 = 0.5 * (made.force[1] * (Complex64::new(0.0, omega()) * drive[1]).conj()).re;
    assert!((modal.damping.unwrap().value / (p1 / (q * q * omega().powi(3))) - 1.0).abs() < 1e-9);
    // At the instant when the drive point's fundamental peaks.
    let theta = drive[1].arg();
    for (k, eta) in made.eta.iter().enumerate() {
        let v: f64 = (1..=20).map(|n| (eta[n] * Complex64::cis(-(n as f64) * theta)).re).sum();
        assert!((modal.participation.factors[k] - v / q).abs() < 1e-8, "{k}");
    }
    assert_eq!(modal.participation.harmonics, 1..=20);
    // ½ m v² of unit modal masses, over a period half of its largest.
    let energy =
        |n: usize| made.eta.iter().map(|eta| 0.25 * (n as f64 * omega()).powi(2) * eta[n].norm_sqr()).sum::<f64>();
    for (n, found) in modal.harmonic_energy.iter().enumerate() {
        assert!((found - energy(n)).abs() <= 1e-7 * energy(1), "{n}: {found} {}", energy(n));
    }
    let all: f64 = (0..=20).map(energy).sum();
    assert!((modal.kinetic_energy.value / all - 1.0).abs() < 1e-7, "{:?} {all}", modal.kinetic_energy);
    let excitation = found.excitation.unwrap();
    assert!((excitation.lag.value - (made.force[1] / drive[1]).arg()).abs() < 1e-9);
    assert!((excitation.force.value - made.force[1].norm()).abs() < 1e-8);
}

/// Response of the linear modes to a harmonic force at the drive point.
fn linear_response(omega: f64, force: f64) -> Motion {
    let modes = modes();
    let eta = (0..3).map(|k| {
        let (w, z) = (modes.omegas()[k], modes.damping_ratios()[k]);
        let q = force * modes.shape(0, k) / Complex64::new(w * w - omega * omega, 2.0 * z * w * omega);
        vec![Complex64::default(), q]
    });
    Motion { omega, eta: eta.collect(), force: vec![Complex64::default(), force.into()] }
}

#[test]
fn a_linear_structure_in_phase_resonance_shows_its_damping_ratio() {
    let modes = modes();
    let (w1, z1) = (modes.omegas()[0], modes.damping_ratios()[0]);
    let residual: f64 = (1..3).map(|k| (modes.shape(0, k) / modes.omegas()[k]).powi(2)).sum();
    // The other modes' static response at the drive point shifts phase resonance by this much.
    let omega = w1 * (1.0 + 2.0 * z1 * z1 * w1 * w1 * residual / modes.shape(0, 0).powi(2));
    let made = linear_response(omega, 3.0);
    let record = made.record(20_000.0, 12_000, 1e-4, 5);
    let found = extract(&record, &ExtractionSettings { harmonics: 5, ..settings() }).unwrap();
    let excitation = found.excitation.as_ref().unwrap();
    // Second order in the shift, 4e-4 here, and noise.
    assert!((excitation.lag.value - FRAC_PI_2).abs() < 5e-4, "{:?}", excitation.lag);
    let modal = found.modal.as_ref().unwrap();
    assert!((modal.damping.unwrap().value / z1 - 1.0).abs() < 2e-4, "{:?}", modal.damping);
    assert!((excitation.pbmif.value - 1.0).abs() < 1e-4, "{:?}", excitation.pbmif);
    // What the linear damping ratios dissipate is what the force brings in (eq. 24).
    let balance = modal.dissipation.total() / excitation.fundamental_power.value;
    assert!((balance - 1.0).abs() < 1e-3, "{balance}");
    assert_eq!(found.finding_names(), "");
}

/// Force `cos θ` with velocity `cos θ + ½ cos 2θ`.
fn distorted(sign: f64) -> Record {
    let (rate, n) = (5000.0, 4321);
    let omega = TAU * 33.3;
    let velocity = [0.0.into(), Complex64::new(1.0, 0.0), Complex64::new(0.5, 0.0)];
    let mut normal = Normal::new(9);
    let mut noisy = |signal: Vec<f64>| signal.into_iter().map(|x| x + 1e-5 * normal.draw()).collect::<Vec<_>>();
    let force = sampled(&[0.0.into(), sign.into()], omega, 0, rate, n);
    Record::new("distorted", rate)
        .with(Channel::new("f", Quantity::Force, Role::Excitation, Some(0.0)), noisy(force))
        .with(
            Channel::new("v", Quantity::Velocity, Role::DrivePoint, Some(0.0)),
            noisy(sampled(&velocity, omega, 0, rate, n)),
        )
}

#[test]
fn the_mode_indicator_has_its_closed_form_and_a_reversed_force_is_said() {
    let settings = ExtractionSettings { pbmif_harmonics: Some(10), ..ExtractionSettings::default() };
    let found = extract(&distorted(1.0), &settings).unwrap();
    let excitation = found.excitation.as_ref().unwrap();
    assert!((excitation.pbmif.value - 0.894_427).abs() < 2e-6, "{:?}", excitation.pbmif);
    assert_eq!(excitation.power.harmonics, 10);
    assert_eq!(found.finding_names(), "");
    let reversed = extract(&distorted(-1.0), &settings).unwrap();
    let excitation = reversed.excitation.as_ref().unwrap();
    assert!((excitation.pbmif.value + 0.894_427).abs() < 2e-6);
    assert_eq!(reversed.finding_names(), "reversed-force");
    let said = reversed.findings[0].to_string();
    assert!(said.contains("-0.8944") && said.contains("from 10 harmonics"), "{said}");
    // Without a limit all harmonics below half the sampling rate are used, and their number is reported: 75 · 33.3 Hz <
    // 2500 Hz.
    let all = extract(&distorted(1.0), &ExtractionSettings::default()).unwrap();
    assert_eq!(all.excitation.unwrap().power.harmonics, 75);
}

#[test]
fn velocity_and_acceleration_are_integrated_to_the_same_displacement() {
    let made = Motion::example(omega(), 20);
    let quantities = [Quantity::Displacement, Quantity::Velocity, Quantity::Acceleration];
    for (order, quantity) in quantities.into_iter().enumerate() {
        let samples = sampled(&made.at(3), made.omega, order as u32, 20_000.0, 9000);
        let channel = Channel::new("x", quantity, Role::Response, Some(POSITIONS[3]));
        let record = Record::new("one", 20_000.0).with(channel, samples);
        let settings = ExtractionSettings { omega: Some(omega() * 1.001), ..ExtractionSettings::default() };
        let found = extract(&record, &settings).unwrap();
        for n in 1..=20 {
            let (size, made) = (found.motion.of(0)[n].norm(), made.at(3)[n].norm());
            assert!((size - made).abs() < 1e-9 * made.max(1e-6), "{quantity} {n}: {size} {made}");
        }
        assert!(found.finding_names().starts_with("channel-missing"), "the force: {}", found.finding_names());
    }
}

#[test]
fn a_phase_channel_gives_the_frequency() {
    let made = Motion::example(omega(), 20);
    let mut record = made.record(20_000.0, 9700, 0.0, 1);
    let phase = (0..9700).map(|j| (0.4 + omega() * f64::from(j) / 20_000.0) % TAU).collect();
    record = record.with(Channel::new("p", Quantity::Phase, Role::ExcitationPhase, None), phase);
    let found = extract(&record, &settings()).unwrap();
    assert!((found.omega.value / omega() - 1.0).abs() < 1e-12, "{:?}", found.omega);
    assert_eq!(found.finding_names(), "");
    let last = record.samples.len() - 1;
    record.samples[last].iter_mut().enumerate().for_each(|(j, p)| *p = 1.001 * omega() * j as f64 / 20_000.0);
    let found = extract(&record, &settings()).unwrap();
    assert!(found.finding_names().contains("frequency-disagrees"), "{}", found.finding_names());
}

#[test]
fn a_known_delay_is_taken_out() {
    let made = Motion::example(omega(), 20);
    let mut record = made.record(20_000.0, 9700, 0.0, 1);
    let late = 1.7e-4;
    let q = made.at(1);
    let turned: Vec<Complex64> =
        q.iter().enumerate().map(|(n, q)| q * Complex64::cis(-(n as f64) * omega() * late)).collect();
    record.samples[3] = sampled(&turned, omega(), 2, 20_000.0, 9700);
    record.channels[3].delay = late;
    let found = extract(&record, &settings()).unwrap();
    assert!(deviation(&found, &made) < 1e-6);
}

/// Where the sensor at the stop measures displacement only, velocity and acceleration there are its derivatives.
#[test]
fn velocity_and_acceleration_at_the_stop_are_derivatives_of_the_displacement() {
    for (omega, rate) in [(omega(), 20_000.0), (1e-3 * omega(), 20.0)] {
        let made = Motion::example(omega, 12);
        let mut record = made.record(rate, 6_013, 0.0, 3);
        let tip = record.channels.iter().position(|channel| channel.name == "x_tip").unwrap();
        let x = record.samples[tip].clone();
        let gap = 0.9 * x.iter().copied().fold(0.0, f64::max);
        record.samples.push(x.iter().map(|x| (2e4 * (x - gap)).max(0.0)).collect());
        record.channels.push(Channel::new("f_stop", Quantity::Force, Role::Contact, Some(POSITIONS[3])));
        let stop = Some(Stop { position: POSITIONS[3], gap, positive: true });
        let found = extract(&record, &ExtractionSettings { stop, ..ExtractionSettings::default() }).unwrap();
        let history = found.contact.unwrap().history.unwrap();
        let first = x.windows(4).position(|window| window == &history.displacement[..4]).unwrap();
        assert_eq!(history.displacement, x[first..first + history.displacement.len()]);
        for (order, series) in [(1, &history.velocity), (2, &history.acceleration)] {
            let exact = sampled(&made.at(3), omega, order, rate, 6_013);
            let largest = exact.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
            assert_eq!(series.len(), history.time.len());
            for (found, expected) in series.iter().zip(&exact[first..]) {
                assert!((found - expected).abs() < 1e-6 * largest, "{order}: {found} {expected}");
            }
        }
    }
}

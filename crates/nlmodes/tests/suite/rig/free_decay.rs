//! Ring-down from a locked state, against the damped mode in closed form.

use std::f64::consts::TAU;

use nlmodes::rig::{
    ContactLaw, ControlChannels, DrivePoint, Exciter, LinearStructure, MotionQuantity, RigSetup, Sensor, SensorPlace,
    Session, Side, Stop,
};
use nlmodes_experiment::extraction::{ExtractionSettings, free_decay};
use nlmodes_experiment::phase_loop::{LevelSchedule, LoopSettings, Resonance, TestSettings};
use nlmodes_experiment::records::Record;
use nlmodes_modal::LinearModes;

const OMEGA: f64 = TAU * 40.0;
const ZETA: f64 = 0.003;
const RATE: f64 = 8000.0;
const GAP: f64 = 4e-4;
const STIFFNESS: f64 = 4e4;

/// A locked state, and the decay after the force is switched off.
fn record(with_stop: bool, noise: f64) -> Record {
    let stop = Stop {
        position: 0.1,
        shape: vec![1.0],
        side: Side::Positive,
        gap: GAP,
        law: ContactLaw::Elastic { stiffness: STIFFNESS },
        residual: 0.0,
    };
    let setup = RigSetup {
        structure: LinearStructure { omega: vec![OMEGA], damping_ratios: vec![ZETA] },
        drive_point: DrivePoint { position: 0.1, shape: vec![1.0], residual: 0.0 },
        exciter: Exciter::IdealForce,
        stop: with_stop.then_some(stop),
        sensors: vec![
            Sensor::new("force", SensorPlace::Excitation, 1e-4),
            Sensor::new("response", SensorPlace::DrivePoint(MotionQuantity::Displacement), noise),
        ],
        interval: 1.0 / RATE,
        substeps: None,
        seed: 5,
    };
    let settings = LoopSettings::new(Resonance { omega: OMEGA, damping_ratio: ZETA }, OMEGA - 2.0, 1.0 / RATE);
    let control = TestSettings::new(settings, LevelSchedule::new(&[0.6]).unwrap());
    let mut session = Session::new(setup, &control, ControlChannels::new(0, 1)).unwrap();
    session.go(0.6, 1.0).unwrap();
    session.run(6.0).unwrap();
    let (mut record, _) = session.record(1.0).unwrap();
    let (free, _) = session.record_ramp(0.0, 1.0 / RATE).unwrap();
    let (rest, _) = session.record(6.0).unwrap();
    for part in [free, rest] {
        record.samples.iter_mut().zip(part.samples).for_each(|(all, part)| all.extend(part));
    }
    record
}

fn settings() -> ExtractionSettings {
    let modes = LinearModes::new(&[0.1], &[OMEGA], &[ZETA], &[vec![1.0]]).unwrap();
    ExtractionSettings { linear_modes: Some(modes), ..ExtractionSettings::default() }
}

/// Frequency and amplitude of the fundamental of the undamped oscillator with this free amplitude.
fn backbone(free: f64) -> (f64, f64) {
    if free <= GAP {
        return (OMEGA, free);
    }
    // Before the stop about zero, against it about another place with another frequency.
    let stiff = (OMEGA * OMEGA + STIFFNESS).sqrt();
    let centre = STIFFNESS * GAP / (stiff * stiff);
    let speed = OMEGA * (free * free - GAP * GAP).sqrt();
    let size = (GAP - centre).hypot(speed / stiff);
    let [half_free, half_closed] =
        [(std::f64::consts::FRAC_PI_2 + (GAP / free).asin()) / OMEGA, ((GAP - centre) / size).acos() / stiff];
    let period = 2.0 * (half_free + half_closed);
    let omega = TAU / period;
    // From the middle of the contact.
    let at = |t: f64| {
        let t = if t > 0.5 * period { period - t } else { t };
        if t < half_closed { centre + size * (stiff * t).cos() } else { -free * (OMEGA * (0.5 * period - t)).cos() }
    };
    let n = 4000;
    let sum: f64 =
        (0..n).map(|j| at(period * f64::from(j) / f64::from(n)) * (TAU * f64::from(j) / f64::from(n)).cos()).sum();
    (omega, 2.0 * sum / f64::from(n))
}

/// The frequency of the backbone at an amplitude of the fundamental.
fn frequency_at(amplitude: f64) -> f64 {
    let (mut low, mut high) = (0.0, 10.0 * amplitude);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if backbone(middle).1 < amplitude { low = middle } else { high = middle }
    }
    backbone(low).0
}

#[test]
fn a_linear_mode_rings_down_with_its_damping_ratio() {
    for noise in [1e-12, 2e-7] {
        let found = free_decay(&record(false, noise), &settings(), None, None).unwrap();
        // It is switched off after a second.
        assert!((1.0..1.04).contains(&found.from) && found.points.len() > 20, "{} {}", found.from, found.points.len());
        let (mut within, mut all) = (0, 0);
        for point in &found.points {
            let damped = OMEGA * (1.0 - ZETA * ZETA).sqrt();
            let off = [(point.omega, damped), (point.damping, ZETA * OMEGA / damped)];
            for (found, truth) in off {
                assert!(
                    (found.value / truth - 1.0).abs() < 4.0 * found.uncertainty / truth + 2e-4,
                    "{found:?} {truth}"
                );
                within += usize::from((found.value - truth).abs() < 2.0 * found.uncertainty);
                all += 1;
            }
        }
        assert!(noise < 1e-9 || within * 100 > 88 * all, "{within} of {all}");
    }
}

#[test]
fn a_mode_before_a_stop_rings_down_along_its_damped_mode() {
    let found = free_decay(&record(true, 2e-8), &settings(), None, None).unwrap();
    let touching: Vec<_> = found.points.iter().filter(|point| point.omega.value > 1.01 * OMEGA).collect();
    assert!(touching.len() > 5, "{}", touching.len());
    for point in &found.points {
        let (omega, damping) = (frequency_at(point.amplitude.value), ZETA * OMEGA / point.omega.value);
        let near = (point.amplitude.value / GAP - 1.0).abs() < 0.1;
        // Where contact ends the frequency has a corner, which a smooth course rounds.
        let (of_omega, of_damping) = if near { (5e-3, 0.15) } else { (1e-3, 0.02) };
        assert!((point.omega.value / omega - 1.0).abs() < of_omega, "{point:?} {omega}");
        assert!((point.damping.value / damping - 1.0).abs() < of_damping, "{point:?} {damping}");
    }
    // The amplitude alone would not tell the damping: near contact it hardly changes.
    assert!(found.points.windows(2).all(|pair| pair[1].amplitude.value < pair[0].amplitude.value * 1.001));
}

#[test]
fn what_is_too_short_is_refused() {
    let record = record(false, 1e-9);
    let error = free_decay(&record, &settings(), Some(1.1), Some(1.4)).unwrap_err().to_string();
    assert!(error.contains("21"), "{error}");
}

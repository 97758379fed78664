//! One recorder for a whole test: levels with ramps and steps between them.

use std::f64::consts::TAU;

use nlmodes::rig::{
    ContactLaw, ControlChannels, DrivePoint, Exciter, LinearStructure, MotionQuantity, RigSetup, Sensor, SensorPlace,
    Session, Side, Stop,
};
use nlmodes_experiment::extraction::{ExtractionSettings, Steadiness, extract, steady_stretches};
use nlmodes_experiment::phase_loop::{LevelSchedule, LoopSettings, Resonance, TestSettings};
use nlmodes_experiment::records::Record;
use nlmodes_modal::LinearModes;

const OMEGA: f64 = TAU * 40.0;
const ZETA: f64 = 0.01;
const RATE: f64 = 4000.0;

/// One mode with an ideal force and a loop; with a stop at its drive point or without one.
fn session(noise: f64, stop: Option<Stop>) -> Session {
    let setup = RigSetup {
        structure: LinearStructure { omega: vec![OMEGA], damping_ratios: vec![ZETA] },
        drive_point: DrivePoint { position: 0.1, shape: vec![1.0], residual: 0.0 },
        exciter: Exciter::IdealForce,
        stop,
        sensors: vec![
            Sensor::new("force", SensorPlace::Excitation, noise),
            Sensor::new("response", SensorPlace::DrivePoint(MotionQuantity::Displacement), 1e-4 * noise),
        ],
        interval: 1.0 / RATE,
        substeps: None,
        seed: 3,
    };
    let settings = LoopSettings::new(Resonance { omega: OMEGA, damping_ratio: ZETA }, OMEGA - 2.0, 1.0 / RATE);
    let control = TestSettings::new(settings, LevelSchedule::new(&[0.5]).unwrap());
    Session::new(setup, &control, ControlChannels::new(0, 1)).unwrap()
}

/// The record of all levels, with the first sample and the end of each after its ramp (s) and before the next one.
fn recorded(mut session: Session, levels: &[(f64, f64)], hold: f64) -> (Record, Vec<[usize; 2]>) {
    let (mut all, mut held) = (None::<Record>, Vec::new());
    for (level, ramp) in levels {
        for (is_hold, duration) in [(false, *ramp), (true, hold)] {
            let (part, _) = session.record_ramp(*level, duration).unwrap();
            let before = all.as_ref().map_or(0, Record::n_samples);
            match &mut all {
                None => all = Some(part),
                Some(all) => {
                    all.samples.iter_mut().zip(part.samples).for_each(|(all, part)| all.extend(part));
                }
            }
            if is_hold {
                held.push([before, before + (hold * RATE).round() as usize]);
            }
        }
    }
    (all.unwrap(), held)
}

fn settings() -> ExtractionSettings {
    let modes = LinearModes::new(&[0.1], &[OMEGA], &[ZETA], &[vec![1.0]]).unwrap();
    ExtractionSettings { linear_modes: Some(modes), periods: Some(20), harmonics: 5, ..ExtractionSettings::default() }
}

#[test]
fn every_level_of_a_long_record_is_found_and_has_its_answer() {
    let levels = [(0.5, 0.4), (0.8, 0.6), (0.86, 1.0 / RATE), (0.3, 0.3)];
    for noise in [1e-7, 1e-3] {
        let (record, held) = recorded(session(noise, None), &levels, 3.0);
        let found = steady_stretches(&record, &settings(), &Steadiness::default()).unwrap();
        assert_eq!(found.len(), 4, "{noise}: {found:?} of {held:?}");
        for ((stretch, [first, end]), (force, _)) in found.iter().zip(&held).zip(levels) {
            // Within the level, to the last eight periods of it.
            assert!(
                stretch.start >= *first && stretch.end <= *end && end - stretch.end < 800,
                "{stretch:?} {first} {end}"
            );
            let found = extract(&record.part("level", stretch.clone()), &settings()).unwrap();
            let (modal, excitation) = (found.modal.as_ref().unwrap(), found.excitation.as_ref().unwrap());
            // Phase resonance: a force F against 2 ζ ω² q.
            let amplitude = force / (2.0 * ZETA * OMEGA * OMEGA);
            assert!((found.omega.value / OMEGA - 1.0).abs() < 2e-4, "{} of {force}", found.omega.value / OMEGA);
            assert!((modal.amplitude.value / amplitude - 1.0).abs() < 5e-3, "{force}");
            assert!((excitation.force.value / force - 1.0).abs() < 2e-3, "{force}");
            assert!((modal.damping.unwrap().value / ZETA - 1.0).abs() < 1e-2, "{force}");
        }
    }
}

#[test]
fn nothing_is_found_in_a_ramp_and_everything_in_one_level() {
    let (record, _) = recorded(session(1e-4, None), &[(0.5, 0.5), (5.0, 6.0)], 0.1);
    let found = steady_stretches(&record, &settings(), &Steadiness::default()).unwrap();
    assert!(found.iter().all(|stretch| stretch.end <= 2400), "{found:?}");
    let mut steady = session(1e-4, None);
    steady.go(0.5, 0.5).unwrap();
    steady.run(4.0).unwrap();
    let (record, _) = steady.record(2.0).unwrap();
    let found = steady_stretches(&record, &settings(), &Steadiness::default()).unwrap();
    assert_eq!(found, std::slice::from_ref(&(0..8000)));
}

/// Contact turns the frequency up while amplitudes hardly change: levels are told apart all the same.
#[test]
fn levels_in_contact_are_found_with_their_frequencies() {
    let stop = Stop {
        position: 0.1,
        shape: vec![1.0],
        gap: 4e-4,
        side: Side::Positive,
        law: ContactLaw::Elastic { stiffness: 2e4 },
        residual: 0.0,
    };
    let (record, held) = recorded(session(1e-5, Some(stop)), &[(0.4, 0.4), (0.9, 0.6), (1.3, 0.6)], 4.0);
    let found = steady_stretches(&record, &settings(), &Steadiness::default()).unwrap();
    assert_eq!(found.len(), 3, "{found:?} of {held:?}");
    let frequencies: Vec<f64> = found
        .iter()
        .map(|stretch| extract(&record.part("level", stretch.clone()), &settings()).unwrap().omega.value / OMEGA)
        .collect();
    assert!((frequencies[0] - 1.0).abs() < 1e-4, "{frequencies:?}");
    assert!(frequencies[1] > 1.01 && frequencies[2] > frequencies[1] + 0.01, "{frequencies:?}");
}

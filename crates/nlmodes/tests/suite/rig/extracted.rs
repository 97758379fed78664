//! Records of the rig, processed by the same extraction as measured ones.

use std::f64::consts::{FRAC_PI_2, TAU};

use nlmodes::rig::{ControlChannels, Exciter, LevelOutcome, RigSetup, Session, Shaker, VirtualTest};
use nlmodes_experiment::extraction::{self, ExtractionSettings, RecordExtraction, extract};
use nlmodes_experiment::phase_loop::{LevelSchedule, LoopSettings, Resonance, TestSettings};
use nlmodes_experiment::records::{Recording, write_record};
use nlmodes_modal::LinearModes;

use crate::rig::analysis::figures;
use crate::rig::beam;

/// Modes at the drive point, the accelerometers and the tip.
fn linear_modes(setup: &RigSetup) -> LinearModes {
    let shapes = beam::Shapes::new();
    let positions: Vec<f64> =
        [0.1 * beam::LENGTH].into_iter().chain(beam::ACCELEROMETERS).chain([beam::LENGTH]).collect();
    let rows: Vec<Vec<f64>> = positions.iter().map(|&x| shapes.at(x)).collect();
    LinearModes::new(&positions, &setup.structure.omega, &setup.structure.damping_ratios, &rows).unwrap()
}

fn outcomes() -> (VirtualTest, Vec<LevelOutcome>) {
    let resonance = Resonance { omega: TAU * beam::FREQUENCIES_HZ[0], damping_ratio: beam::DAMPING_RATIOS[0] };
    let phase = LoopSettings::new(resonance, TAU * 40.0, beam::INTERVAL);
    let test = VirtualTest {
        rig: beam::with_noise(beam::setup(Exciter::Shaker(Shaker::default()))),
        control: TestSettings::new(phase, LevelSchedule::new(&[0.75, 2.0]).unwrap()),
        channels: ControlChannels::new(beam::FORCE, beam::DRIVE_DISPLACEMENT),
        harmonics: None,
    };
    let outcomes = test.run(|_| {}).unwrap();
    (test, outcomes)
}

#[test]
fn the_extraction_finds_what_the_rig_did() {
    let (test, outcomes) = outcomes();
    let settings = ExtractionSettings {
        linear_modes: Some(linear_modes(&test.rig)),
        stop: Some(extraction::Stop { position: beam::LENGTH, gap: beam::GAP, positive: true }),
        pbmif_harmonics: Some(100),
        ..ExtractionSettings::default()
    };
    let extracted: Vec<RecordExtraction> = outcomes.iter().map(|o| extract(&o.record, &settings).unwrap()).collect();
    for (outcome, found) in outcomes.iter().zip(&extracted) {
        assert!(found.findings.is_empty(), "{}", found.finding_names());
        let own = figures(&test.rig, &outcome.record, outcome.steady.omega, 100);
        let (modal, excitation) = (found.modal.as_ref().unwrap(), found.excitation.as_ref().unwrap());
        // Two evaluations with the same noise: one second of record, a thousandth of a hertz and some 1e-4 of the
        // amplitudes.
        assert!((found.omega.value - outcome.steady.omega).abs() < TAU * 1e-3);
        assert!((modal.amplitude.value / own.amplitude - 1.0).abs() < 1e-4, "{:?} {}", modal.amplitude, own.amplitude);
        assert!((modal.damping.unwrap().value / own.damping - 1.0).abs() < 1e-3, "{:?} {}", modal.damping, own.damping);
        assert!((excitation.pbmif.value - own.pbmif).abs() < 2e-3, "{:?} {}", excitation.pbmif, own.pbmif);
        assert!((excitation.lag.value - FRAC_PI_2).abs() < 1e-3, "{:?}", excitation.lag);
    }
    let damping = extracted[0].modal.as_ref().unwrap().damping.unwrap().value;
    assert!((damping / beam::DAMPING_RATIOS[0] - 1.0).abs() < 1e-3, "{damping}");
    let contact = |k: usize| extracted[k].contact.as_ref().unwrap();
    assert!(contact(0).stiffness.is_none() && contact(0).restitution.is_none());
    let stiffness = contact(1).stiffness.as_ref().unwrap();
    assert!((stiffness.stiffness / 2.3e6 - 1.0).abs() < 0.01 && (stiffness.stop - beam::GAP).abs() < 1e-6);
    assert!((contact(1).intervals_per_period - 1.0).abs() < 1e-9);
}

#[test]
fn records_of_the_rig_survive_each_file_format() {
    let rig = beam::with_noise(beam::setup(Exciter::IdealForce));
    let resonance = Resonance { omega: TAU * 40.1, damping_ratio: 0.0019 };
    let settings = LoopSettings::new(resonance, TAU * 40.0, beam::INTERVAL);
    let control = TestSettings::new(settings, LevelSchedule::new(&[5.0]).unwrap());
    let channels = ControlChannels::new(beam::FORCE, beam::DRIVE_DISPLACEMENT);
    let mut session = Session::new(rig, &control, channels).unwrap();
    session.go(5.0, 0.2).unwrap();
    let (record, _) = session.record(0.1).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let recording =
        Recording { channels: record.si_channels(), sample_rate: Some(record.sample_rate), time_column: None };
    for extension in ["csv", "uff", "wav", "npy"] {
        let path = folder.path().join(format!("level.{extension}"));
        write_record(&path, &record).unwrap();
        let back = recording.read(&path).unwrap();
        assert_eq!(back.samples.len(), record.samples.len(), "{extension}");
        for (a, b) in back.samples.iter().zip(&record.samples) {
            let largest = b.iter().fold(0.0f64, |m, x| m.max(x.abs()));
            // Single precision is the least that a format has.
            assert!(a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-7 * largest), "{extension}");
        }
    }
}

//! Schedules, records, findings.

use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use nlmodes::rig::{ControlChannels, DRIVE_PHASE, Exciter, Finding, RigError, Session, Shaker, VirtualTest};
use nlmodes_experiment::phase_loop::{
    EmergencyReason, LevelSchedule, Limits, LoopSettings, PhaseLoopError, Resonance, ResponseQuantity, SteadyCriteria,
    TestSettings,
};
use nlmodes_experiment::records::{Quantity, Role};

use crate::rig::analysis::samples;
use crate::rig::beam;

fn channels() -> ControlChannels {
    ControlChannels::new(beam::FORCE, beam::DRIVE_DISPLACEMENT)
}

/// Two short levels, far from steady.
fn hasty(seed: u64) -> VirtualTest {
    let mut rig = beam::with_noise(beam::setup(Exciter::Shaker(Shaker::default())));
    rig.seed = seed;
    let resonance = Resonance { omega: TAU * 40.1, damping_ratio: 0.0019 };
    let settling = SteadyCriteria { periods: 10, longest: 1.0, ..SteadyCriteria::default() };
    let levels = LevelSchedule::new(&[0.5, 1.5, 0.5]).unwrap();
    let levels = LevelSchedule { start: 0.2, ramp: 0.1, settling, record: 0.25, ..levels };
    let phase = LoopSettings::new(resonance, TAU * 40.0, beam::INTERVAL);
    VirtualTest { rig, control: TestSettings::new(phase, levels), channels: channels(), harmonics: None }
}

#[test]
fn a_test_repeats_itself_from_its_seed_and_records_every_channel() {
    let test = hasty(7);
    let mut seen = 0;
    let outcomes = test.run(|_| seen += 1).unwrap();
    assert_eq!((outcomes.len(), seen), (3, 3));
    assert_eq!(outcomes, test.run(|_| {}).unwrap());
    assert_ne!(outcomes[0].record, hasty(8).run(|_| {}).unwrap()[0].record);
    assert_eq!([0, 1, 2].map(|i| outcomes[i].level), [0.5, 1.5, 0.5]);
    for outcome in &outcomes {
        let record = &outcome.record;
        assert_eq!(record.channels.len(), test.rig.sensors.len() + 1);
        assert!(record.samples.iter().all(|samples| samples.len() == 5000));
        assert!((record.sample_rate - 20_000.0).abs() < 1e-9);
        let tip = record.channels.iter().find(|channel| channel.name == "x_tip").unwrap();
        assert_eq!(
            (tip.quantity, tip.role, tip.position),
            (Quantity::Displacement, Role::Response, Some(beam::LENGTH))
        );
        assert!(samples(record, DRIVE_PHASE).iter().all(|θ| (0.0..TAU).contains(θ)));
    }
    assert!(outcomes.windows(2).all(|pair| pair[0].start + 0.25 < pair[1].start));
}

#[test]
fn a_level_is_interrupted_within_a_twentieth_of_a_second_of_the_motion() {
    // The first level takes 1.5 s at 20 kHz: thirty thousand samples and more.
    let asked = Arc::new(AtomicUsize::new(0));
    let asks = Arc::clone(&asked);
    let twice = move || match asks.fetch_add(1, Ordering::Relaxed) {
        0 => ControlFlow::Continue(()),
        _ => ControlFlow::Break(()),
    };
    let mut levels = 0;
    let outcome = hasty(7).run_while(twice, |_| {
        levels += 1;
        ControlFlow::Continue(())
    });
    assert_eq!(outcome, Err(RigError::Interrupted));
    assert_eq!((asked.load(Ordering::Relaxed), levels), (2, 0));
    let test = hasty(7);
    let session = Session::new(test.rig, &test.control, test.channels).unwrap();
    let mut session = session.asking(|| ControlFlow::Break(()));
    assert_eq!(session.run(1.0), Err(RigError::Interrupted));
    assert!(session.rig().time() < 0.05, "{} s", session.rig().time());
}

#[test]
fn what_is_not_yet_steady_is_said_with_its_number() {
    let outcomes = hasty(7).run(|_| {}).unwrap();
    let findings = &outcomes[0].findings;
    let drift = findings.iter().find_map(|finding| match finding {
        Finding::AmplitudeDrift { rate } => Some(*rate),
        _ => None,
    });
    // Half a second after 0.3 s at a constant force: an amplitude 1 − e^{−ζωt} grows by some ten to a hundred percent a
    // second.
    assert!(drift.is_some_and(|rate| (0.1..3.0).contains(&rate)), "{findings:?}");
    assert!(findings.iter().all(|finding| !finding.to_string().is_empty()));
}

#[test]
fn loops_that_do_not_fit_the_rig_are_refused() {
    let test = hasty(1);
    let refused = |change: &dyn Fn(&mut VirtualTest)| {
        let mut changed = test.clone();
        change(&mut changed);
        changed.run(|_| {}).unwrap_err()
    };
    assert!(matches!(refused(&|t| t.control.phase.step = 1e-4), RigError::SamplingIntervals { .. }));
    let velocity = refused(&|t| t.control.phase.quantity = ResponseQuantity::Velocity);
    assert!(matches!(velocity, RigError::ResponseQuantity { expected: "m/s", found: "m", .. }));
    assert!(matches!(refused(&|t| t.channels.response = 99), RigError::NoChannel { channel: 99, .. }));
    assert!(matches!(refused(&|t| t.control.phase.cut_off = 1e3), RigError::Loop(_)));
    assert!(matches!(
        refused(&|t| t.control.schedule.levels[0] = f64::NAN),
        RigError::Loop(PhaseLoopError::Negative { .. })
    ));
    assert!(matches!(
        refused(&|t| t.control.schedule.settling.windows = 1),
        RigError::Loop(PhaseLoopError::Windows { .. })
    ));
}

#[test]
fn a_loop_at_the_end_of_its_range_is_said_to_be_there() {
    let mut test = hasty(1);
    test.control.phase.range = [TAU * 39.0, TAU * 40.05];
    let mut session = Session::new(test.rig, &test.control, test.channels).unwrap();
    session.go(1.0, 0.5).unwrap();
    let (_, findings) = session.settle(&SteadyCriteria { longest: 4.0, ..SteadyCriteria::default() }).unwrap();
    let limit = findings.iter().any(|f| matches!(f, Finding::FrequencyLimit { omega } if *omega == TAU * 40.05));
    assert!(limit, "{findings:?}");
}

#[test]
fn a_level_that_was_held_for_two_windows_is_not_judged() {
    let mut test = hasty(1);
    test.control.schedule.settling.periods = 20;
    let outcomes = test.run(|_| {}).unwrap();
    let expected = Finding::HeldTooShort { windows: 0, needed: 6 };
    assert!(outcomes.iter().all(|outcome| outcome.findings == [expected]), "{:?}", outcomes[0].findings);
    assert!(expected.to_string().contains("0 windows of 6") && expected.name() == "held-too-short");
}

#[test]
fn a_limit_ends_the_test_and_needs_a_channel() {
    let mut test = hasty(1);
    test.control.limits = Limits { stroke: 1e-4, ..Limits::default() };
    assert_eq!(test.check(), Err(RigError::LimitWithoutChannel { what: "stroke" }));
    // The displacement of the tip.
    test.channels.stroke = Some(3);
    let ended = test.run(|_| {}).unwrap_err();
    assert!(matches!(ended, RigError::Stopped { reason: EmergencyReason::Stroke, .. }), "{ended}");
}

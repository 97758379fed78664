//! The beam of Table 1 under the control of the loop.

use std::f64::consts::{FRAC_PI_2, TAU};

use nlmodes::rig::{ControlChannels, Drive, Exciter, RigError, RigSetup, Session, Shaker, VirtualRig, VirtualTest};
use nlmodes_experiment::phase_loop::{
    Gains, LevelSchedule, LoopSettings, PhaseLoopError, Resonance, SteadyCriteria, TestSettings,
};
use num_complex::Complex64;

use crate::rig::analysis::{Figures, amplitudes, figures, samples};
use crate::rig::beam::{self, DRIVE_DISPLACEMENT, FORCE, INTERVAL};

const RESONANCE: Resonance = Resonance { omega: TAU * beam::FREQUENCIES_HZ[0], damping_ratio: beam::DAMPING_RATIOS[0] };

fn settings() -> LoopSettings {
    LoopSettings::new(RESONANCE, TAU * 40.0, INTERVAL)
}

fn channels() -> ControlChannels {
    ControlChannels::new(FORCE, DRIVE_DISPLACEMENT)
}

/// A loop that has just been started, after a second at `level` with frozen frequency.
fn started(setup: &RigSetup, settings: LoopSettings, level: f64) -> Session {
    let control = TestSettings::new(settings, LevelSchedule::new(&[level]).unwrap());
    let mut session = Session::new(setup.clone(), &control, channels()).unwrap();
    session.run(2.0).unwrap();
    session.go(level, 0.0).unwrap();
    session
}

/// Complex response at the shape `shape` per unit force at the drive point, from the modal equations.
fn receptance(setup: &RigSetup, shape: &[f64], residual: f64, ω: f64) -> Complex64 {
    let ModalTerms(terms) = ModalTerms::of(setup);
    terms.iter().zip(shape).fold(residual.into(), |sum, (&(ωk, ζ, φ), shape)| {
        sum + shape * φ / Complex64::new(ωk * ωk - ω * ω, 2.0 * ζ * ωk * ω)
    })
}

struct ModalTerms(Vec<(f64, f64, f64)>);

impl ModalTerms {
    fn of(setup: &RigSetup) -> Self {
        let pairs = setup.structure.omega.iter().zip(&setup.structure.damping_ratios);
        Self(pairs.zip(&setup.drive_point.shape).map(|((&ω, &ζ), &φ)| (ω, ζ, φ)).collect())
    }
}

/// Frequency of phase resonance of the linear beam, `f₁ (1 + 2 ζ₁² ω₁² R / φ_ex²)`: all other modes move the drive
/// point by `R f` in phase with the force.
fn linear_phase_resonance(setup: &RigSetup) -> f64 {
    let ModalTerms(terms) = ModalTerms::of(setup);
    let (ω, ζ, φ) = terms[0];
    let r = setup.drive_point.residual + terms[1..].iter().map(|(ω, _, φ)| (φ / ω).powi(2)).sum::<f64>();
    ω * (1.0 + 2.0 * ζ * ζ * ω * ω * r / (φ * φ))
}

#[test]
fn the_linear_beam_is_found_at_its_phase_resonance_with_its_damping() {
    let setup = beam::setup(Exciter::IdealForce);
    let expected = linear_phase_resonance(&setup) / TAU;
    assert!((expected - 40.10075).abs() < 1e-5, "{expected}");
    let mut session = started(&setup, settings(), 3.0);
    session.run(20.0).unwrap();
    let (record, steady) = session.record(1.0).unwrap();
    assert!((steady.omega / TAU - expected).abs() < 1e-5, "{}", steady.omega / TAU);
    let Figures { damping, pbmif, lag, modal, .. } = figures(&setup, &record, steady.omega, 20);
    // Decaying with ζω = 0.48/s, the rest of the transient is e^-9.6 of the amplitude.
    assert!((damping - 1.9e-3).abs() < 1e-6, "{damping}");
    assert!((pbmif - 1.0).abs() < 1e-6 && (lag - FRAC_PI_2).abs() < 1e-5, "{pbmif} {lag}");
    // The second mode follows statically: q_2 = φ_2 F / (ω_2² − ω²).
    let second = setup.drive_point.shape[1] * 3.0 / (setup.structure.omega[1].powi(2) - steady.omega.powi(2));
    assert!((modal[1].norm() / second.abs() - 1.0).abs() < 0.02, "{} {second}", modal[1].norm());
}

#[test]
fn contact_begins_at_the_force_of_the_linear_response() {
    let setup = beam::setup(Exciter::IdealForce);
    let tip = receptance(&setup, &setup.stop.as_ref().unwrap().shape, 0.0, linear_phase_resonance(&setup));
    let touching = beam::GAP / tip.norm();
    assert!((touching - 4.303).abs() < 1e-3, "{touching}");
    let mut session = started(&setup, settings(), 0.997 * touching);
    for (factor, contact) in [(0.997, false), (1.003, true)] {
        session.go(factor * touching, 0.5).unwrap();
        session.run(12.0).unwrap();
        let (record, steady) = session.record(0.5).unwrap();
        let largest = samples(&record, "f_contact").iter().fold(0.0f64, |a, b| a.max(*b));
        let tip = amplitudes(&record, "x_tip", 1)[0].norm();
        assert_eq!(largest > 0.0, contact, "{factor}: {tip}");
        assert_eq!(steady.omega / TAU > 40.11, contact, "{}", steady.omega / TAU);
    }
}

#[test]
fn the_shaker_goes_up_the_backbone_at_ninety_degrees() {
    let test = VirtualTest {
        rig: beam::with_noise(beam::setup(Exciter::Shaker(Shaker::default()))),
        control: TestSettings::new(settings(), LevelSchedule::new(&[0.25, 0.75, 1.2, 2.0, 3.0]).unwrap()),
        channels: channels(),
        harmonics: None,
    };
    let outcomes = test.run(|_| {}).unwrap();
    let all: Vec<Figures> = outcomes.iter().map(|o| figures(&test.rig, &o.record, o.steady.omega, 100)).collect();
    for (outcome, figures) in outcomes.iter().zip(&all) {
        assert!(outcome.findings.is_empty(), "{:?}", outcome.findings);
        assert!((figures.lag.to_degrees() - 90.0).abs() < 0.05, "{} V: {}", outcome.level, figures.lag.to_degrees());
        // Two estimates from the same noise, which is 7e-10 m in one of them.
        assert!((outcome.steady.lag - figures.lag).abs() < 1e-5 + 3e-9 / outcome.steady.response);
    }
    for (outcome, figures) in outcomes[..2].iter().zip(&all) {
        // Noise of the sensors: 1e-4 of the amplitudes in one second of record.
        assert!((outcome.steady.omega / TAU - 40.10075).abs() < 1e-3, "{}", outcome.steady.omega / TAU);
        assert!((figures.pbmif - 1.0).abs() < 5e-4 && (figures.damping / 1.9e-3 - 1.0).abs() < 2e-3);
    }
    for pair in [1, 2, 3].map(|k| [k, k + 1]) {
        let [before, after] = pair.map(|k| &all[k]);
        assert!(outcomes[pair[1]].steady.omega > outcomes[pair[0]].steady.omega);
        assert!(after.damping > before.damping && after.pbmif < before.pbmif && after.amplitude > before.amplitude);
        let second = after.modal[1].norm() / after.modal[0].norm();
        assert!((5e-4..0.02).contains(&second), "{second}");
    }
}

/// Frequency at the end of a settled level.
fn settled(session: &mut Session, level: f64) -> f64 {
    session.go(level, 1.0).unwrap();
    let (_, findings) = session.settle(&SteadyCriteria::default()).unwrap();
    assert!(findings.is_empty(), "{level} N: {findings:?}");
    session.record(1.0).unwrap().1.omega / TAU
}

#[test]
fn two_motions_coexist_at_five_newton() {
    let mut session = started(&beam::setup(Exciter::IdealForce), settings(), 4.6);
    let up = settled(&mut session, 5.0);
    settled(&mut session, 5.4);
    settled(&mut session, 5.2);
    let down = settled(&mut session, 5.0);
    assert!(down - up > 0.3, "{up} {down}");
}

#[test]
fn without_control_the_response_falls() {
    let mut controlled = started(&beam::setup(Exciter::IdealForce), settings(), 4.0);
    controlled.go(6.5, 1.0).unwrap();
    controlled.run(10.0).unwrap();
    let (_, locked) = controlled.record(5.0).unwrap();
    assert!((locked.lag - FRAC_PI_2).abs() < 0.05, "{locked:?}");
    let (mut generated, mut theta) = (controlled.rig().clone(), controlled.state().phase().drive_phase());
    // Three percent less force for two seconds: enough to pass the fold of the frequency response.
    controlled.go(0.97 * 6.5, 0.5).unwrap();
    controlled.run(2.0).unwrap();
    controlled.go(6.5, 0.5).unwrap();
    controlled.run(6.0).unwrap();
    let (_, with) = controlled.record(2.5).unwrap();
    let mut generate = |from: f64, to: f64, duration: f64| {
        generated_response(&mut generated, &mut theta, locked.omega, [from, to], duration)
    };
    generate(6.5, 0.97 * 6.5, 0.5);
    generate(0.97 * 6.5, 0.97 * 6.5, 2.0);
    generate(0.97 * 6.5, 6.5, 0.5);
    generate(6.5, 6.5, 6.0);
    let without = generate(6.5, 6.5, 1.0);
    assert!((with.response / locked.response - 1.0).abs() < 0.01, "{with:?} {locked:?}");
    // The drive is a cosine: the phase of the response is its lag, with the sign reversed.
    assert!(without.norm() < 0.2 * locked.response && (-without.arg()).rem_euclid(TAU) > 2.5, "{without}");
}

/// Drives with a generator of constant frequency, and the fundamental of the response, m.
fn generated_response(
    rig: &mut VirtualRig,
    theta: &mut f64,
    omega: f64,
    [from, to]: [f64; 2],
    duration: f64,
) -> Complex64 {
    let samples = (duration / INTERVAL).round() as usize;
    let at = |k: usize| from + (to - from) * k as f64 / samples as f64;
    let mut sum = Complex64::ZERO;
    for k in 0..samples {
        sum += rig.exact(DRIVE_DISPLACEMENT).unwrap() * Complex64::cis(-*theta);
        rig.advance(&Drive::sine([at(k), at(k + 1)], *theta, omega)).unwrap();
        *theta += omega * INTERVAL;
    }
    sum * (2.0 / samples as f64)
}

#[test]
fn the_rig_is_stable_up_to_the_limit_of_routh_and_not_beyond() {
    let mut setup = RigSetup { stop: None, ..beam::setup(Exciter::IdealForce) };
    setup.sensors.truncate(2);
    // A loop designed for three times the damping permits larger gains than the beam tolerates.
    let believed = Resonance { damping_ratio: 3.0 * RESONANCE.damping_ratio, ..RESONANCE };
    let settings = LoopSettings { resonance: believed, start: TAU * 40.1, ..settings() };
    let low_pass = settings.detector.low_pass(settings.cut_off);
    let proportional = 2.0;
    let limit = Gains { proportional, integral: 0.0 }.integral_limit(RESONANCE, low_pass);
    let growth = |factor: f64| {
        let gains = Some(Gains { proportional, integral: factor * limit });
        let levels = LevelSchedule { start: 9.0, ..LevelSchedule::new(&[3.0]).unwrap() };
        let control = TestSettings::new(LoopSettings { gains, ..settings.clone() }, levels);
        let mut session = Session::new(setup.clone(), &control, channels()).unwrap();
        session.run(10.0).unwrap();
        session.go(3.0, 0.0).unwrap();
        let mut swing = |seconds: usize| {
            (0..40 * seconds).fold(0.0f64, |m, _| {
                session.run(0.025).unwrap();
                m.max(session.state().phase().error().unwrap().abs())
            })
        };
        let (early, _, late) = (swing(3), swing(6), swing(3));
        late / early
    };
    let (below, beyond) = (growth(0.9), growth(1.1));
    assert!(below < 0.5 && beyond > 2.0, "{below} {beyond}");
    let gains = Some(Gains { proportional, integral: 1.1 * limit });
    let phase = LoopSettings { gains, resonance: RESONANCE, ..settings };
    let control = TestSettings::new(phase, LevelSchedule::new(&[3.0]).unwrap());
    let refused = Session::new(setup.clone(), &control, channels());
    assert!(matches!(refused.unwrap_err(), RigError::Loop(PhaseLoopError::UnstableGains { .. })));
}

//! Multipliers of rig and control as one periodic system.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes::rig::{
    ControlChannels, DrivePoint, Exciter, HeldLevel, LevelsAhead, LinearStructure, MotionQuantity, RigSetup, Sensor,
    SensorPlace, Shaker, VirtualTest,
};
use nlmodes_experiment::phase_loop::{
    AmplitudeSettings, Gains, LevelSchedule, LoopSettings, LowPass, Resonance, TestSettings,
};
use num_complex::Complex64;

use crate::rig::beam::{self, DRIVE_DISPLACEMENT, FORCE, INTERVAL};

fn ahead(rig: RigSetup, phase: LoopSettings, levels: &[f64]) -> Vec<HeldLevel> {
    let control = TestSettings::new(phase, LevelSchedule::new(levels).unwrap());
    let test = VirtualTest { rig, control, channels: ControlChannels::new(0, 1), harmonics: None };
    LevelsAhead::new(&test).unwrap().all(|| ControlFlow::Continue(())).unwrap()
}

const RESONANCE: Resonance = Resonance { omega: TAU * 40.0, damping_ratio: 0.01 };

/// One mode under an ideal force, without a stop.
fn linear() -> RigSetup {
    RigSetup {
        structure: LinearStructure { omega: vec![RESONANCE.omega], damping_ratios: vec![RESONANCE.damping_ratio] },
        drive_point: DrivePoint { position: 0.1, shape: vec![1.0], residual: 0.0 },
        exciter: Exciter::IdealForce,
        stop: None,
        sensors: vec![
            Sensor::new("force", SensorPlace::Excitation, 0.0),
            Sensor::new("response", SensorPlace::DrivePoint(MotionQuantity::Displacement), 0.0),
        ],
        interval: 1e-4,
        substeps: None,
        seed: 1,
    }
}

/// Roots of `s (s + ω_c) (s + δ) + ω_c (K_p s + K_i)` by the iteration of Durand and Kerner, 1/s.
fn roots(gains: Gains, low_pass: LowPass) -> [Complex64; 3] {
    let (delta, w) = (RESONANCE.decay_rate(), low_pass.cut_off);
    let p = |s: Complex64| s * (s + w) * (s + delta) + w * (s * gains.proportional + gains.integral);
    let mut roots = [1, 2, 3].map(|k| Complex64::from_polar(w, 1.0 + 2.0 * f64::from(k)));
    for _ in 0..500 {
        for k in 0..3 {
            let others: Complex64 = (0..3).filter(|j| *j != k).map(|j| roots[k] - roots[j]).product();
            roots[k] -= p(roots[k]) / others;
        }
    }
    roots
}

/// A slow detector, so that the averaged equations hold.
fn slow(gains: Option<Gains>) -> LoopSettings {
    let settings = LoopSettings::new(RESONANCE, TAU * 39.9, 1e-4);
    LoopSettings { cut_off: 0.02 * RESONANCE.omega, gains, ..settings }
}

fn exponents(level: &HeldLevel) -> Vec<Complex64> {
    let motion = level.motion.as_ref().unwrap();
    motion.multipliers.iter().map(|μ| μ.ln() * motion.omega / TAU).collect()
}

#[test]
fn a_linear_mode_has_the_roots_of_the_averaged_loop_and_its_own_decay() {
    let settings = slow(None);
    let low_pass = settings.detector.low_pass(settings.cut_off);
    let level = ahead(linear(), settings, &[1.0]).remove(0);
    let motion = level.motion.as_ref().unwrap();
    assert!((motion.omega / RESONANCE.omega - 1.0).abs() < 1e-9 && motion.trivial_defect < 1e-6, "{motion:?}");
    // X = F/(2 ζ ω²) of a unit mass.
    let response = 1.0 / (2.0 * RESONANCE.damping_ratio * RESONANCE.omega.powi(2));
    assert!((motion.response / response - 1.0).abs() < 1e-6 && (motion.force - 1.0).abs() < 1e-9);
    assert!((motion.peaks[1] / response - 1.0).abs() < 1e-3);
    let found = exponents(&level);
    let decay = Complex64::from(-RESONANCE.decay_rate());
    for expected in roots(Gains::design(RESONANCE, low_pass).unwrap(), low_pass).into_iter().chain([decay]) {
        let off = found.iter().map(|s| (s - expected).norm()).fold(f64::INFINITY, f64::min);
        // Averaging: to the order of ω_c/ω of the root.
        assert!(off < 0.02 * expected.norm(), "{expected}: off by {off}");
    }
    assert!(level.is_held(40.0) && !level.jumped && level.by_amplitude.is_none());
}

#[test]
fn multipliers_leave_the_circle_at_the_limit_of_routh() {
    // A loop designed for three times the damping permits larger gains than the mode tolerates.
    let believed = Resonance { damping_ratio: 3.0 * RESONANCE.damping_ratio, ..RESONANCE };
    let low_pass = slow(None).detector.low_pass(slow(None).cut_off);
    let limit = Gains { proportional: 2.0, integral: 0.0 }.integral_limit(RESONANCE, low_pass);
    for (share, held) in [(0.95, true), (1.05, false)] {
        let gains = Gains { proportional: 2.0, integral: share * limit };
        let level = ahead(linear(), LoopSettings { resonance: believed, ..slow(Some(gains)) }, &[1.0]).remove(0);
        let expected = roots(gains, low_pass).into_iter().map(|s| s.re).fold(f64::MIN, f64::max);
        let found = -level.motion.as_ref().unwrap().decay_rate();
        assert_eq!((expected < 0.0, level.is_held(1e3)), (held, held), "{share}: {found} {expected}");
        assert!((found - expected).abs() < 0.02 * low_pass.cut_off, "{share}: {found} {expected}");
    }
}

/// `docs/experiment.md` has these multipliers at a fixed frequency, from a Poincaré map of its own
/// (`examples/frozen_frequency.rs`): at 6.5 N −0.667 ± 0.795i, of magnitude 1.037. There the loop, which is much
/// slower, changes nothing. At 5 N two motions coexist, of which the way up and the way down have one each.
#[test]
fn the_beam_loses_its_level_at_six_and_a_half_newton() {
    let resonance = Resonance { omega: TAU * beam::FREQUENCIES_HZ[0], damping_ratio: beam::DAMPING_RATIOS[0] };
    let settings = LoopSettings::new(resonance, TAU * 40.0, INTERVAL);
    let found = ahead(beam::setup(Exciter::IdealForce), settings, &[4.6, 5.0, 5.4, 6.5, 7.0, 5.0]);
    let motions: Vec<_> = found.iter().map(|level| level.motion.as_ref().unwrap()).collect();
    let held: Vec<bool> = found.iter().map(|level| level.is_held(40.0)).collect();
    // At 7 N it could be held, but the level before it is lost, and the motion may go elsewhere.
    assert_eq!(held, [true, true, true, false, false, true]);
    assert!(motions[4].is_held() && found[4].after_lost && !found[5].after_lost);
    let hz: Vec<f64> = motions.iter().map(|motion| motion.omega / TAU).collect();
    for (found, expected) in hz.iter().zip([40.302, 40.355, 41.1491, 41.7645, 41.8708, 40.935]) {
        assert!((found - expected).abs() < 1e-3, "{hz:?}");
    }
    let lost = motions[3].multipliers[0];
    assert!((lost.norm() - 1.037).abs() < 2e-3 && (lost.re + 0.667).abs() < 2e-3, "{lost}");
    // The branch of the way up ends between 5 and 5.4 N.
    let jumped: Vec<bool> = found.iter().map(|level| level.jumped).collect();
    assert_eq!(jumped, [false, false, true, false, false, false]);
    // Impacts that grow from period to period are nothing that a slow control of the amplitude reaches.
    assert!(found[3].by_amplitude.as_ref().is_none_or(|motion| !motion.is_held()));
}

#[test]
fn levels_of_the_shaker_settle_in_the_time_that_their_multipliers_tell() {
    let resonance = Resonance { omega: TAU * beam::FREQUENCIES_HZ[0], damping_ratio: beam::DAMPING_RATIOS[0] };
    let phase = LoopSettings::new(resonance, TAU * 40.0, INTERVAL);
    let test = VirtualTest {
        rig: beam::setup(Exciter::Shaker(Shaker::default())),
        control: TestSettings::new(phase, LevelSchedule::new(&[0.9, 1.2, 2.0]).unwrap()),
        channels: ControlChannels::new(FORCE, DRIVE_DISPLACEMENT),
        harmonics: None,
    };
    let ahead = LevelsAhead::new(&test).unwrap().all(|| ControlFlow::Continue(())).unwrap();
    let outcomes = test.run(|_| {}).unwrap();
    for (level, outcome) in ahead.iter().zip(&outcomes).skip(1) {
        let motion = level.motion.as_ref().unwrap();
        assert!(outcome.findings.is_empty() && level.is_held(40.0));
        assert!((motion.omega / outcome.steady.omega - 1.0).abs() < 1e-5, "{}", motion.omega / TAU);
        assert!((motion.response / outcome.steady.response - 1.0).abs() < 1e-4);
        // Whole windows of 0.5 s; a level begins with more than its slowest disturbance.
        assert!((level.settling / outcome.settling - 1.0).abs() < 0.5, "{} {}", level.settling, outcome.settling);
        let contact = outcome.record.samples[5].iter().fold(0.0, |m: f64, x| m.max(*x));
        assert!((motion.peaks[5] / contact - 1.0).abs() < 0.02, "{} {contact}", motion.peaks[5]);
    }
}

/// Stepped response: between 1 V and 1.6 V the response grows by 2 % only, and the drive by 60.
#[test]
fn the_amplitude_of_the_response_is_held_with_contact_in_seconds() {
    let resonance = Resonance { omega: TAU * beam::FREQUENCIES_HZ[0], damping_ratio: beam::DAMPING_RATIOS[0] };
    let phase = LoopSettings::new(resonance, TAU * 40.0, INTERVAL);
    let mut control = TestSettings::new(phase, LevelSchedule::new(&[1.72e-5, 1.74e-5, 1.7683e-5]).unwrap());
    control.amplitude = AmplitudeSettings::response(&control.phase, 0.1);
    let rig = beam::setup(Exciter::Shaker(Shaker::default()));
    let test = VirtualTest { rig, control, channels: ControlChannels::new(0, 1), harmonics: None };
    let found = LevelsAhead::new(&test).unwrap().all(|| ControlFlow::Continue(())).unwrap();
    for level in &found {
        let motion = level.motion.as_ref().unwrap();
        assert!(level.is_held(100.0) && (motion.response / level.level - 1.0).abs() < 1e-4, "{level:?}");
    }
    // Phase control alone: 41.194 Hz with 1.7671e-5 m at 1.45 V, 41.270 Hz with 1.7704e-5 m at 1.5 V.
    let motion = found[2].motion.as_ref().unwrap();
    assert!((motion.omega / TAU - 41.22).abs() < 0.015, "{}", motion.omega / TAU);
    assert!(motion.decay_rate() > 0.1, "{}", motion.decay_rate());
}

//! Cells, filters and cables between a quantity and its samples.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes::rig::{
    Chain, ContactLaw, ControlChannels, Drive, DrivePoint, Exciter, LevelsAhead, LinearStructure, MotionQuantity,
    RigError, RigSetup, Sensor, SensorPlace, Side, Stage, Stop, VirtualRig, VirtualTest,
};
use nlmodes_experiment::phase_loop::{LevelSchedule, LoopSettings, Resonance, TestSettings};
use num_complex::Complex64;

const OMEGA: f64 = TAU * 40.0;
const ZETA: f64 = 0.02;
const INTERVAL: f64 = 1e-4;
const FORCE: f64 = 0.5;

/// One mode under an ideal force, and its force twice: through a chain and without one.
fn setup(chain: Chain, stop: Option<Stop>) -> RigSetup {
    let of = |name: &str, place| Sensor::new(name, place, 0.0);
    let place = if stop.is_some() { SensorPlace::Stop } else { SensorPlace::Excitation };
    RigSetup {
        structure: LinearStructure { omega: vec![OMEGA], damping_ratios: vec![ZETA] },
        drive_point: DrivePoint { position: 0.1, shape: vec![1.0], residual: 0.0 },
        exciter: Exciter::IdealForce,
        stop,
        sensors: vec![
            Sensor { chain, ..of("cell", place.clone()) },
            of("truth", place),
            of("x", SensorPlace::DrivePoint(MotionQuantity::Displacement)),
            of("a", SensorPlace::DrivePoint(MotionQuantity::Acceleration)),
        ],
        interval: INTERVAL,
        substeps: None,
        seed: 1,
    }
}

/// Fundamentals of all channels under a drive of this frequency, after the transient.
fn fundamentals(setup: RigSetup, omega: f64) -> Vec<Complex64> {
    let mut rig = VirtualRig::new(setup).unwrap();
    let (wait, periods) = (12.0 / (ZETA * OMEGA), 20.0);
    let (first, last) = ((wait / INTERVAL) as usize, ((wait + periods * TAU / omega) / INTERVAL) as usize);
    let (mut sums, mut weights) = (vec![Complex64::ZERO; 4], 0.0);
    for k in 0..last {
        let theta = omega * INTERVAL * k as f64;
        if k >= first {
            let share = (k - first) as f64 / (last - first) as f64;
            let weight = (0.5 * TAU * share).sin().powi(4);
            weights += weight;
            for (channel, sum) in sums.iter_mut().enumerate() {
                *sum += rig.read(channel).unwrap() * Complex64::cis(-theta) * 2.0 * weight;
            }
        }
        rig.advance(&Drive::sine([FORCE; 2], theta, omega)).unwrap();
    }
    sums.into_iter().map(|sum| sum / weights).collect()
}

#[test]
fn cell_and_filter_have_the_transfer_functions_of_their_stages() {
    let stages = vec![Stage { omega: TAU * 300.0, damping_ratio: 0.05 }, Stage::low_pass(1000.0)];
    for omega in [TAU * 35.0, TAU * 250.0] {
        let found = fundamentals(setup(Chain { stages: stages.clone(), ..Chain::default() }, None), omega);
        let expected: Complex64 = stages
            .iter()
            .map(|s| {
                s.omega.powi(2)
                    / Complex64::new(s.omega.powi(2) - omega * omega, 2.0 * s.damping_ratio * s.omega * omega)
            })
            .product();
        let ratio = found[0] / found[1];
        assert!((found[1] - FORCE).norm() < 1e-6 && (ratio / expected - 1.0).norm() < 1e-5, "{ratio} {expected}");
    }
}

#[test]
fn the_mass_of_a_cell_reads_its_own_inertia() {
    let found = fundamentals(setup(Chain { mass: 0.03, ..Chain::default() }, None), TAU * 50.0);
    assert!((found[0] - found[1] - 0.03 * found[3]).norm() < 1e-9 * found[0].norm());
    assert!((found[3] + (TAU * 50.0).powi(2) * found[2]).norm() < 1e-4 * found[3].norm());
}

/// Impacts on a slow cell: its force lags and rings, but its impulse over a period is that of the contact.
#[test]
fn a_ringing_cell_keeps_the_impulse_of_an_impact() {
    let stop = Stop {
        position: 0.1,
        shape: vec![1.0],
        side: Side::Positive,
        gap: 1e-4,
        law: ContactLaw::Elastic { stiffness: 1e6 },
        residual: 0.0,
    };
    let stages = vec![Stage { omega: TAU * 800.0, damping_ratio: 0.1 }];
    let mut rig = VirtualRig::new(setup(Chain { stages, ..Chain::default() }, Some(stop))).unwrap();
    let (mut sums, mut peaks, mut lowest) = ([0.0; 2], [0.0_f64; 2], 0.0_f64);
    for k in 0..40_000 {
        let theta = 0.9 * OMEGA * INTERVAL * f64::from(k);
        rig.advance(&Drive::sine([4.0; 2], theta, 0.9 * OMEGA)).unwrap();
        let read = [0, 1].map(|channel| rig.read(channel).unwrap());
        for ((sum, peak), x) in sums.iter_mut().zip(&mut peaks).zip(read) {
            (*sum, *peak) = (*sum + x, peak.max(x));
        }
        lowest = lowest.min(read[0]);
    }
    assert!((sums[0] / sums[1] - 1.0).abs() < 2e-3, "{sums:?}");
    // It overshoots, and swings below zero behind the impact.
    assert!(peaks[0] > 1.03 * peaks[1] && lowest < -0.1 * peaks[0], "{peaks:?} {lowest}");
}

#[test]
fn what_cannot_be_a_state_or_a_sensor_is_refused() {
    let mut direct = setup(Chain::default(), None);
    direct.drive_point.residual = 1e-7;
    direct.sensors[3].chain.stages = vec![Stage::low_pass(500.0)];
    assert_eq!(VirtualRig::new(direct).unwrap_err(), RigError::DriveInSensor);
    let bad = setup(Chain { delay: f64::NAN, ..Chain::default() }, None);
    assert!(matches!(VirtualRig::new(bad), Err(RigError::Negative { .. })));
    let bad = setup(Chain { stages: vec![Stage::low_pass(0.0)], ..Chain::default() }, None);
    assert!(matches!(VirtualRig::new(bad), Err(RigError::NotPositive { .. })));
}

/// A late response is taken to lag: phase resonance is found below the resonance, where the structure lags less.
#[test]
fn a_late_response_shifts_phase_resonance_and_its_multipliers_know() {
    let delay = 2e-4;
    let mut rig = setup(Chain::default(), None);
    rig.sensors[2].chain.delay = delay;
    let phase = LoopSettings::new(Resonance { omega: OMEGA, damping_ratio: ZETA }, 0.998 * OMEGA, INTERVAL);
    let control = TestSettings::new(phase, LevelSchedule::new(&[FORCE]).unwrap());
    let test = VirtualTest { rig, control, channels: ControlChannels::new(0, 2), harmonics: None };
    let found = test.run(|_| {}).unwrap().remove(0);
    assert!(found.findings.is_empty(), "{:?}", found.findings);
    // The lag of the structure is π/2 − ωτ: 1 − ω²/ω₀² = 2 ζ (ω/ω₀) tan ωτ.
    let off = |omega: f64| {
        let r = omega / OMEGA;
        1.0 - r * r - 2.0 * ZETA * r * (omega * delay).tan()
    };
    let (mut low, mut high) = (0.9 * OMEGA, OMEGA);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if off(middle) > 0.0 { low = middle } else { high = middle }
    }
    assert!((found.steady.omega / low - 1.0).abs() < 1e-6, "{} {}", found.steady.omega / TAU, low / TAU);
    let ahead = LevelsAhead::new(&test).unwrap().all(|| ControlFlow::Continue(())).unwrap();
    let motion = ahead[0].motion.as_ref().unwrap();
    assert!((motion.omega / low - 1.0).abs() < 1e-6 && motion.is_held(), "{}", motion.omega / TAU);
}

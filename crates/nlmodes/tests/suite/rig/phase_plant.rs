//! Gains of the loop from structure and exciter, against the multipliers of the rig under its control.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes::rig::{
    Chain, ControlChannels, DrivePoint, Exciter, LevelsAhead, LinearStructure, MotionQuantity, PhasePlant, RigSetup,
    Sensor, SensorPlace, Shaker, Stage, VirtualTest,
};
use nlmodes_experiment::phase_loop::{Gains, LevelSchedule, LoopSettings, Resonance, TestSettings};
use num_complex::Complex64;

const OMEGA: f64 = TAU * 40.0;
const DAMPING: f64 = 0.01;

/// Two modes under an exciter, with a drive point that moves so much in the first.
fn rig(exciter: Exciter, shape: f64, chain: Chain) -> RigSetup {
    let sensor = |name: &str, place| Sensor { chain: chain.clone(), ..Sensor::new(name, place, 0.0) };
    RigSetup {
        structure: LinearStructure { omega: vec![OMEGA, 6.3 * OMEGA], damping_ratios: vec![DAMPING, 0.005] },
        drive_point: DrivePoint { position: 0.1, shape: vec![shape, 0.3], residual: 0.0 },
        exciter,
        stop: None,
        sensors: vec![
            sensor("force", SensorPlace::Excitation),
            Sensor::new("response", SensorPlace::DrivePoint(MotionQuantity::Displacement), 0.0),
        ],
        interval: 1e-4,
        substeps: None,
        seed: 1,
    }
}

fn settings(cut_off: f64, gains: Option<Gains>) -> LoopSettings {
    let resonance = Resonance { omega: OMEGA, damping_ratio: DAMPING };
    LoopSettings { cut_off, gains, ..LoopSettings::new(resonance, 0.998 * OMEGA, 1e-4) }
}

/// Exponents of rig and control, and the frequency at which they settle.
fn exponents(rig: &RigSetup, phase: LoopSettings, level: f64) -> (Vec<Complex64>, f64) {
    let control = TestSettings::new(phase, LevelSchedule::new(&[level]).unwrap());
    let channels = ControlChannels::new(0, 1);
    let test = VirtualTest { rig: rig.clone(), control, channels, harmonics: None };
    let level = LevelsAhead::new(&test).unwrap().all(|| ControlFlow::Continue(())).unwrap().remove(0);
    let motion = level.motion.unwrap();
    (motion.multipliers.iter().map(|multiplier| multiplier.ln() * motion.omega / TAU).collect(), motion.omega)
}

#[test]
fn an_ideal_force_on_one_mode_is_a_lag_of_first_order() {
    let mut alone = rig(Exciter::IdealForce, 1.0, Chain::default());
    alone.structure = LinearStructure { omega: vec![OMEGA], damping_ratios: vec![DAMPING] };
    alone.drive_point.shape = vec![1.0];
    let plant = PhasePlant::new(&alone, &ControlChannels::new(0, 1), OMEGA);
    for y in [0.1, 1.0, 5.0] {
        let s = Complex64::new(0.0, y);
        let expected = (s + DAMPING * OMEGA).inv();
        assert!((plant.lag(s) / expected - 1.0).norm() < 0.5 * y / OMEGA + 2e-2, "{y}: {}", plant.lag(s) / expected);
    }
    let low_pass = settings(0.05 * OMEGA, None).detector.low_pass(0.05 * OMEGA);
    let (own, ideal) = (
        plant.design(low_pass).unwrap(),
        Gains::design(Resonance { omega: OMEGA, damping_ratio: DAMPING }, low_pass).unwrap(),
    );
    assert!((own.proportional / ideal.proportional - 1.0).abs() < 0.03, "{own:?} {ideal:?}");
    assert!((own.integral / ideal.integral - 1.0).abs() < 0.03, "{own:?} {ideal:?}");
}

/// Where rig and control as a periodic system have an exponent `s`, the open loop is minus one.
#[test]
fn exponents_of_the_closed_loop_are_roots_of_the_open_one_with_its_shaker() {
    let shaker = Exciter::Shaker(Shaker::default());
    let slow = Chain { stages: vec![Stage { omega: 3.0 * OMEGA, damping_ratio: 0.7 }], ..Chain::default() };
    for (exciter, shape, chain) in [
        (Exciter::IdealForce, 1.0, Chain::default()),
        (shaker, 0.1, Chain::default()),
        (shaker, 0.4, Chain::default()),
        (shaker, 0.4, slow),
    ] {
        let rig = rig(exciter, shape, chain);
        let cut_off = 0.02 * OMEGA;
        let phase = settings(cut_off, None);
        let low_pass = phase.detector.low_pass(cut_off);
        let gains = PhasePlant::new(&rig, &ControlChannels::new(0, 1), OMEGA).design(low_pass).unwrap();
        let (found, omega) = exponents(&rig, settings(cut_off, Some(gains)), 1.0);
        let plant = PhasePlant::new(&rig, &ControlChannels::new(0, 1), omega);
        // Those of the loop are the slow ones that turn against the amplitude's own decay.
        let roots = found
            .iter()
            .filter(|s| s.norm() < 1.5 * cut_off && (plant.open_loop(gains, low_pass, **s) + 1.0).norm() < 0.1);
        assert!(roots.count() >= 2, "{exciter:?} {shape}: {found:?}");
    }
}

/// Before, gains were those of an ideal force: on a structure with little damping, 62 degrees as designed were 46.
#[test]
fn the_margin_as_designed_is_that_of_the_loop() {
    for (shape, old_margin) in [(0.05, 61.0..64.0), (0.3, 40.0..50.0), (0.6, 20.0..35.0)] {
        let mut rig = rig(Exciter::Shaker(Shaker::default()), shape, Chain::default());
        rig.structure.damping_ratios = vec![0.0019, 0.005];
        let plant = PhasePlant::new(&rig, &ControlChannels::new(0, 1), OMEGA);
        let cut_off = 0.1 * OMEGA;
        let low_pass = settings(cut_off, None).detector.low_pass(cut_off);
        let ideal = Gains::design(Resonance { omega: OMEGA, damping_ratio: 0.0019 }, low_pass).unwrap();
        let old = plant.margin(ideal, low_pass).unwrap();
        assert!(old_margin.contains(&old.degrees), "{shape}: {old:?}");
        let gains = plant.design(low_pass).unwrap();
        let own = plant.margin(gains, low_pass).unwrap();
        assert!(own.degrees >= 49.9 && own.crossover <= 0.251 * cut_off, "{shape}: {own:?}");
        let at = plant.open_loop(gains, low_pass, Complex64::new(0.0, own.crossover));
        assert!((at.norm() - 1.0).abs() < 1e-6 && ((-at).arg().to_degrees() - own.degrees).abs() < 1e-6);
    }
}

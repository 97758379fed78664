//! The contact force without its cell, on random structures with an elastic stop.

use std::f64::consts::TAU;

use nlmodes::rig::{
    ContactLaw, ControlChannels, DrivePoint, Exciter, LinearStructure, MotionQuantity, RigSetup, Sensor, SensorPlace,
    Session, Side, Stop,
};
use nlmodes_experiment::extraction::{self, ExtractionSettings, Measured, ModeErrors, RecordExtraction, extract};
use nlmodes_experiment::phase_loop::{LevelSchedule, LoopSettings, Resonance, TestSettings};
use nlmodes_experiment::records::{Record, Role};
use nlmodes_modal::LinearModes;

const RATE: f64 = 12_800.0;
const STOP: f64 = 1.0;
const POSITIONS: [f64; 6] = [0.1, 0.3, 0.45, 0.6, 0.8, STOP];

/// Uniform and normal numbers from a seed.
struct Random(u64);

impl Random {
    fn uniform(&mut self, from: f64, to: f64) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let share = (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64;
        from + share * (to - from)
    }

    fn normal(&mut self) -> f64 {
        let (a, b) = (self.uniform(1e-300, 1.0), self.uniform(0.0, 1.0));
        (-2.0 * a.ln()).sqrt() * (TAU * b).cos()
    }
}

/// A structure of four modes, its shapes at the positions, and a test on it.
struct Test {
    setup: RigSetup,
    shapes: Vec<Vec<f64>>,
    level: f64,
}

fn random(seed: u64) -> Test {
    let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    let first = random.uniform(25.0, 60.0);
    let ratios = [1.0, random.uniform(3.5, 6.5), random.uniform(9.0, 14.0), random.uniform(18.0, 26.0)];
    let omega: Vec<f64> = ratios.iter().map(|ratio| TAU * first * ratio).collect();
    let damping_ratios: Vec<f64> = (0..4).map(|_| random.uniform(0.004, 0.015)).collect();
    // Cosines of a wave number that is about that of a beam clamped at zero.
    let turns: Vec<f64> = (0..4).map(|k| (k as f64 + 0.5) * random.uniform(0.9, 1.1)).collect();
    let size = random.uniform(0.7, 1.5);
    let shape = |x: f64, k: usize| size * (1.0 - (std::f64::consts::PI * turns[k] * x).cos());
    let shapes: Vec<Vec<f64>> = POSITIONS.iter().map(|x| (0..4).map(|k| shape(*x, k)).collect()).collect();
    let stiffness = random.uniform(0.05, 0.4) * omega[0].powi(2) / shapes[5][0].powi(2);
    let amplitude = 1e-3;
    // Half as much again as grazing takes.
    let level = 1.5 * amplitude * 2.0 * damping_ratios[0] * omega[0].powi(2) / (shapes[5][0] * shapes[1][0]);
    let motion = |motion, d: usize| SensorPlace::Point { motion, position: POSITIONS[d], shape: shapes[d].clone() };
    let accelerometer = |d: usize| Sensor::new(format!("a{d}"), motion(MotionQuantity::Acceleration, d), 0.02);
    let setup = RigSetup {
        structure: LinearStructure { omega, damping_ratios },
        drive_point: DrivePoint { position: POSITIONS[1], shape: shapes[1].clone(), residual: 0.0 },
        exciter: Exciter::IdealForce,
        stop: Some(Stop {
            position: STOP,
            shape: shapes[5].clone(),
            side: if seed.is_multiple_of(2) { Side::Positive } else { Side::Negative },
            gap: amplitude,
            law: ContactLaw::Elastic { stiffness },
            residual: 0.0,
        }),
        sensors: vec![
            Sensor::new("force", SensorPlace::Excitation, 1e-3 * level),
            Sensor::new("x_drive", SensorPlace::DrivePoint(MotionQuantity::Displacement), 1e-8),
            accelerometer(0),
            accelerometer(2),
            accelerometer(3),
            accelerometer(4),
            Sensor::new("x_stop", SensorPlace::StopPoint(MotionQuantity::Displacement), 1e-8),
            Sensor::new("v_stop", SensorPlace::StopPoint(MotionQuantity::Velocity), 1e-5),
            Sensor::new("cell", SensorPlace::Stop, 0.0),
        ],
        interval: 1.0 / RATE,
        substeps: None,
        seed,
    };
    Test { setup, shapes, level }
}

/// Forty periods of a settled state at a fixed frequency a little above that of the mode.
fn record(test: &Test) -> Record {
    let omega = test.setup.structure.omega[0];
    let resonance = Resonance { omega, damping_ratio: test.setup.structure.damping_ratios[0] };
    let settings = LoopSettings::new(resonance, 1.005 * omega, 1.0 / RATE);
    // Until the loop is switched on the frequency is that of the start.
    let (ramp, start) = (0.2, 1e3);
    let levels = LevelSchedule { ramp, start, ..LevelSchedule::new(&[test.level]).unwrap() };
    let control = TestSettings::new(settings, levels);
    let mut session = Session::new(test.setup.clone(), &control, ControlChannels::new(0, 1)).unwrap();
    session.run(ramp + 12.0 / (test.setup.structure.damping_ratios[0] * omega)).unwrap();
    session.record(40.3 * TAU / omega).unwrap().0
}

/// Modes that are off by their errors.
fn modes(test: &Test, errors: ModeErrors, seed: u64) -> LinearModes {
    let mut random = Random(seed.wrapping_mul(0xD134_2543_DE82_EF95) | 1);
    // Numbers from neighbouring seeds are alike at first.
    for _ in 0..20 {
        random.normal();
    }
    let mut off = |value: f64, error: f64| value * (1.0 + error * random.normal());
    let structure = &test.setup.structure;
    let omega: Vec<f64> = structure.omega.iter().map(|omega| off(*omega, errors.frequency)).collect();
    let damping: Vec<f64> = structure.damping_ratios.iter().map(|zeta| off(*zeta, errors.damping)).collect();
    let shapes: Vec<Vec<f64>> =
        test.shapes.iter().map(|row| row.iter().map(|phi| off(*phi, errors.shape)).collect()).collect();
    LinearModes::new(&POSITIONS, &omega, &damping, &shapes).unwrap()
}

fn extracted(test: &Test, record: &Record, errors: ModeErrors, seed: u64) -> RecordExtraction {
    let stop = test.setup.stop.as_ref().unwrap();
    let settings = ExtractionSettings {
        linear_modes: Some(modes(test, errors, seed)),
        mode_errors: errors,
        stop: Some(extraction::Stop { position: STOP, gap: stop.gap, positive: stop.side == Side::Positive }),
        ..ExtractionSettings::default()
    };
    extract(record, &settings).unwrap()
}

/// Peak and integral over a period of the force of the cell, which has no noise.
fn truth(record: &Record, omega: f64) -> [f64; 2] {
    let cell = record.with_role(Role::Contact).next().unwrap();
    let force = &record.samples[cell];
    let per_period = RATE * TAU / omega;
    let periods = (force.len() as f64 / per_period).floor();
    let n = (periods * per_period).round() as usize;
    let sum: f64 = force[force.len() - n..].iter().sum();
    [force.iter().copied().fold(0.0, f64::max), sum / RATE / periods]
}

#[test]
fn ten_random_structures_have_the_force_of_their_cell() {
    const EXACT: ModeErrors = ModeErrors { frequency: 0.0, damping: 0.0, shape: 0.0 };
    let errors = ModeErrors { frequency: 1e-3, damping: 0.1, shape: 0.01 };
    // Draws of the modes' errors for each structure.
    const DRAWS: u64 = 4;
    let (mut within, mut all) = ([0, 0], 0);
    for seed in 1..=10 {
        let test = random(seed);
        let record = record(&test);
        let exact = extracted(&test, &record, EXACT, seed);
        let [peak, impulse] = truth(&record, exact.omega.value);
        assert!(peak > 0.0, "{seed} touches");
        let found = exact.balance.as_ref().unwrap_or_else(|| panic!("{seed}: {}", exact.finding_names()));
        let ContactLaw::Elastic { stiffness } = test.setup.stop.as_ref().unwrap().law else { panic!() };
        let off = [found.peak_force.value / peak - 1.0, found.impulse.value / impulse - 1.0];
        // Modes exchange energy while the stop is touched: what leaves is not what came, though a spring loses nothing.
        let by_cell = exact.contact.as_ref().unwrap().restitution.as_ref().unwrap().statistics().mean;
        let contact =
            [found.stiffness.unwrap().value / stiffness - 1.0, found.restitution.unwrap().value / by_cell - 1.0];
        // Noise of the accelerometers is what is left.
        let sure = 4.0 * found.peak_force.uncertainty / peak + 2e-3;
        assert!(off[0].abs() < sure && off[0].abs() < 0.03 && off[1].abs() < 0.01, "{seed}: {off:?}");
        assert!(contact[0].abs() < 0.02 && contact[1].abs() < 0.03, "{seed}: {contact:?}");
        // The loss is what its stop, a spring, takes: nothing.
        let lost = exact.modal.as_ref().unwrap().contact_dissipation.unwrap();
        let power = exact.excitation.as_ref().unwrap().total_power.value;
        assert!(lost.value.abs() < 3.0 * lost.uncertainty + 2e-3 * power, "{seed}: {lost:?} of {power}");
        for draw in 0..DRAWS {
            let modes_off = extracted(&test, &record, errors, DRAWS * seed + draw);
            // A force within the errors of the modes is none.
            let Some(found) = modes_off.balance.as_ref() else { continue };
            let sigma = |found: Measured, truth: f64| (found.value - truth).abs() / found.uncertainty;
            let sigmas = [sigma(found.peak_force, peak), sigma(found.impulse, impulse)];
            within[0] += sigmas.iter().filter(|sigma| **sigma < 1.0).count();
            within[1] += sigmas.iter().filter(|sigma| **sigma < 2.0).count();
            all += 2;
            assert!(sigmas.iter().all(|sigma| *sigma < 4.0), "{seed}: {sigmas:?}");
            assert!(found.peak_force.uncertainty < 0.3 * peak, "{seed}: {:?}", found.peak_force);
        }
    }
    assert!(all >= 70, "{all} of 80");
    // Stated errors cover 68 and 95 %, within 8 points.
    let share = within.map(|n: usize| 100 * n / all);
    assert!(share[0] >= 60 && share[1] >= 87, "{within:?} of {all}");
}

#[test]
fn without_contact_there_is_no_force_and_no_loss() {
    let mut test = random(3);
    test.level *= 0.4;
    let record = record(&test);
    for errors in [ModeErrors { frequency: 0.0, damping: 0.0, shape: 0.0 }, ModeErrors::default()] {
        let found = extracted(&test, &record, errors, 3);
        assert_eq!(found.balance, None);
        let lost = found.modal.as_ref().unwrap().contact_dissipation.unwrap();
        assert!(lost.value.abs() < 3.0 * lost.uncertainty, "{lost:?}");
    }
}

//! Processor time of one sample: the loop alone with each detector, and a whole test without and with controlled
//! harmonics.

use std::hint::black_box;

use criterion::{Bencher, Criterion, criterion_group, criterion_main};
use nlmodes::experiment::phase_loop::{
    AmplitudeSettings, AppropriationSettings, ForceAppropriation, LevelSchedule, Limits, LoopSettings, MAX_SENSORS,
    ModalFilter, Order, PhaseDetector, PhaseLockedLoop, Resonance, ResponseQuantity, TestControl, TestInput,
    TestSettings,
};
use nlmodes_benchmarks::thread_time;
use num_complex::Complex64;

const STEP: f64 = 5e-5;

fn settings(detector: PhaseDetector) -> LoopSettings {
    let resonance = Resonance { omega: 251.3, damping_ratio: 0.01 };
    LoopSettings { detector, ..LoopSettings::new(resonance, 250.0, STEP) }
}

/// Processor time of the thread, so that other programs on the machine count less.
fn time(bencher: &mut Bencher<'_>, mut sample: impl FnMut()) {
    bencher.iter_custom(|iterations| {
        let before = thread_time();
        (0..iterations).for_each(|_| sample());
        thread_time().saturating_sub(before)
    });
}

fn loop_alone(c: &mut Criterion) {
    let detectors = [
        ("adaptive, 1 harmonic", PhaseDetector::Adaptive { harmonics: 1 }),
        ("adaptive, 5 harmonics", PhaseDetector::Adaptive { harmonics: 5 }),
        ("adaptive, 8 harmonics", PhaseDetector::Adaptive { harmonics: 8 }),
        ("demodulation, second order", PhaseDetector::Demodulation { order: Order::Second }),
    ];
    for (name, detector) in detectors {
        let Ok(pll) = PhaseLockedLoop::new(settings(detector)) else { continue };
        let mut state = pll.start();
        c.bench_function(&format!("loop alone, {name}"), |b| {
            time(b, || {
                let theta = state.drive_phase();
                state = pll.step(&state, black_box(theta.cos()), black_box((theta - 1.5).cos()));
            });
        });
    }
}

fn test_control(c: &mut Criterion) {
    for (harmonics, sensors) in [(1, 0), (5, 4), (8, MAX_SENSORS)] {
        let Some(control) = control(harmonics, sensors) else { continue };
        let mut state = control.start();
        c.bench_function(&format!("test, {harmonics} controlled harmonics, {sensors} sensors"), |b| {
            time(b, || {
                let theta = state.phase().drive_phase();
                let mut input = TestInput::new(theta.cos(), (theta - 1.5).cos());
                input.motions = [(2.0 * theta).cos(); MAX_SENSORS];
                black_box(control.step(&mut state, black_box(&input)));
            });
        });
    }
}

fn control(harmonics: usize, sensors: usize) -> Option<TestControl> {
    let phase = settings(PhaseDetector::default());
    let appropriation = || {
        let row = [0.1; MAX_SENSORS];
        let modes = (0..3).try_fold(ModalFilter::new(sensors).ok()?, |modes, k| {
            modes.with_mode(&row[..sensors], 250.0 * f64::from(k + 1), 0.01).ok()
        })?;
        let quantities = [ResponseQuantity::Acceleration; MAX_SENSORS];
        let settings =
            AppropriationSettings::new(harmonics, modes, &quantities[..sensors], 0, STEP, phase.cut_off).ok()?;
        ForceAppropriation::new(settings, &[Complex64::ONE; 8]).ok()
    };
    let settings = TestSettings {
        harmonics: if harmonics > 1 { Some(appropriation()?) } else { None },
        phase,
        amplitude: AmplitudeSettings::drive(),
        // A record without an end: the lag is not that of resonance, so until then the level settles.
        schedule: LevelSchedule { record: 1e9, ..LevelSchedule::new(&[1.0]).ok()? },
        limits: Limits::default(),
    };
    TestControl::new(&settings).ok()
}

criterion_group!(benches, loop_alone, test_control);
criterion_main!(benches);

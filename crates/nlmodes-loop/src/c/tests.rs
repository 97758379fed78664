//! The functions of the header against the library: the same bits, and refusals in place of whatever is wrong.

use num_complex::Complex64;

use super::*;
use crate::{
    AmplitudeSettings, AppropriationSettings, Controlled, ForceAppropriation, Gains, LevelSchedule, Limits,
    LockSettings, LoopSettings, ModalFilter, Order, PhaseDetector, ResponseQuantity, SteadyCriteria, TestSettings,
};

const STEP: f64 = 1e-4;
const RESONANCE: Resonance = Resonance { omega: 250.0, damping_ratio: 0.01 };

/// What a function has written.
fn written<T>(write: impl FnOnce(Option<&mut MaybeUninit<T>>) -> SettingsRefusal) -> T {
    let mut place = MaybeUninit::uninit();
    assert_eq!(write(Some(&mut place)), SettingsRefusal::None);
    // SAFETY: a function that does not refuse has written all of it.
    unsafe { place.assume_init() }
}

fn defaults() -> CSettings {
    written(|place| nlmodes_loop_default_settings(place, RESONANCE.omega, RESONANCE.damping_ratio, 248.0, STEP))
}

fn prepared(settings: &CSettings) -> Result<TestControl, SettingsRefusal> {
    let mut place = MaybeUninit::uninit();
    match nlmodes_loop_prepare(Some(settings), Some(&mut place)) {
        // SAFETY: as in `written`.
        SettingsRefusal::None => Ok(unsafe { place.assume_init() }),
        refusal => Err(refusal),
    }
}

/// Everything set to something else than its default, in both ways.
fn both() -> (CSettings, TestSettings) {
    let mut c = defaults();
    let rows = [[0.8, -0.3], [0.1, 0.5]];
    let transfer = [Complex64::new(2.0, 0.5), Complex64::new(1.0, -0.5)];
    (c.lowest_rad_s, c.highest_rad_s, c.quantity, c.detector, c.controlled) = (200.0, 300.0, 2, 2, 1);
    (c.lag_rad, c.cut_off_rad_s, c.proportional_1_s, c.integral_1_s2) = (1.5, 20.0, 6.0, 9.0);
    (c.smallest_force_n, c.smallest_response, c.lock_tolerance_rad, c.lock_duration_s) = (0.01, 0.02, 0.03, 0.04);
    (c.amplitude_rate_1_s, c.amplitude_gain, c.smallest_drive, c.level_count) = (0.7, 0.8, 0.06, 2);
    c.levels[..2].copy_from_slice(&[0.5, 0.9]);
    (c.window_periods, c.windows, c.controlled_harmonics) = (3, 4, 3);
    (c.ramp_s, c.start_s, c.record_s, c.longest_hold_s) = (0.11, 0.12, 0.13, 0.9);
    (c.settled_lag_rad, c.settled_frequency_drift_1_s, c.settled_amplitude_drift_1_s) = (0.1, 0.2, 0.3);
    (c.settled_amplitude, c.settled_spread, c.settled_harmonics, c.settled_confidence) = (0.4, 0.5, 0.6, 2.0);
    (c.largest_drive, c.largest_stroke_m, c.largest_contact_force_n, c.largest_force_n) = (3.0, 0.1, 70.0, 80.0);
    (c.longest_silence_s, c.stop_duration_s) = (0.05, 0.06);
    (c.harmonics_rate_1_s, c.harmonics_largest) = (3.0, 0.6);
    (c.sensor_count, c.mode_count, c.drive_sensor) = (2, 2, 1);
    c.sensor_quantities[..2].copy_from_slice(&[1, 2]);
    c.transfer[..2].copy_from_slice(&transfer);
    for (k, row) in rows.iter().enumerate() {
        c.modal_rows[k][..2].copy_from_slice(row);
        (c.mode_rad_s[k], c.mode_damping_ratios[k]) = (240.0 + 400.0 * k as f64, 0.01 + 0.005 * k as f64);
    }
    let modes = ModalFilter::new(2).unwrap().with_mode(&rows[0], 240.0, 0.01).unwrap();
    let modes = modes.with_mode(&rows[1], 640.0, 0.015).unwrap();
    let quantities = [ResponseQuantity::Velocity, ResponseQuantity::Acceleration];
    let harmonics = AppropriationSettings::new(3, modes, &quantities, 1, STEP, 20.0).unwrap();
    let harmonics = AppropriationSettings { rate: 3.0, largest: 0.6, ..harmonics };
    let settling = SteadyCriteria {
        periods: 3,
        windows: 4,
        lag: 0.1,
        frequency_drift: 0.2,
        amplitude_drift: 0.3,
        amplitude: 0.4,
        spread: 0.5,
        harmonics: 0.6,
        confidence: 2.0,
        longest: 0.9,
    };
    let rust = TestSettings {
        phase: LoopSettings {
            range: [200.0, 300.0],
            quantity: ResponseQuantity::Acceleration,
            displacement_lag: 1.5,
            detector: PhaseDetector::Demodulation { order: Order::Second },
            cut_off: 20.0,
            gains: Some(Gains { proportional: 6.0, integral: 9.0 }),
            smallest: [0.01, 0.02],
            lock: LockSettings { tolerance: 0.03, duration: 0.04 },
            ..LoopSettings::new(RESONANCE, 248.0, STEP)
        },
        amplitude: AmplitudeSettings { controlled: Controlled::Force, rate: 0.7, gain: 0.8, smallest: 0.06 },
        schedule: LevelSchedule {
            ramp: 0.11,
            start: 0.12,
            record: 0.13,
            settling,
            ..LevelSchedule::new(&[0.5, 0.9]).unwrap()
        },
        limits: Limits {
            drive: 3.0,
            stroke: 0.1,
            contact_force: 70.0,
            force: 80.0,
            silence: 0.05,
            stop_duration: 0.06,
        },
        harmonics: Some(ForceAppropriation::new(harmonics, &transfer).unwrap()),
    };
    (c, rust)
}

#[test]
fn each_setting_of_c_is_that_of_the_library() {
    let (c, rust) = both();
    assert_eq!(c.checked().unwrap(), rust);
    assert_eq!(prepared(&c).unwrap(), TestControl::new(&rust).unwrap());
    let mut c = CSettings { level_count: 1, ..defaults() };
    c.levels[0] = 0.4;
    let rust = TestSettings {
        phase: LoopSettings::new(RESONANCE, 248.0, STEP),
        amplitude: AmplitudeSettings::drive(),
        schedule: LevelSchedule::new(&[0.4]).unwrap(),
        limits: Limits::default(),
        harmonics: None,
    };
    assert_eq!(prepared(&c).unwrap(), TestControl::new(&rust).unwrap());
}

/// Samples in which everything happens that may: noise of a generator of random numbers, missing samples.
fn sample(k: u32, theta: f64) -> TestInput {
    let noise = |n: u32| f64::from(k.wrapping_mul(2_654_435_761).rotate_left(n) >> 8) / f64::from(1 << 24) - 0.5;
    let force = if k % 4001 == 17 { f64::NAN } else { theta.cos() + 0.1 * noise(3) };
    let mut input = TestInput::new(force, theta.sin() + 0.1 * noise(9));
    (input.stroke, input.contact_force) = (0.02 * noise(12), 10.0 * noise(15));
    input.motions[..2].copy_from_slice(&[(2.0 * theta).cos() + 0.1 * noise(20), (3.0 * theta).sin()]);
    input
}

#[test]
fn a_step_of_c_is_that_of_the_library_to_the_last_bit() {
    let (c, rust) = both();
    let (of_c, of_rust) = (prepared(&c).unwrap(), TestControl::new(&rust).unwrap());
    let mut states: (TestState, _) = (written(|place| nlmodes_loop_start(Some(&of_c), place)), of_rust.start());
    assert!(states.0 == states.1);
    let (mut stages, mut last) = (Vec::new(), 0.0);
    for k in 0..60_000 {
        let mut input = sample(k, last);
        input.stop = u32::from(k == 50_000);
        let of_library = of_rust.step(&mut states.1, &input);
        let of_c: TestOutput =
            written(|place| nlmodes_loop_step(Some(&of_c), Some(&mut states.0), Some(&input), place));
        assert_eq!(format!("{of_c:?}"), format!("{of_library:?}"));
        assert_eq!(of_c.drive.to_bits(), of_library.drive.to_bits());
        assert_eq!(of_c.omega.to_bits(), of_library.omega.to_bits());
        last = states.1.phase().drive_phase();
        if stages.last() != Some(&of_c.stage) {
            stages.push(of_c.stage);
        }
    }
    // So the comparison has met each part: levels, records, the emergency.
    use crate::Stage::{Ramp, Record, Settle, Start, Stopped, Stopping};
    assert!(stages.starts_with(&[Ramp, Start, Settle, Record, Ramp, Settle, Record]), "{stages:?}");
    assert!(stages.ends_with(&[Stopping, Stopped]), "{stages:?}");
}

#[test]
fn the_flat_step_writes_what_the_structure_has() {
    let (mut c, _) = both();
    c.controlled_harmonics = 1;
    let control = prepared(&c).unwrap();
    let (mut flat, mut whole) = (control.start(), control.start());
    for k in 0..9000 {
        let mut input = sample(k, flat.phase().drive_phase());
        (input.motions, input.stop) = ([0.0; crate::MAX_SENSORS], u32::from(k > 8000));
        let out = control.step(&mut whole, &input);
        let TestInput { force, response, stroke, contact_force, stop, .. } = input;
        let numbers: [f64; FLAT_LENGTH] = written(|place| {
            let state = Some(&mut flat);
            nlmodes_loop_step_flat(Some(&control), state, force, response, stroke, contact_force, stop, place)
        });
        let expected = [out.drive, out.omega, out.phase, out.lag, out.force, out.response, out.level];
        assert_eq!(numbers[..7], expected);
        let codes = [out.level_index as f64, out.stage as u32 as f64, out.stop_reason as u32 as f64];
        assert_eq!(numbers[7..10], codes);
        assert_eq!(numbers[10..], [f64::from(u8::from(out.recorded)), f64::from(u8::from(out.settled))]);
        assert!(flat == whole, "{k}");
    }
    assert!(whole.stop_reason() == crate::EmergencyReason::Operator);
}

#[test]
fn what_cannot_be_is_refused_by_its_code() {
    let (good, _) = both();
    let refused = |change: &dyn Fn(&mut CSettings)| {
        let mut settings = good;
        change(&mut settings);
        prepared(&settings).unwrap_err()
    };
    assert_eq!(refused(&|s| s.step_s = 0.0), SettingsRefusal::Number);
    assert_eq!(refused(&|s| s.ramp_s = -1.0), SettingsRefusal::Number);
    assert_eq!(refused(&|s| s.lag_rad = f64::NAN), SettingsRefusal::Number);
    assert_eq!(refused(&|s| s.largest_stroke_m = f64::NAN), SettingsRefusal::Number);
    assert_eq!(refused(&|s| s.start_rad_s = 199.0), SettingsRefusal::FrequencyRange);
    assert_eq!(refused(&|s| s.cut_off_rad_s = 100.0), SettingsRefusal::CutOff);
    assert_eq!(refused(&|s| s.windows = 2), SettingsRefusal::Count);
    assert_eq!(refused(&|s| s.level_count = 65), SettingsRefusal::Count);
    assert_eq!(refused(&|s| s.level_count = u32::MAX), SettingsRefusal::Count);
    assert_eq!(refused(&|s| s.sensor_count = 33), SettingsRefusal::Count);
    assert_eq!(refused(&|s| s.mode_count = 17), SettingsRefusal::Count);
    assert_eq!(refused(&|s| s.controlled_harmonics = 9), SettingsRefusal::Count);
    assert_eq!(refused(&|s| (s.detector, s.detector_harmonics) = (0, 9)), SettingsRefusal::Count);
    assert_eq!(refused(&|s| s.quantity = 3), SettingsRefusal::Code);
    assert_eq!(refused(&|s| s.sensor_quantities[1] = 7), SettingsRefusal::Code);
    assert_eq!(refused(&|s| s.detector = 3), SettingsRefusal::Code);
    assert_eq!(refused(&|s| s.controlled = 3), SettingsRefusal::Code);
    assert_eq!(refused(&|s| s.drive_sensor = 2), SettingsRefusal::Sensors);
    assert_eq!(refused(&|s| s.transfer[1] = Complex64::ZERO), SettingsRefusal::NoTransfer);
    assert_eq!(refused(&|s| s.integral_1_s2 = 1e6), SettingsRefusal::UnstableGains);
    assert_eq!(refused(&|s| (s.controlled, s.largest_drive) = (0, 0.8)), SettingsRefusal::AboveLimit);
    assert_eq!(refused(&|s| (s.detector, s.step_s, s.cut_off_rad_s) = (0, 4e-3, 15.0)), SettingsRefusal::AboveNyquist);
}

#[test]
fn null_pointers_are_refused() {
    let (c, _) = both();
    let control = prepared(&c).unwrap();
    let (mut state, input, mut output) = (control.start(), TestInput::new(0.0, 0.0), MaybeUninit::uninit());
    let null = SettingsRefusal::NullPointer;
    assert_eq!(nlmodes_loop_default_settings(None, 250.0, 0.01, 250.0, STEP), null);
    assert_eq!(nlmodes_loop_prepare(None, Some(&mut MaybeUninit::uninit())), null);
    assert_eq!(nlmodes_loop_prepare(Some(&c), None), null);
    assert_eq!(nlmodes_loop_start(Some(&control), None), null);
    assert_eq!(nlmodes_loop_step(None, Some(&mut state), Some(&input), Some(&mut output)), null);
    assert_eq!(nlmodes_loop_step(Some(&control), None, Some(&input), Some(&mut output)), null);
    assert_eq!(nlmodes_loop_step(Some(&control), Some(&mut state), None, Some(&mut output)), null);
    assert_eq!(nlmodes_loop_step(Some(&control), Some(&mut state), Some(&input), None), null);
    assert_eq!(nlmodes_loop_step_flat(Some(&control), Some(&mut state), 0.0, 0.0, 0.0, 0.0, 0, None), null);
    assert_eq!(nlmodes_loop_sizes(None), null);
    assert!(state == control.start());
    let sizes: [usize; 5] = written(|place| nlmodes_loop_sizes(place));
    assert!(sizes.iter().all(|size| size % 8 == 0) && sizes[2] == size_of::<TestState>());
}

//! A whole test on an oscillator with a stop: levels, amplitude, noise, limits.

use num_complex::Complex64;
use proptest::prelude::*;

use nlmodes_loop::{
    AmplitudeSettings, AppropriationSettings, Controlled, EmergencyReason, ForceAppropriation, LevelSchedule, Limits,
    LoopSettings, ModalFilter, PhaseLoopError, Resonance, ResponseQuantity, Stage, SteadyCriteria, TestControl,
    TestInput, TestOutput, TestSettings, TestState,
};

const STEP: f64 = 1e-4;
const SUBSTEPS: usize = 8;
const OMEGA: f64 = 251.3;
const DAMPING: f64 = 0.01;
const GAP: f64 = 1e-3;
/// Amplitude of 1 N at resonance, m.
const PER_NEWTON: f64 = 1.0 / (2.0 * DAMPING * OMEGA * OMEGA);

fn settings(levels: &[f64]) -> TestSettings {
    let resonance = Resonance { omega: OMEGA, damping_ratio: DAMPING };
    let settling = SteadyCriteria { periods: 10, ..SteadyCriteria::default() };
    TestSettings {
        phase: LoopSettings::new(resonance, OMEGA - 1.0, STEP),
        amplitude: AmplitudeSettings::drive(),
        schedule: LevelSchedule { settling, record: 0.2, ..LevelSchedule::new(levels).unwrap() },
        limits: Limits::default(),
        harmonics: None,
    }
}

fn controlled(controlled: Controlled) -> AmplitudeSettings {
    let response = AmplitudeSettings::response(&settings(&[]).phase, 0.05);
    let gain = if controlled == Controlled::Response { response.gain } else { 0.0 };
    AmplitudeSettings { controlled, gain, ..response }
}

/// 1 kg on a spring, with a stop of this stiffness, N/m, under a force of `gain` a unit of the drive.
struct Oscillator {
    x: f64,
    v: f64,
    stop: f64,
    gain: f64,
    noise: f64,
    seed: u64,
}

impl Oscillator {
    fn new(stop: f64, noise: f64) -> Self {
        Self { x: 0.0, v: 0.0, stop, gain: 1.0, noise, seed: 7 }
    }

    fn contact(&self) -> f64 {
        self.stop * (self.x - GAP).max(0.0)
    }

    fn advance(&mut self, force: f64) {
        let h = STEP / SUBSTEPS as f64;
        for _ in 0..SUBSTEPS {
            self.v += h * (force - self.contact() - 2.0 * DAMPING * OMEGA * self.v - OMEGA * OMEGA * self.x);
            self.x += h * self.v;
        }
    }

    /// Between −1 and 1.
    fn random(&mut self) -> f64 {
        self.seed = self.seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// A loop on an oscillator.
struct Bench {
    control: TestControl,
    state: TestState,
    rig: Oscillator,
    drive: f64,
}

impl Bench {
    fn new(settings: &TestSettings, rig: Oscillator) -> Self {
        let control = TestControl::new(settings).unwrap();
        Self { control, state: control.start(), rig, drive: 0.0 }
    }

    fn step(&mut self, change: impl FnOnce(&mut TestInput)) -> TestOutput {
        let (noise, rig) = (self.rig.noise, &mut self.rig);
        let force = rig.gain * self.drive + 1e4 * noise * rig.random();
        let response = rig.x + noise * rig.random();
        let contact_force = rig.contact();
        let mut input = TestInput { stroke: response, contact_force, ..TestInput::new(force, response) };
        change(&mut input);
        let output = self.control.step(&mut self.state, &input);
        self.rig.advance(self.rig.gain * self.drive);
        self.drive = output.drive;
        output
    }

    /// The last output of each record, to the end of the test.
    fn records(&mut self) -> Vec<TestOutput> {
        let mut records: Vec<TestOutput> = Vec::new();
        for _ in 0..2_000_000 {
            let output = self.step(|_| {});
            match records.last_mut() {
                _ if !output.recorded => {}
                Some(last) if last.level_index == output.level_index => *last = output,
                _ => records.push(output),
            }
            if matches!(output.stage, Stage::Finished | Stage::Stopped) {
                return records;
            }
        }
        panic!("the test has no end: {:?}", self.state.stage());
    }
}

#[test]
fn levels_of_the_drive_are_held_at_resonance_with_the_amplitude_of_the_closed_form() {
    let mut bench = Bench::new(&settings(&[0.3, 0.6, 0.3]), Oscillator::new(0.0, 0.0));
    let records = bench.records();
    assert_eq!(records.len(), 3);
    for (record, level) in records.iter().zip([0.3, 0.6, 0.3]) {
        assert!(record.settled && record.locked && record.level == level);
        // The integration errs by (ωh)²/24 = 5e-7 in frequency, half a step in damping: 2ζ against 2ζ ± ωh/2 of it.
        assert!((record.omega / OMEGA - 1.0).abs() < 2e-4, "{}", record.omega);
        // The drive between two samples is held: its fundamental is that of a sinusoid to (ωh)²/24 = 3e-5.
        assert!((record.force / level - 1.0).abs() < 1e-6, "{}", record.force);
        assert!((record.response / (level * PER_NEWTON) - 1.0).abs() < 2e-3, "{}", record.response / PER_NEWTON);
    }
    assert_eq!((bench.state.stage(), bench.drive), (Stage::Finished, 0.0));
}

#[test]
fn force_and_response_are_brought_to_their_levels_whatever_the_gain_of_the_exciter() {
    for gain in [0.2, 5.0] {
        let mut force = TestSettings { amplitude: controlled(Controlled::Force), ..settings(&[0.4, 0.8]) };
        // At a free drive point nothing but the exciter is between drive and force: the answer is immediate.
        force.amplitude.smallest = 0.05 / gain;
        let mut response =
            TestSettings { amplitude: controlled(Controlled::Response), ..settings(&[3e-4, 1.02e-3, 0.9e-3]) };
        response.amplitude.smallest = 0.05 / gain;
        for (settings, stop) in [(&force, 0.0), (&response, 5e4)] {
            let mut bench = Bench::new(settings, Oscillator { gain, ..Oscillator::new(stop, 0.0) });
            let records = bench.records();
            assert_eq!(records.len(), settings.schedule.count);
            for (record, level) in records.iter().zip(settings.schedule.levels()) {
                let found = if stop > 0.0 { record.response } else { record.force };
                assert!(record.settled && (found / level - 1.0).abs() < 1e-3, "{gain}: {found} of {level}");
                assert!((record.lag.to_degrees() - 90.0).abs() < 0.1, "{}", record.lag.to_degrees());
            }
        }
    }
}

/// With noise of the sensors a fixed tolerance is never met; one judged by the noise is, and the record is within it.
#[test]
fn a_level_settles_within_its_noise_and_not_before() {
    let noisy = || Oscillator::new(0.0, 1e-5);
    let mut plan = settings(&[0.6]);
    let tight = SteadyCriteria { lag: 1e-5, frequency_drift: 1e-7, amplitude_drift: 1e-5, ..plan.schedule.settling };
    plan.schedule.settling = SteadyCriteria { longest: 5.0, ..tight };
    let by_noise = Bench::new(&plan, noisy()).records()[0];
    assert!(by_noise.settled && by_noise.drifts.lag_noise > 0.0, "{:?}", by_noise.drifts);
    plan.schedule.settling.confidence = 0.0;
    let by_tolerance = Bench::new(&plan, noisy()).records()[0];
    assert!(!by_tolerance.settled, "{:?}", by_tolerance.drifts);
    // What counts as settled is near the truth by what its noise says.
    let error = by_noise.drifts.lag_error.abs();
    assert!(error < tight.lag + 3.0 * by_noise.drifts.lag_noise, "{error}");
    // A jump of the level right after the ramp is no noise: the time constant of the response is 0.4 s.
    plan.schedule.settling = settings(&[]).schedule.settling;
    (plan.schedule.ramp, plan.schedule.start) = (0.0, 0.0);
    let mut bench = Bench::new(&plan, Oscillator::new(0.0, 1e-8));
    let mut samples = 0;
    while !bench.step(|_| {}).recorded {
        samples += 1;
    }
    assert!(f64::from(samples) * STEP > 4.0 / (DAMPING * OMEGA), "{samples}");
}

/// Peaks of the drive, over the rest of the test.
fn largest(bench: &mut Bench, samples: usize) -> f64 {
    (0..samples).map(|_| bench.step(|_| {}).drive.abs()).fold(0.0, f64::max)
}

#[test]
fn each_excess_ends_the_test_at_once_and_for_good() {
    let limits = Limits { stroke: 2e-3, contact_force: 60.0, force: 1.5, silence: 0.005, ..Limits::default() };
    type Change = fn(&mut TestInput);
    let cases: [(Change, EmergencyReason); 7] = [
        (|input| input.stroke = -2.01e-3, EmergencyReason::Stroke),
        (|input| input.stroke = f64::INFINITY, EmergencyReason::Stroke),
        (|input| input.contact_force = 60.1, EmergencyReason::ContactForce),
        (|input| input.force = -1.6, EmergencyReason::Force),
        (|input| input.stop = 1, EmergencyReason::Operator),
        (|input| input.response = f64::NAN, EmergencyReason::Silence),
        (|input| input.contact_force = f64::NAN, EmergencyReason::Silence),
    ];
    for stop_duration in [0.0, 0.05] {
        for (change, reason) in cases {
            let limits = Limits { stop_duration, ..limits };
            let mut bench = Bench::new(&TestSettings { limits, ..settings(&[0.8]) }, Oscillator::new(0.0, 0.0));
            let before = largest(&mut bench, 25_000);
            assert!(before > 0.79 && bench.state.stop_reason() == EmergencyReason::None);
            let at_once = reason != EmergencyReason::Silence;
            for k in 0..60 {
                bench.step(change);
                let expected = if at_once || k >= 50 { reason } else { EmergencyReason::None };
                assert_eq!(bench.state.stop_reason(), expected, "{k}");
            }
            // What comes after does not wake it up.
            let wait = (stop_duration / STEP) as usize + 1;
            assert!(largest(&mut bench, wait) <= 0.8);
            assert_eq!((largest(&mut bench, 30_000), bench.state.stage()), (0.0, Stage::Stopped));
            assert_eq!(bench.state.stop_reason(), reason);
        }
    }
}

#[test]
fn the_drive_stays_below_its_limit_and_a_level_that_needs_more_does_not_settle() {
    let limits = Limits { drive: 0.5, ..Limits::default() };
    let refused = TestControl::new(&TestSettings { limits, ..settings(&[0.4, 0.51]) });
    assert_eq!(refused, Err(PhaseLoopError::AboveLimit { level: 0.51, limit: 0.5 }));
    let mut plan = TestSettings { limits, amplitude: controlled(Controlled::Response), ..settings(&[1e-3]) };
    (plan.schedule.settling.longest, plan.amplitude.smallest) = (3.0, 0.3);
    let mut bench = Bench::new(&plan, Oscillator::new(0.0, 0.0));
    let mut at_limit = false;
    loop {
        let output = bench.step(|_| {});
        assert!(output.drive.abs() <= 0.5);
        at_limit |= output.drive_at_limit;
        assert!(!output.settled);
        if output.stage == Stage::Finished {
            break;
        }
    }
    assert!(at_limit);
}

/// The part of the control that follows harmonics is [`ForceAppropriation`], sample by sample.
#[test]
fn controlled_harmonics_are_those_of_the_appropriation_alone() {
    let modes = ModalFilter::new(1).unwrap().with_mode(&[1.0], OMEGA, DAMPING).unwrap();
    let quantities = [ResponseQuantity::Displacement];
    let alone = AppropriationSettings::new(3, modes, &quantities, 0, STEP, 0.1 * OMEGA).unwrap();
    let alone = ForceAppropriation::new(alone, &[Complex64::ONE; 2]).unwrap();
    let plan = TestSettings { harmonics: Some(alone), ..settings(&[1.2]) };
    let mut bench = Bench::new(&plan, Oscillator::new(5e4, 0.0));
    let mut state = alone.start();
    let mut largest = 0.0_f64;
    for _ in 0..60_000 {
        let (theta, omega) = (bench.state.phase().drive_phase(), bench.state.phase().omega());
        let mut seen = TestInput::new(0.0, 0.0);
        let output = bench.step(|input| {
            input.motions[0] = input.response;
            seen = *input;
        });
        alone.step(&mut state, theta, omega, seen.force, &seen.motions[..1]);
        assert_eq!(output.amplitudes[1][1..3], state.drive()[1..3]);
        assert_eq!(output.amplitudes[1][3..], [Complex64::ZERO; 5]);
        largest = largest.max(state.drive()[2].norm());
    }
    assert!(largest > 1e-5, "{largest}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]
    /// Whatever the sensors say, the drive is finite and below its limit.
    #[test]
    fn no_signal_drives_above_the_limit(
        glitches in prop::collection::vec(
            (0_usize..6000, 0_usize..5, prop::sample::select(vec![1e308, -1e308, 1e12, f64::NAN, f64::INFINITY, 0.0])),
            0..40
        ),
        way in 0_usize..3
    ) {
        let limits = Limits { drive: 0.7, silence: f64::INFINITY, ..Limits::default() };
        let way = [AmplitudeSettings::drive(), controlled(Controlled::Force), controlled(Controlled::Response)][way];
        let mut plan = TestSettings { limits, amplitude: way, ..settings(&[0.6, 0.1]) };
        (plan.schedule.ramp, plan.schedule.start, plan.schedule.settling.longest) = (0.05, 0.05, 0.1);
        let mut bench = Bench::new(&plan, Oscillator::new(5e4, 1e-6));
        for k in 0..6000 {
            let output = bench.step(|input| {
                for (_, channel, value) in glitches.iter().filter(|glitch| glitch.0 == k) {
                    let TestInput { force, response, stroke, contact_force, motions, .. } = input;
                    *[force, response, stroke, contact_force, &mut motions[0]][*channel] = *value;
                }
            });
            prop_assert!(output.drive.abs() <= 0.7, "{}", output.drive);
            prop_assert!((100.0..600.0).contains(&output.omega));
        }
    }
}

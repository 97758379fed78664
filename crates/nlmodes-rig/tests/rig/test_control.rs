//! The test control of `nlmodes-loop` on the rig, by the function of its C header and by that of the library: hardware
//! in the loop without hardware.

use std::f64::consts::TAU;
use std::mem::MaybeUninit;

use nlmodes_experiment::phase_loop::c::{SettingsRefusal, nlmodes_loop_step};
use nlmodes_experiment::phase_loop::{
    AmplitudeSettings, Controlled, EmergencyReason, LevelSchedule, Limits, LoopSettings, Resonance, Stage,
    SteadyCriteria, TestControl, TestInput, TestOutput, TestSettings, TestState,
};
use nlmodes_rig::{Drive, Exciter, RigSetup, Session, Shaker, VirtualRig};

use crate::beam;

/// The displacement of the tip in [`beam::setup`].
const TIP: usize = 3;
/// The contact force there.
const CONTACT: usize = 5;

fn setup() -> RigSetup {
    beam::with_noise(beam::setup(Exciter::Shaker(Shaker::default())))
}

fn settings(levels: &[f64]) -> TestSettings {
    let resonance = Resonance { omega: TAU * 40.1, damping_ratio: 0.0019 };
    let settling = SteadyCriteria { periods: 10, longest: 10.0, ..SteadyCriteria::default() };
    TestSettings {
        phase: LoopSettings::new(resonance, TAU * 40.0, beam::INTERVAL),
        amplitude: AmplitudeSettings::drive(),
        schedule: LevelSchedule { settling, record: 0.2, ..LevelSchedule::new(levels).unwrap() },
        limits: Limits::default(),
        harmonics: None,
    }
}

/// The rig on a test control.
struct Bench {
    rig: VirtualRig,
    control: TestControl,
    state: TestState,
}

impl Bench {
    fn new(settings: &TestSettings) -> Self {
        let (rig, control) = (VirtualRig::new(setup()).unwrap(), TestControl::new(settings).unwrap());
        Self { rig, state: control.start(), control }
    }

    /// Force and response first, in the order of a [`Session`]: each reading draws its own noise.
    fn read(&mut self, limited: bool) -> TestInput {
        let mut channel = |channel| self.rig.read(channel).unwrap();
        let mut input = TestInput::new(channel(beam::FORCE), channel(beam::DRIVE_DISPLACEMENT));
        if limited {
            (input.stroke, input.contact_force) = (channel(TIP), channel(CONTACT));
        }
        input
    }

    fn step(&mut self, limited: bool) -> TestOutput {
        let input = self.read(limited);
        let output = self.control.step(&mut self.state, &input);
        let drive = Drive { amplitudes: output.amplitudes, phase: output.phase, omega: output.omega };
        self.rig.advance(&drive).unwrap();
        output
    }

    /// The same by the function for C, which needs nothing but the state to drive on.
    fn step_in_c(&mut self, limited: bool) {
        let input = self.read(limited);
        let (before, phase) = (*self.state.amplitudes(), self.state.phase().drive_phase());
        let output = &mut MaybeUninit::uninit();
        let said = nlmodes_loop_step(Some(&self.control), Some(&mut self.state), Some(&input), Some(output));
        assert_eq!(said, SettingsRefusal::None);
        let amplitudes = [before, *self.state.amplitudes()];
        self.rig.advance(&Drive { amplitudes, phase, omega: self.state.phase().omega() }).unwrap();
    }
}

#[test]
fn the_header_drives_the_rig_to_the_same_bits_as_the_library_and_as_a_session() {
    let plan = settings(&[1.0, 1.4]);
    let (mut library, mut c) = (Bench::new(&plan), Bench::new(&plan));
    let mut session = Session::new(setup(), plan.phase.clone(), beam::FORCE, beam::DRIVE_DISPLACEMENT).unwrap();
    session.hold_frequency(true);
    let second = (1.0 / beam::INTERVAL).round() as usize;
    for k in 0..3 * second {
        library.step(false);
        c.step_in_c(false);
        assert!(library.state == c.state, "{k}");
        let bits = |bench: &Bench| bench.state.phase().omega().to_bits();
        assert_eq!(bits(&library), bits(&c), "{k}");
    }
    // Ramp and start of a session, with its frequency frozen, then a second of its loop.
    session.ramp(1.0, 1.0).unwrap();
    session.run(1.0).unwrap();
    session.hold_frequency(false);
    session.run(1.0).unwrap();
    assert_eq!(library.state.stage(), Stage::Settle);
    assert_eq!(library.state.phase(), session.state());
    assert_eq!(library.rig.modal_coordinates(), session.rig().modal_coordinates());
    assert_eq!(library.rig.modal_coordinates(), c.rig.modal_coordinates());
    assert!(library.rig.modal_coordinates()[0].abs() > 0.0 && library.state.phase().error().is_some());
}

/// Levels that the paper's beam holds with contact.
#[test]
fn levels_with_contact_are_held_within_the_noise() {
    let mut bench = Bench::new(&settings(&[1.0, 1.4]));
    let found = bench.records();
    assert!(found.iter().all(|record| record.settled && record.locked), "{found:?}");
    // benchmarks/results/virtual_test.md has the frequency at 1 V from a session: 40.278 Hz.
    assert!((found[0].omega / TAU - 40.278).abs() < 0.01, "{}", found[0].omega / TAU);
}

/// Stepped response below contact: with contact the amplitude of this beam hardly depends on the drive.
#[test]
fn a_response_is_brought_to_its_level() {
    let level = 1.4e-5;
    let mut plan = settings(&[level]);
    let rate = 0.5 * plan.phase.resonance.decay_rate();
    plan.amplitude = AmplitudeSettings { controlled: Controlled::Response, rate, smallest: 1.0 };
    plan.schedule.settling.longest = 60.0;
    let stepped = Bench::new(&plan).records()[0];
    assert!(stepped.settled && (stepped.response / level - 1.0).abs() < 1.5e-3, "{stepped:?}");
}

#[test]
fn a_contact_force_above_its_limit_ends_the_test() {
    let limits = Limits { contact_force: 5.0, stop_duration: 0.02, ..Limits::default() };
    let mut bench = Bench::new(&TestSettings { limits, ..settings(&[1.4]) });
    let mut largest = 0.0_f64;
    while bench.state.stop_reason() == EmergencyReason::None {
        largest = largest.max(bench.rig.exact(CONTACT).unwrap());
        bench.step(true);
    }
    assert_eq!(bench.state.stop_reason(), EmergencyReason::ContactForce);
    for _ in 0..20_000 {
        bench.step(true);
    }
    assert_eq!(bench.state.stage(), Stage::Stopped);
    // The exciter is off: the motion decays freely, without contact after a second.
    assert_eq!(bench.rig.exact(CONTACT).unwrap(), 0.0);
    assert!(largest < 10.0, "{largest}");
}

impl Bench {
    /// The last output of each record.
    fn records(&mut self) -> Vec<TestOutput> {
        let mut records: Vec<TestOutput> = Vec::new();
        loop {
            let output = self.step(false);
            match records.last_mut() {
                _ if !output.recorded => {}
                Some(last) if last.level_index == output.level_index => *last = output,
                _ => records.push(output),
            }
            if matches!(output.stage, Stage::Down | Stage::Stopped) {
                return records;
            }
        }
    }
}

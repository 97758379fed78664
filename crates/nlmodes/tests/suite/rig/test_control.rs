//! The test control of `nlmodes-loop` on the rig, by the function of its C header and by that of the library: hardware
//! in the loop without hardware.

use std::f64::consts::TAU;
use std::mem::MaybeUninit;

use nlmodes::rig::{ControlChannels, Drive, Exciter, RigSetup, Session, Shaker, VirtualRig};
use nlmodes_experiment::phase_loop::c::{SettingsRefusal, nlmodes_loop_step};
use nlmodes_experiment::phase_loop::{
    AmplitudeSettings, EmergencyReason, LevelSchedule, Limits, LoopSettings, Resonance, Stage, SteadyCriteria,
    TestControl, TestInput, TestSettings, TestState,
};

use crate::rig::beam;

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
    let levels = LevelSchedule { settling, record: 0.2, ..LevelSchedule::new(levels).unwrap() };
    TestSettings::new(LoopSettings::new(resonance, TAU * 40.0, beam::INTERVAL), levels)
}

fn session(settings: &TestSettings) -> Session {
    let mut channels = ControlChannels::new(beam::FORCE, beam::DRIVE_DISPLACEMENT);
    (channels.stroke, channels.contact_force) = (Some(TIP), Some(CONTACT));
    Session::new(setup(), settings, channels).unwrap()
}

/// The rig on the function for C, which needs nothing but the state to drive on.
struct InC {
    rig: VirtualRig,
    control: TestControl,
    state: TestState,
}

impl InC {
    fn step(&mut self) {
        let mut channel = |channel| self.rig.read(channel).unwrap();
        let mut input = TestInput::new(channel(beam::FORCE), channel(beam::DRIVE_DISPLACEMENT));
        (input.stroke, input.contact_force) = (channel(TIP), channel(CONTACT));
        let (before, phase) = (*self.state.amplitudes(), self.state.phase().drive_phase());
        let output = &mut MaybeUninit::uninit();
        let said = nlmodes_loop_step(Some(&self.control), Some(&mut self.state), Some(&input), Some(output));
        assert_eq!(said, SettingsRefusal::None);
        let amplitudes = [before, *self.state.amplitudes()];
        self.rig.advance(&Drive { amplitudes, phase, omega: self.state.phase().omega() }).unwrap();
    }
}

#[test]
fn the_header_drives_the_rig_to_the_same_bits_as_the_library() {
    let plan = settings(&[1.0, 1.4]);
    let mut session = session(&plan);
    let control = TestControl::new(&plan).unwrap();
    let mut c = InC { rig: VirtualRig::new(setup()).unwrap(), state: control.start(), control };
    let second = (1.0 / beam::INTERVAL).round() as usize;
    for k in 0..3 * second {
        session.step().unwrap();
        c.step();
        assert!(*session.state() == c.state, "{k}");
        assert_eq!(session.state().phase().omega().to_bits(), c.state.phase().omega().to_bits(), "{k}");
    }
    assert_eq!(session.state().stage(), Stage::Settle);
    assert_eq!(session.rig().modal_coordinates(), c.rig.modal_coordinates());
    assert!(c.rig.modal_coordinates()[0].abs() > 0.0 && c.state.phase().error().is_some());
}

/// Levels that the paper's beam holds with contact.
#[test]
fn levels_with_contact_are_held_within_the_noise() {
    let mut session = session(&settings(&[1.0, 1.4]));
    let found = [0, 1].map(|_| session.next_level().unwrap().unwrap());
    assert!(found.iter().all(|level| level.findings.is_empty() && level.drifts.settled), "{found:?}");
    // benchmarks/results/virtual_test.md has the frequency at 1 V: 40.278 Hz.
    assert!((found[0].steady.omega / TAU - 40.278).abs() < 0.01, "{}", found[0].steady.omega / TAU);
    assert_eq!(session.next_level().unwrap(), None);
}

/// Stepped response, below contact and with contact: there the amplitude that 1 V and 1.2 V give differs by 0.16 %
/// only.
#[test]
fn a_response_is_brought_to_its_level() {
    let levels = [1.4e-5, 1.7683e-5];
    let mut plan = settings(&levels);
    plan.amplitude = AmplitudeSettings::response(&plan.phase, 0.1);
    plan.schedule.settling.longest = 60.0;
    let mut session = session(&plan);
    for level in levels {
        let stepped = session.next_level().unwrap().unwrap();
        assert_eq!(stepped.findings, []);
        assert!((stepped.steady.response / level - 1.0).abs() < 1.5e-3, "{:?}", stepped.steady);
    }
}

#[test]
fn a_contact_force_above_its_limit_ends_the_test() {
    let limits = Limits { contact_force: 5.0, stop_duration: 0.02, ..Limits::default() };
    let mut session = session(&TestSettings { limits, ..settings(&[1.4]) });
    let mut largest = 0.0_f64;
    while session.state().stop_reason() == EmergencyReason::None {
        largest = largest.max(session.rig().exact(CONTACT).unwrap());
        session.step().unwrap();
    }
    assert_eq!(session.state().stop_reason(), EmergencyReason::ContactForce);
    session.run(1.0).unwrap();
    assert_eq!(session.state().stage(), Stage::Stopped);
    // The exciter is off: the motion decays freely, without contact after a second.
    assert_eq!(session.rig().exact(CONTACT).unwrap(), 0.0);
    assert!(largest < 10.0, "{largest}");
}

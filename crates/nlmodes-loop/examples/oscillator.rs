//! A phase-resonance test of an oscillator with a stop: `oscillator.c` in Rust, without the C interface. `.ci/loop`
//! compares what both print, bit for bit.
//!
//! `cargo run -p nlmodes-loop --example oscillator`

use std::f64::consts::TAU;

use nlmodes_loop::{
    AmplitudeSettings, EmergencyReason, LevelSchedule, Limits, LockSettings, LoopSettings, PhaseLoopError, Resonance,
    Stage, SteadyCriteria, TestControl, TestInput, TestSettings,
};

const RATE: f64 = 10_000.0; // Hz
const SUBSTEPS: usize = 16;
const OMEGA: f64 = 251.327_412_287_183_45; // rad/s, of an oscillator of 1 kg
const DAMPING: f64 = 0.01;
const GAP: f64 = 1e-3; // m
const STOP: f64 = 5e4; // N/m

/// The oscillator, and what makes its noise.
struct Rig {
    x: f64,
    v: f64,
    seed: u64,
}

impl Rig {
    fn contact_force(&self) -> f64 {
        if self.x > GAP { STOP * (self.x - GAP) } else { 0.0 }
    }

    /// One sampling interval under a force that is held, as by a digital-to-analogue converter.
    fn advance(&mut self, force: f64) {
        let h = 1.0 / RATE / SUBSTEPS as f64;
        for _ in 0..SUBSTEPS {
            self.v += h * (force - self.contact_force() - 2.0 * DAMPING * OMEGA * self.v - OMEGA * OMEGA * self.x);
            self.x += h * self.v;
        }
    }

    /// Between −1 and 1.
    fn noise(&mut self) -> f64 {
        self.seed = self.seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.seed >> 11) as f64 / 4_503_599_627_370_496.0 - 1.0
    }
}

/// Runs a test to its end; prints the end of each record and of the test. The last stage and its reason.
fn run(name: &str, settings: &TestSettings) -> Result<(Stage, EmergencyReason), PhaseLoopError> {
    let control = TestControl::new(settings)?;
    let mut state = control.start();
    let mut rig = Rig { x: 0.0, v: 0.0, seed: 1 };
    let (mut drive, mut recorded, mut samples, mut sum) = (0.0, false, 0, 14_695_981_039_346_656_037_u64);
    loop {
        let force = drive + 1e-3 * rig.noise();
        let response = rig.x + 1e-7 * rig.noise();
        let contact_force = rig.contact_force();
        let input = TestInput { stroke: response, contact_force, ..TestInput::new(force, response) };
        let output = control.step(&mut state, &input);
        for seen in [output.drive, output.omega, output.phase, output.lag, output.response] {
            sum = (sum ^ seen.to_bits()).wrapping_mul(1_099_511_628_211);
        }
        if recorded && !output.recorded {
            println!(
                "{name}: level {}, {:.4} Hz, lag {:.3} degrees, {:.4} N, {:.6} mm, settled {}, bits {:016x}",
                output.level_index,
                output.omega / TAU,
                output.lag * 57.295_779_513_082_32,
                output.force,
                1e3 * output.response,
                u8::from(output.settled),
                output.omega.to_bits()
            );
        }
        recorded = output.recorded;
        rig.advance(drive);
        drive = output.drive;
        samples += 1;
        if matches!(output.stage, Stage::Finished | Stage::Stopped) {
            let (stage, reason) = (output.stage, output.stop_reason);
            println!(
                "{name}: stage {}, stop reason {}, {samples} samples, sum {sum:016x}",
                stage as u32, reason as u32
            );
            return Ok((stage, reason));
        }
    }
}

fn main() -> Result<(), PhaseLoopError> {
    let resonance = Resonance { omega: OMEGA, damping_ratio: DAMPING };
    let lock = LockSettings { duration: 0.2, ..LockSettings::default() };
    let settling = SteadyCriteria { periods: 10, ..SteadyCriteria::default() };
    let levels = |levels: &[f64]| -> Result<_, PhaseLoopError> {
        Ok(LevelSchedule { settling, record: 0.5, ..LevelSchedule::new(levels)? })
    };
    let mut settings = TestSettings {
        phase: LoopSettings { lock, ..LoopSettings::new(resonance, OMEGA - 1.5, 1.0 / RATE) },
        amplitude: AmplitudeSettings::drive(),
        schedule: levels(&[0.4, 0.8, 1.4, 2.0])?,
        limits: Limits::default(),
        harmonics: None,
    };
    // Levels are forces; the stop is touched from the third on.
    assert_eq!(run("force", &settings)?, (Stage::Finished, EmergencyReason::None));
    // Levels are displacements: stepped response.
    settings.amplitude = AmplitudeSettings::response(&settings.phase, 0.05);
    settings.schedule = levels(&[0.6e-3, 1.02e-3])?;
    settings.limits.drive = 4.0;
    assert_eq!(run("response", &settings)?, (Stage::Finished, EmergencyReason::None));
    // A contact force above its limit ends the test.
    settings.limits.contact_force = 1.0;
    assert_eq!(run("emergency", &settings)?, (Stage::Stopped, EmergencyReason::ContactForce));
    Ok(())
}

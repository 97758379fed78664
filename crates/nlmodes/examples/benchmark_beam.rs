//! The beam of the paper on the virtual rig: levels of the shaker up and down, one line each.
//!
//! ```text
//! cargo run -p nlmodes --example benchmark_beam -- [force] [hard] [noise] [up] [cut=0.1] [R=2 …] LEVEL…
//! ```
//!
//! Ideal force instead of the shaker, hard stop instead of the spring, noise of the sensors, only upwards, cut-off of
//! the detector relative to the frequency, data of the shaker (R, L, T, m, ka, ca, ks, cs).

#![allow(mixed_script_confusables, dead_code)]

#[path = "../tests/suite/rig/analysis.rs"]
mod analysis;
#[path = "../tests/suite/rig/beam.rs"]
mod beam;

use std::f64::consts::TAU;

use nlmodes::rig::{ContactLaw, ControlChannels, Exciter, RigError, Shaker, Stop, VirtualTest};
use nlmodes_experiment::phase_loop::{LevelSchedule, LoopSettings, Resonance, TestSettings};

fn main() -> Result<(), RigError> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let has = |word: &str| arguments.iter().any(|a| a == word);
    let value = |key: &str, default: f64| {
        arguments.iter().find_map(|a| a.strip_prefix(key)?.strip_prefix('=')?.parse().ok()).unwrap_or(default)
    };
    let d = Shaker::default();
    let shaker = Shaker {
        resistance: value("R", d.resistance),
        inductance: value("L", d.inductance),
        force_constant: value("T", d.force_constant),
        armature_mass: value("m", d.armature_mass),
        suspension_stiffness: value("ka", d.suspension_stiffness),
        suspension_damping: value("ca", d.suspension_damping),
        stinger_stiffness: value("ks", d.stinger_stiffness),
        stinger_damping: value("cs", d.stinger_damping),
    };
    let exciter = if has("force") { Exciter::IdealForce } else { Exciter::Shaker(shaker) };
    let mut rig = if has("noise") { beam::with_noise(beam::setup(exciter)) } else { beam::setup(exciter) };
    if has("hard") {
        let residual = beam::Shapes::new().residual(beam::LENGTH);
        rig.stop = rig.stop.map(|stop| Stop { law: ContactLaw::Rigid, residual, ..stop });
    }
    let mut levels: Vec<f64> = arguments.iter().filter_map(|a| a.parse().ok()).collect();
    if levels.is_empty() {
        levels = vec![0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0];
    }
    if !has("up") {
        levels.extend(levels.clone().into_iter().rev().skip(1));
    }
    let resonance = Resonance { omega: TAU * beam::FREQUENCIES_HZ[0], damping_ratio: beam::DAMPING_RATIOS[0] };
    let phase = LoopSettings {
        cut_off: value("cut", 0.1) * resonance.omega,
        ..LoopSettings::new(resonance, TAU * 40.0, beam::INTERVAL)
    };
    let test = VirtualTest {
        control: TestSettings::new(phase, LevelSchedule::new(&levels)?),
        channels: ControlChannels::new(beam::FORCE, beam::DRIVE_DISPLACEMENT),
        harmonics: None,
        rig,
    };
    println!("level hold/s f/Hz lag/deg F1/N q/mkg delta pbmif(100) v2/v1 x_tip/mm peak contact/N findings");
    let began = std::time::Instant::now();
    test.run(|outcome| {
        let f = analysis::figures(&test.rig, &outcome.record, outcome.steady.omega, 100);
        let contact = analysis::samples(&outcome.record, "f_contact");
        println!(
            "{:.3} {:5.1} {:.5} {:.4} {:.4} {:.4e} {:.4e} {:.4} {:.2e} {:.4} {:7.1} {}",
            outcome.level,
            outcome.settling,
            outcome.steady.omega / TAU,
            f.lag.to_degrees(),
            outcome.steady.force,
            f.amplitude,
            f.damping,
            f.pbmif,
            f.modal[1].norm() / f.modal[0].norm(),
            analysis::amplitudes(&outcome.record, "x_tip", 1)[0].norm() * 1e3,
            contact.iter().fold(0.0f64, |a, b| a.max(*b)),
            outcome.findings.iter().map(|f| f.to_string()).collect::<Vec<_>>().join("; "),
        );
    })?;
    println!("{:.1} s of computing", began.elapsed().as_secs_f64());
    Ok(())
}

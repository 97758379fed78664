//! An oscillator brought into resonance by the phase-locked loop, its record written and read, and the mode taken from
//! the record.
//!
//! `cargo run -p nlmodes-experiment --example ring_up`

use std::error::Error;
use std::f64::consts::TAU;

use nlmodes_experiment::extraction::{ExtractionSettings, RecordExtraction, extract};
use nlmodes_experiment::phase_loop::{LoopSettings, PhaseLockedLoop, Resonance};
use nlmodes_experiment::records::{Channel, Quantity, Record, Role};
use nlmodes_modal::LinearModes;

const OMEGA: f64 = TAU * 40.0; // rad/s, of an oscillator of 1 kg
const DAMPING: f64 = 0.01;
const FORCE: f64 = 2.0; // N
const RATE: f64 = 20_000.0; // Hz
const STEPS: usize = 8; // of the integration, a sample

/// Ten seconds under the loop, which starts 1 Hz too low; the last second is kept.
fn record() -> Result<Record, Box<dyn Error>> {
    let resonance = Resonance { omega: OMEGA, damping_ratio: DAMPING };
    let pll = PhaseLockedLoop::new(LoopSettings::new(resonance, OMEGA - TAU, 1.0 / RATE))?;
    let (mut state, mut x, mut v) = (pll.start(), 0.0, 0.0);
    let (mut forces, mut responses) = (Vec::new(), Vec::new());
    let step = 1.0 / RATE / STEPS as f64;
    for sample in 0..(10.0 * RATE) as usize {
        let force = FORCE * state.drive_phase().cos();
        if sample >= (9.0 * RATE) as usize {
            forces.push(force);
            responses.push(x);
        }
        state = pll.step(&state, force, x);
        for i in 0..STEPS {
            let force = FORCE * (state.drive_phase() + (i as f64 / STEPS as f64 - 1.0) * state.omega() / RATE).cos();
            v += step * (force - 2.0 * DAMPING * OMEGA * v - OMEGA * OMEGA * x);
            x += step * v;
        }
    }
    let force = Channel::new("force", Quantity::Force, Role::Excitation, Some(0.0));
    let response = Channel::new("response", Quantity::Displacement, Role::DrivePoint, Some(0.0));
    Ok(Record::new("ring up", RATE).with(force, forces).with(response, responses))
}

fn mode(record: &Record) -> Result<RecordExtraction, Box<dyn Error>> {
    let modes = LinearModes::new(&[0.0], &[OMEGA], &[DAMPING], &[vec![1.0]])?;
    let settings = ExtractionSettings { harmonics: 5, linear_modes: Some(modes), ..ExtractionSettings::default() };
    Ok(extract(record, &settings)?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let found = mode(&record()?)?;
    println!("frequency  {:.5} Hz (±{:.0e})", found.omega.value / TAU, found.omega.uncertainty / TAU);
    if let Some(excitation) = &found.excitation {
        println!("lag        {:.3}°", excitation.lag.value.to_degrees());
        println!("PBMIF      {:.6} from {} harmonics", excitation.pbmif.value, excitation.power.harmonics);
    }
    if let Some(damping) = found.modal.as_ref().and_then(|modal| modal.damping) {
        println!("damping    {:.6} (±{:.0e})", damping.value, damping.uncertainty);
    }
    let names = found.finding_names();
    println!("findings   {}", if names.is_empty() { "none" } else { &names });
    Ok(())
}

#[test]
fn frequency_lag_damping_and_indicator_are_those_of_the_oscillator() -> Result<(), Box<dyn Error>> {
    let found = mode(&record()?)?;
    // The symplectic integration lowers or raises frequencies by (ω h)² / 24 = 1e-7.
    assert!((found.omega.value / OMEGA - 1.0).abs() < 1e-4, "{:?}", found.omega);
    let excitation = found.excitation.as_ref().ok_or("no excitation")?;
    assert!((excitation.lag.value.to_degrees() - 90.0).abs() < 0.5, "{:?}", excitation.lag);
    assert!((excitation.pbmif.value - 1.0).abs() < 1e-4, "{:?}", excitation.pbmif);
    let damping = found.modal.as_ref().and_then(|modal| modal.damping).ok_or("no damping")?;
    assert!((damping.value / DAMPING - 1.0).abs() < 1e-2, "{damping:?}");
    Ok(())
}

//! Levels that phase control holds, by Floquet multipliers and by the virtual rig, on random structures.
//!
//! ```text
//! cargo run -p nlmodes-benchmarks --example held_levels -- [structures=24] [seed=1]
//! ```
//!
//! Each structure has two or three modes, a stop (elastic or rigid with a residual flexibility) and an ideal force or a
//! shaker, all drawn by lot, and six levels about that of grazing, one after the other. Written: a line for each level
//! with what its multipliers announce and what the rig does, and the table of both at the end.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes::experiment::phase_loop::{LevelSchedule, LoopSettings, Resonance, SteadyCriteria, TestSettings};
use nlmodes::model::{ContactLaw, Side};
use nlmodes::rig::{
    ControlChannels, DrivePoint, Exciter, LevelsAhead, LinearStructure, MotionQuantity, RigSetup, Sensor, SensorPlace,
    Shaker, Stop, VirtualTest,
};
use nlmodes_benchmarks::Failure;

/// Levels over the one that just reaches the stop.
const LEVELS: [f64; 6] = [0.7, 1.1, 1.4, 1.8, 2.4, 3.2];
/// Longest hold, s.
const LONGEST: f64 = 20.0;

/// Numbers by lot, in [0, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// Evenly in its logarithm.
    fn size(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }
}

/// A structure with its test, and what it is in words.
fn test(seed: u64) -> Result<(VirtualTest, String), Failure> {
    let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    for _ in 0..20 {
        random.next();
    }
    let modes = if random.next() < 0.5 { 2 } else { 3 };
    let hz = random.between(25.0, 60.0);
    let mut omega = vec![TAU * hz];
    let mut ratio = 1.0;
    for _ in 1..modes {
        ratio *= random.between(1.8, 4.5);
        omega.push(TAU * hz * ratio);
    }
    let damping_ratios: Vec<f64> = (0..modes).map(|_| random.size(0.003, 0.02)).collect();
    let mut shape = || -> Vec<f64> {
        (0..modes).map(|k| if k == 0 { random.between(0.5, 1.5) } else { random.between(-1.5, 1.5) }).collect()
    };
    let (at_drive, at_stop) = (shape(), shape());
    let gap = random.size(3e-4, 2e-3);
    let rigid = random.next() < 0.4;
    // The stop over the stiffness of the mode there.
    let hardness = random.size(3.0, 100.0);
    let stiffness = hardness * omega[0].powi(2) / at_stop[0].powi(2);
    let (law, residual) =
        if rigid { (ContactLaw::Rigid, 1.0 / stiffness) } else { (ContactLaw::Elastic { stiffness }, 0.0) };
    // A shaker with an armature that is light against the mode.
    let shaker = Shaker { armature_mass: 0.02, suspension_stiffness: 2e3, ..Shaker::default() };
    let exciter = if random.next() < 0.5 { Exciter::Shaker(shaker) } else { Exciter::IdealForce };
    let interval = 1.0 / 20_000.0;
    let resonance = Resonance { omega: omega[0], damping_ratio: damping_ratios[0] };
    let phase = LoopSettings::new(resonance, 0.9975 * omega[0], interval);
    let settling = SteadyCriteria { longest: LONGEST, ..SteadyCriteria::default() };
    let kind = if rigid { "rigid" } else { "elastic" };
    let words = format!("{modes} modes, {hz:.1} Hz, {kind} stop of {hardness:.0}, {}", exciter.name());
    let motion = MotionQuantity::Displacement;
    let mut rig = RigSetup {
        structure: LinearStructure { omega, damping_ratios },
        drive_point: DrivePoint { position: 0.1, shape: at_drive, residual: 0.0 },
        exciter,
        stop: Some(Stop { position: 1.0, shape: at_stop, side: Side::Positive, gap: 1.0, law, residual }),
        sensors: vec![
            Sensor::new("force", SensorPlace::Excitation, 0.0),
            Sensor::new("x", SensorPlace::DrivePoint(motion), 0.0),
            Sensor::new("x_stop", SensorPlace::StopPoint(motion), 0.0),
        ],
        interval,
        substeps: None,
        seed,
    };
    let with = |rig: &RigSetup, levels: &[f64]| -> Result<VirtualTest, Failure> {
        let schedule = LevelSchedule { settling, record: 0.5, ..LevelSchedule::new(levels)? };
        let (control, channels) = (TestSettings::new(phase.clone(), schedule), ControlChannels::new(0, 1));
        Ok(VirtualTest { rig: rig.clone(), control, channels, harmonics: None })
    };
    // A thousandth of the level that reaches the stop is linear.
    let linear = LevelsAhead::new(&with(&rig, &[1e-3])?)?.all(|| ControlFlow::Continue(()))?;
    let per_unit = linear[0].motion.as_ref().ok_or("no linear motion")?.peaks[2] / 1e-3;
    if let Some(stop) = &mut rig.stop {
        stop.gap = gap;
    }
    Ok((with(&rig, &LEVELS.map(|level| level * gap / per_unit))?, words))
}

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |key: &str, default: u64| {
        arguments.iter().find_map(|a| a.strip_prefix(key)?.strip_prefix('=')?.parse().ok()).unwrap_or(default)
    };
    let (structures, first) = (number("structures", 24), number("seed", 1));
    println!(
        "| structure | level | Hz | largest μ | announced | rig | |\n| --- | ---: | ---: | ---: | --- | --- | --- |"
    );
    // Announced as held or not, by what the rig did.
    let mut table = [[0; 2]; 2];
    for seed in first..first + structures {
        let (test, words) = test(seed)?;
        let ahead = LevelsAhead::new(&test)?.all(|| ControlFlow::Continue(()))?;
        let mut outcomes = Vec::new();
        let ended = test.run_while(
            || ControlFlow::Continue(()),
            |outcome| {
                let found: Vec<&str> = outcome.findings.iter().map(|finding| finding.name()).collect();
                outcomes.push((outcome.findings.is_empty(), outcome.steady.omega, found.join(" ")));
                ControlFlow::Continue(())
            },
        );
        for (k, level) in ahead.iter().enumerate() {
            let announced = level.is_held(LONGEST);
            let (held, omega, found) =
                outcomes.get(k).cloned().unwrap_or((false, f64::NAN, format!("{:?}", ended.as_ref().err())));
            table[usize::from(announced)][usize::from(held)] += 1;
            let motion = level.motion.as_ref();
            let (hz, largest) = motion.map_or((f64::NAN, f64::NAN), |m| (m.omega / TAU, m.largest()));
            // The same level may have several motions.
            let elsewhere = held && (omega / TAU / hz - 1.0).abs() > 1e-3;
            println!(
                "| {seed}: {words} | {:.1} | {hz:.3} | {largest:.4} | {} | {} {} | {}{} |",
                LEVELS[k],
                if announced { "held" } else { "not held" },
                if held { "held" } else { "not held" },
                found,
                if level.jumped { "jump " } else { "" },
                if elsewhere { format!("at {:.3} Hz", omega / TAU) } else { String::new() },
            );
        }
    }
    println!("\nannounced held: {} held, {} not held by the rig", table[1][1], table[1][0]);
    println!("announced not held: {} held, {} not held by the rig", table[0][1], table[0][0]);
    Ok(())
}

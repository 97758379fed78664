//! Makes the two short records of `configs/records`: a beam-like structure in phase resonance, below the stop and
//! against it.
//!
//! `cargo run --release -p nlmodes-experiment --example short_records -- configs/records`

use std::error::Error;
use std::fs::File;
use std::path::PathBuf;

use nlmodes_experiment::records::write_csv;
use support::autoresonance::Rig;
use support::{POSITIONS, modes};

#[path = "../tests/suite/support.rs"]
mod support;

/// Forces (N) of the two levels.
const LEVELS: [(&str, f64); 2] = [("below_stop", 2.5), ("against_stop", 8.0)];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("name the folder for the records")?);
    let modes = modes();
    println!("positions {POSITIONS:?}, frequencies {:?} rad/s", modes.omegas());
    for (name, force) in LEVELS {
        let rig = Rig {
            modes: modes.clone(),
            drive: 0,
            tip: 3,
            gap: 1e-3,
            stiffness: 2e5,
            exponent: 1.0,
            force,
            sample_rate: 8000.0,
            noise: 2e-4,
        };
        let record = rig.record(name, 8.0, 870, 21);
        write_csv(File::create(folder.join(format!("{name}.csv")))?, &record, Some(5))?;
    }
    Ok(())
}

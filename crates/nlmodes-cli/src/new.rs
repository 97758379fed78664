//! `nlmodes-cli new`: a commented scene to start from.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::Status;
use crate::terminal::print;

/// Command-line arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    /// What the scene describes
    #[arg(value_enum)]
    kind: Kind,
    /// The file; by default rod.toml, beam.toml or virtual-test.toml
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Kind {
    /// A rod with a stop at its tip
    Rod,
    /// A beam with a stop at its tip
    Beam,
    /// A beam on a virtual rig, driven by a phase-locked loop
    VirtualTest,
    /// A beam driven by a shaker: responses, phase resonance, damped mode
    Response,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Rod => "rod",
            Self::Beam => "beam",
            Self::VirtualTest => "virtual-test",
            Self::Response => "response",
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::Rod => include_str!("new/rod.toml"),
            Self::Beam => include_str!("new/beam.toml"),
            Self::VirtualTest => include_str!("new/virtual_test.toml"),
            Self::Response => include_str!("new/response.toml"),
        }
    }
}

/// Writes the scene; never overwrites a file.
pub fn write(arguments: &Arguments) -> Status {
    let kind = arguments.kind;
    let path = arguments.file.clone().unwrap_or_else(|| PathBuf::from(format!("{}.toml", kind.name())));
    let name = path.display();
    let written = OpenOptions::new().write(true).create_new(true).open(&path);
    match written.and_then(|mut file| file.write_all(kind.text().as_bytes())) {
        Ok(()) => print(&format!("Wrote {name}. Next:\n  nlmodes-cli check {name}\n  nlmodes-cli run {name}")),
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
            say!("error: {name} already exists and is left alone");
            say!("  another name can be given: nlmodes-cli new {} FILE", kind.name());
            Status::Wrong
        }
        Err(error) => {
            say!("error: cannot write {name}: {error}");
            Status::EndedEarly
        }
    }
}

//! What nlmodes reads from files that nobody has vouched for, one function of bytes for each reader.
//!
//! A reader may refuse what it gets; it must not panic, hang, or take memory that the input does not pay for.

pub mod corpus;
mod models;
pub mod mutation;
mod readers;
mod resumed;
mod structures;

pub use readers::{Reader, Scratch, Target, target};

/// Names of all targets.
pub const TARGETS: [&str; 26] = [
    "scene",
    "record-scene",
    "test-scene",
    "csv",
    "uff",
    "wav",
    "npy",
    "lcp",
    "results",
    "resumed-run",
    "resumed-steps",
    "sti",
    "matrix-market",
    "abaqus",
    "npz",
    "mat5",
    "mat73",
    "hb",
    "pch",
    "labels",
    "inp",
    "msh",
    "bdf",
    "numbers",
    "model",
    "reduced",
];

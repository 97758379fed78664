//! From a checked scene to a directory of results: journal, tables, figures, page.
//!
//! Nothing is printed. Progress is passed to an [`Observer`] as an [`Event`], and the observer can end a run; results
//! and errors are data. Scenes, outcomes and errors are [`Send`]: a run may be in its own thread.
//!
//! | item | what it does |
//! | --- | --- |
//! | [`run`](branches::run()) | the branches of a scene, of each of its methods and numbers of harmonics |
//! | [`check`], [`check_records`], [`check_test`] | whether it can start, and what it would compute |
//! | [`responses::run`] | damped and forced motions: response curves, phase resonance, damped modes |
//! | [`transient::run`] | a motion in time under any loads |
//! | [`settle::settle`] | what the motion of a response's point becomes once it is disturbed |
//! | `settle::verify_response` | one period of a response from a computed point, and the exact motion next to it |
//! | [`follow::follow`] | folds, first touches or a mode at an energy over a parameter of the scene |
//! | [`records::extract`] | measured records to modal points |
//! | [`virtual_test::run`] | a rig with its loop, level by level |
//! | [`compare::rows`] | the same branch with several contact solvers |
//! | [`verify::verify`] | one period of the full structure from a computed point |
//! | [`linear::linear_frequencies`], [`updating::updated`] | linear modes; parameters from measured frequencies |
//! | [`certificate::Certificate`] | verification report: checks of the numbers of a branch, and which not to use |
//! | [`mass::warning_of`] | what the mass taken from contacts does to the linear mode |
//! | [`overlay`] | results of other runs and tests laid over a branch, with the differences in numbers |
//! | [`redrawn::redraw`] | the figures of results in another width |
//! | [`explore::picture`] | the first branch of a scene as data, without files |
//! | [`lcp`] | contact problems of one's own, in NumPy archives |
//! | [`Observer`], [`Event`], [`Progress`] | what happens, and cancellation; how far a branch is |
//! | [`RunError`] | why there are no results, and whether the scene or the call is to blame |
//!
//! # Example
//! ```
//! use nlmodes_run::{Over, Silent};
//!
//! let text = r#"
//! [structure]
//! kind = "rod"
//! length_m = 1.0
//! elements = 8
//! start = "clamped"
//! material = { youngs_modulus_pa = 210e9, density_kg_m3 = 7800.0 }
//! section = { area_m2 = 1e-4 }
//! [[contact]]
//! at_m = 1.0
//! direction = "axial"
//! side = "positive"
//! gap_m = 1e-3
//! [method]
//! harmonics = 3
//! [continuation]
//! max_energy_ratio = 3.0
//! "#;
//! let directory = std::env::temp_dir().join(format!("nlmodes-run-example-{}", std::process::id()));
//! let mut scenes = nlmodes_scene::parse_each_method("rod.toml", text, &[]).map_err(|refused| refused.text(false))?;
//! scenes[0].scene.output_directory = directory.clone();
//! let outcome = nlmodes_run::run(scenes, Over::Same, &mut Silent)?;
//! let computed = &outcome.parts[0].tree.branches[0];
//! assert!(outcome.is_complete() && computed.branch.points.iter().all(|point| point.residual < 1e-10));
//! assert!(directory.join("branch.csv").is_file() && directory.join("report.html").is_file());
//! # std::fs::remove_dir_all(directory)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod branches;
pub mod certificate;
mod character;
mod check;
mod claim;
pub mod compare;
mod course;
mod curve;
pub mod design;
mod doubts;
mod error;
pub mod explore;
mod files;
pub mod follow;
mod forces;
mod gradients;
mod journal;
pub mod lcp;
pub mod linear;
mod links;
pub mod mass;
mod model;
mod motion;
mod observer;
pub mod open_modes;
mod outcome;
pub mod overlay;
pub mod passages;
mod physical;
mod progress;
pub mod records;
pub mod redrawn;
mod refusal;
pub mod responses;
mod settings;
pub mod settle;
mod sheet;
mod sliding;
mod started_in;
mod style;
pub mod transient;
mod two_columns;
pub mod updating;
pub mod verify;
pub mod virtual_test;

pub use branches::{run, run_sharing};
pub use check::{check, check_records, check_test};
pub use claim::Over;
pub use error::{Failure, RunError, chain};
pub use observer::{Event, Observer, Silent};
pub use outcome::{Ending, PartOutcome, RunOutcome};
pub use progress::{CheckProgress, Progress};
pub use refusal::no_contact;
pub use started_in::started_in;

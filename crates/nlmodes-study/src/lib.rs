//! Studies: a quantity over parameters, its scatter and its sensitivity, from thousands of branches.
//!
//! ```text
//! study.toml  →  Study  →  cases  →  cases/<id>/ (a run each)  →  table, statistics, page
//! ```
//!
//! A case is the scene of the study with the values of one point of the design, one method and one number of harmonics.
//! Its name is a hash of the resulting scene and of the version of the program: existing cases are not computed again,
//! whichever process computed them, but changed ones are. Nothing is printed; progress goes to a [`StudyObserver`], and
//! results are data.
//!
//! | item | what |
//! | --- | --- |
//! | [`Study`] | a study file, read and checked with its scene: [`Study::load`] |
//! | [`cases`](case::cases) | its cases, with their names |
//! | [`run`](run::run()), [`Settings`], [`Shard`] | computes missing cases, one branch per thread |
//! | [`Collected`] | the [`Table`] of existing cases, its [`Statistics`], its page |
//! | [`FirstOrder`] | what gradients say: spread, worst corners, how much of the tolerances keeps to a limit |
//! | [`fit()`] | the variables from measured points, with their covariance |
//! | [`Evaluator`] | single cases for an optimiser or sampler |
//! | [`serve`] | the same line by line of JSON, for a program in another language |
//! | [`slurm`] | a study as an array job |
//! | [`status`] | number of cases in each state |
//! | [`StudyError`] | why a study cannot continue |
//!
//! # Example
//! ```
//! use nlmodes_run::Silent;
//! use nlmodes_study::{Collected, Settings, Study, run};
//!
//! let scene = r#"
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
//! harmonics = 1
//! [continuation]
//! max_energy_ratio = 2.0
//! "#;
//! let text = r#"
//! scene = "rod.toml"
//! [[vary]]
//! key = "contact.0.gap_m"
//! values = [1e-3, 2e-3]
//! [[quantity]]
//! name = "f_2"
//! of = "frequency_hz"
//! at = { energy_ratio = 2.0 }
//! "#;
//! let mut study = Study::parse_with_scene("study.toml", text, scene).map_err(|refused| refused.text(false))?.scene;
//! # let place = tempfile::tempdir()?;
//! # let directory = place.path().to_path_buf();
//! study.directory = directory;
//! let outcome = run(&study, &Settings::default(), &mut Silent)?;
//! assert!(outcome.is_done() && outcome.computed == 2);
//! let table = Collected::new(&study, 1).table;
//! // Doubling the gap scales the motion, and has no other effect.
//! let f = table.column("f_2").and_then(|cells| cells.numbers()).ok_or("no column")?;
//! assert!(f.iter().all(|f| f.is_some()) && (f[0].unwrap() - f[1].unwrap()).abs() < 1e-6 * f[0].unwrap());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod case;
mod check;
mod collect;
mod curve;
mod design;
mod distribution;
mod error;
mod evaluate;
mod figures;
mod first_order;
mod fit;
mod page;
mod parallel;
mod raw;
mod read;
pub mod run;
mod serve;
pub mod slurm;
mod statistics;
mod store;
mod study;
mod table;
mod told;
mod write;

pub use collect::{Band, Collected, Counts, Drawn, State, status};
pub use curve::{Curve, CurveError, ENERGY_RATIO, Level, Picked, pick};
pub use design::Points;
pub use distribution::{Distribution, Tolerance};
pub use error::StudyError;
pub use evaluate::{Answer, Evaluator};
pub use first_order::{Compared, Corner, Effect, FirstOrder, Kept, OfQuantity};
pub use fit::{FitError, FitOutcome, Fitted, FittedRow, fit};
pub use read::{StudyFile, schema};
pub use run::{Settings, Shard, StudyObserver, StudyOutcome, run};
pub use serve::serve;
pub use statistics::{
    Correlation, Expansion, Sensitivity, SobolIndex, Spread, Statistics, quantile, rank_correlation, sobol_indices,
};
pub use store::{CaseRecord, Status, Store};
pub use study::{
    Design, DesignKind, Keep, Limit, Measured, MeasuredColumn, Of, Place, Quantity, Selected, Study, Sweep, Values,
    Variable,
};
pub use table::{Cells, Column, Table};

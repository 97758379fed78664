//! Scene files: reading, checking, and saying what is wrong with them.
//!
//! ```text
//! file + --set  →  document  →  conform to the schema  →  tables  →  check between values  →  Scene
//! ```
//!
//! Conformity reports all that it finds; what must hold between values is checked of those that conform.
//! Nothing is printed and nothing is written: what there is to say comes back as data with the place that it is about.
//!
//! | item | what it is |
//! | --- | --- |
//! | [`parse_each_method`], [`load_structure`] | text or file → the checked scene of a structure, one for each method |
//! | [`load_any`], [`load_to_run`], [`load_records`], [`parse_any`] | the same for a scene of any kind, [`AnyScene`] |
//! | [`SceneFile`] | the scene, the places of its keys, its warnings |
//! | [`Diagnostic`], [`Diagnostics`], [`SceneError`] | what is wrong and where; all of it; a scene that is refused |
//! | [`load_other`], [`parse_other`] | files of other kinds than scenes, with messages as good |
//! | [`whole_schema`] | every key with its unit, limits and default |
//! | [`assemble`] | scene → structural model |
//! | [`outline`] | what a scene would compute, in rows |
//! | [`memory`] | what a scene needs, before anything is computed |
//!
//! # Example
//! ```
//! use nlmodes_scene::{assemble::structural_model, parse};
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
//! harmonics = 5
//! [continuation]
//! max_energy_ratio = 10.0
//! "#;
//! let file = parse("rod.toml", text, &["contact.0.gap_mm=2".to_owned()]).map_err(|refused| refused.text(false))?;
//! assert_eq!(file.scene.contacts[0].gap, 2e-3);
//! let model = structural_model(&file.scene).map_err(|error| error.to_string())?;
//! assert_eq!(model.contacts()[0].gap, 2e-3);
//!
//! let refused = parse("rod.toml", &text.replace("gap_m", "gap"), &[]).unwrap_err();
//! assert!(refused.text(false).contains("did you mean `gap_m`?"));
//! # Ok::<(), String>(())
//! ```

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod assemble;
mod check;
mod conform;
mod diagnostic;
mod diagnostics;
mod document;
pub mod doubts;
mod file;
pub mod memory;
mod methods;
mod nearest;
mod other;
pub mod outline;
mod planned;
mod raw;
mod read;
mod render;
mod responses;
mod rule;
pub mod scene;
mod scene_error;
mod scene_file;
mod schema;
mod set;
mod sources;
mod syntax;
mod text;
mod units;

pub use diagnostic::{Diagnostic, Mark, Severity};
pub use diagnostics::Diagnostics;
pub use document::{Document, KeyPlace};
pub use file::FileError;
pub use nearest::nearest;
pub use nlmodes_linalg::rounded;
pub use other::{load_other, parse_other};
pub use read::{
    load_any, load_records, load_structure, load_to_run, overrides_at, parse, parse_any, parse_each_method,
    parse_records, parse_test,
};
pub use rule::{counted, number, percent, short, significant};
pub use scene::{RecordScene, Scene, TestScene};
pub use scene_error::SceneError;
pub use scene_file::{AnyScene, SceneFile};
pub use schema::{schema, schema_for, whole_schema};
pub use sources::{Source, Sources};

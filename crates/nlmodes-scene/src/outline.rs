//! What a scene would compute, in a few rows: so that wrong units, places and supports show before anything is
//! computed.

mod matrices;
mod records;
mod reduced;
mod responses;
mod springs;
mod static_loads;
mod structure;
mod test;
mod transient;

use std::fmt;

use crate::assemble::{OpenStructure, StaticState};
use crate::number;
use crate::scene::{RecordScene, Scene, TestScene};
pub use responses::place as place_in_words;

/// What a scene would compute. Its [`Display`](fmt::Display) is the text of `nlmodes-cli check`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Outline {
    /// Title of the scene.
    pub title: String,
    /// Structure, stops, method, what is computed, and where results go.
    pub rows: Vec<Row>,
    /// Whether it can be computed, in a sentence.
    pub verdict: &'static str,
}

/// A row of an outline.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    /// What it is about, as `method`; empty where it goes on with what the row before began.
    pub name: String,
    /// What is to be reported.
    pub text: String,
}

/// What a scene comes to above which there is a warning that is to be read first.
const WARNED: &str = "The scene can be computed, but see the warning; nothing was computed.";

impl Outline {
    /// Of a structure; `open` is known of structures in open modes, `state` of those with static loads or stops that
    /// press. `warned` says that a warning precedes it which is to be read first.
    pub fn of_structure(
        scene: &Scene,
        (open, state): (Option<&OpenStructure>, Option<&StaticState>),
        warned: bool,
    ) -> Self {
        Self { title: scene.title.clone(), rows: structure::rows(scene, open, state), verdict: verdict(warned) }
    }

    /// Of records, whose files are there.
    pub fn of_records(scene: &RecordScene, warned: bool) -> Self {
        let sound = "The scene is sound and its files are there; nothing was read or computed.";
        Self { title: scene.title.clone(), rows: records::rows(scene), verdict: if warned { WARNED } else { sound } }
    }

    /// Of a virtual test.
    pub fn of_test(scene: &TestScene, warned: bool) -> Self {
        Self { title: scene.title.clone(), rows: test::rows(scene), verdict: verdict(warned) }
    }
}

fn verdict(warned: bool) -> &'static str {
    if warned { WARNED } else { "The scene is sound; nothing was computed." }
}

impl fmt::Display for Outline {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n", self.title)?;
        for Row { name, text } in &self.rows {
            writeln!(f, "  {name:<12}{text}")?;
        }
        write!(f, "\n{}", self.verdict)
    }
}

fn row(name: impl Into<String>, text: impl Into<String>) -> Row {
    Row { name: name.into(), text: text.into() }
}

/// Numbers as they are written in a scene.
fn list(values: &[f64]) -> String {
    values.iter().map(|x| number(*x)).collect::<Vec<_>>().join(", ")
}

/// The law of a stop.
fn law(stiffness: Option<f64>) -> String {
    stiffness.map_or_else(|| "rigid".to_owned(), |k| format!("{} N/m", number(k)))
}

//! Names of result files, and the removal of those that an earlier run left.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

/// Says which scene the results in a directory are of.
pub const RUN: &str = "run.json";

/// Folders below a directory of results in which there may be branches: of methods, harmonics and half-branches.
pub const DEPTH: usize = 3;

/// The steps of a branch, from which a run continues.
pub const STEPS: &str = "steps.jsonl";

/// Where the exact motions of a branch by shooting start.
pub const STARTS: &str = "starts.npz";

/// Figures of damped and forced motions.
const RESPONSE_FIGURES: [&str; 7] = [
    "responses.svg",
    "force_response.svg",
    "drive.svg",
    "phase.svg",
    "contact_force.svg",
    "damping_ratio.svg",
    "force_needed.svg",
];

/// Figures of motions in time.
const TRANSIENT_FIGURES: [&str; 2] = ["envelope.svg", "spectrum.svg"];

/// A figure, and its conversions.
const FIGURE_ENDINGS: [&str; 3] = [".svg", ".pdf", ".png"];

/// Most records with a time history.
pub const HISTORIES: usize = 20;

/// Removes what a run writes at its end, which would not belong to the points of another one.
pub fn remove_ends(directory: &Path) {
    remove_figures(directory);
    let ends = [
        "summary.json",
        "harmonics.npz",
        "contacts.csv",
        "histories.npz",
        "results.mat",
        "transient.npz",
        "touches.csv",
        "settled.json",
        STARTS,
        crate::forces::FILE,
    ];
    remove_all(directory, &ends);
}

/// Removes the figures and the page of an earlier run.
pub fn remove_figures(directory: &Path) {
    remove_all(directory, &(1..=4).map(|k| format!("motion_{k}.svg")).collect::<Vec<_>>());
    let common = [
        "frequency_energy.svg",
        "frequency_amplitude.svg",
        "contacts.svg",
        "overlay.csv",
        "overlay_stops.csv",
        "methods.csv",
        "methods_stops.csv",
        "participation.svg",
        "participation.csv",
        "report.html",
    ];
    remove_all(directory, &common);
    remove_all(directory, &RESPONSE_FIGURES);
    remove_all(directory, &TRANSIENT_FIGURES);
    remove_where(directory, |name| {
        name.starts_with("history_P") && FIGURE_ENDINGS.iter().any(|ending| name.ends_with(ending))
    });
    remove_where(directory, has_width);
}

/// Whether a file is a figure of a width of its own: `frequency_energy_90mm.pdf`.
fn has_width(name: &str) -> bool {
    let stem = FIGURE_ENDINGS.iter().find_map(|ending| name.strip_suffix(ending)).unwrap_or_default();
    let width = stem.strip_suffix("mm").and_then(|stem| stem.rsplit_once('_'));
    width.is_some_and(|(_, width)| width.parse::<f64>().is_ok())
}

/// The figures of a directory as PDF and PNG: beside their SVG, or with their own width.
pub fn made_of_figures(directory: &Path) -> impl Iterator<Item = PathBuf> {
    let is_one = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let is_converted = FIGURE_ENDINGS[1..].iter().any(|ending| name.ends_with(ending));
        is_converted && (has_width(&name) || path.with_extension("svg").is_file())
    };
    fs::read_dir(directory).into_iter().flatten().flatten().map(|entry| entry.path()).filter(is_one)
}

/// Removes the figures and the page of records of an earlier run.
pub fn remove_figures_of_records(directory: &Path) {
    let histories = (1..=HISTORIES).flat_map(|k| [format!("history_{k}.svg"), format!("contact_{k}.svg")]);
    remove_all(directory, &histories.collect::<Vec<_>>());
    let common =
        ["frequency_amplitude.svg", "frequency_contact.svg", "damping_amplitude.svg", "restitution.svg", "report.html"];
    remove_all(directory, &common);
}

/// Removes what killed runs were about to write.
pub fn remove_temporary(directory: &Path) {
    // As `nlmodes-report` names them.
    remove_where(directory, |name| name.starts_with('.') && name.ends_with(".nlmodes.tmp"));
}

fn remove_where(directory: &Path, is_one: impl Fn(&str) -> bool) {
    let Ok(entries) = fs::read_dir(directory) else { return };
    for entry in entries.flatten().filter(|entry| is_one(&entry.file_name().to_string_lossy())) {
        drop(fs::remove_file(entry.path()));
    }
}

/// Removes files of these names, if they exist, together with conversions of figures.
pub fn remove_all(directory: &Path, names: &[impl AsRef<str>]) {
    // A file that cannot be removed cannot be overwritten either, which is reported then.
    let remove = |name: &str| drop(fs::remove_file(directory.join(name)));
    for name in names.iter().map(AsRef::as_ref) {
        match name.strip_suffix(".svg") {
            Some(stem) => FIGURE_ENDINGS.iter().for_each(|ending| remove(&format!("{stem}{ending}"))),
            None => remove(name),
        }
    }
}

/// What the summary of a directory says; null where there is none.
pub fn summary(directory: &Path) -> Value {
    let text = fs::read(directory.join("summary.json")).ok();
    text.and_then(|text| serde_json::from_slice(&text).ok()).unwrap_or_default()
}

/// Folders in a directory, without links to others.
pub fn folders(directory: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(directory).into_iter().flatten().flatten();
    let folders = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_dir()));
    folders.map(|entry| entry.path()).collect()
}

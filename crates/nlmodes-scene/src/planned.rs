//! Scenes of other commands.

use toml::de::{DeTable, DeValue};

use crate::Diagnostic;

const RECORDS: [&str; 5] = ["recording", "channel", "linear_modes", "extraction", "stop"];
const COMPUTED: [&str; 4] = ["contact", "method", "continuation", "structure"];

/// Whether the scene describes measured records.
pub fn is_of_records(root: &DeTable<'_>) -> bool {
    first(root, &RECORDS).is_some() && first(root, &["virtual_test"]).is_none()
}

/// Whether the scene describes a structure from the files of a finite-element program.
pub fn is_of_matrices(root: &DeTable<'_>) -> bool {
    has_kind(root, "matrices")
}

/// Whether the scene describes a structure that was reduced elsewhere.
pub fn is_of_reduced(root: &DeTable<'_>) -> bool {
    has_kind(root, "reduced")
}

/// Whether the one structure of the scene says that it is of this kind.
fn has_kind(root: &DeTable<'_>, wanted: &str) -> bool {
    let Some(DeValue::Table(structure)) = root.get("structure").map(|value| value.get_ref()) else { return false };
    matches!(structure.get("kind").map(|kind| kind.get_ref()), Some(DeValue::String(kind)) if kind == wanted)
}

/// Whether the scene describes several structures under headings `[[structure]]`.
pub fn is_of_bodies(root: &DeTable<'_>) -> bool {
    let Some(DeValue::Array(items)) = root.get("structure").map(|value| value.get_ref()) else { return false };
    !items.is_empty() && items.iter().all(|item| item.get_ref().is_table())
}

/// Whether the scene describes a virtual test.
pub fn is_of_test(root: &DeTable<'_>) -> bool {
    first(root, &["virtual_test"]).is_some()
}

/// The diagnostic of a scene of a virtual test where one of another kind is wanted.
pub fn of_test(root: &DeTable<'_>) -> Option<Diagnostic> {
    let (key, range) = first(root, &["virtual_test"])?;
    let diagnostic = Diagnostic::error("this scene describes a virtual test").help("`nlmodes-cli run` runs it");
    Some(diagnostic.at(range, format!("`{key}` describes the rig")))
}

/// The diagnostic of a scene of a virtual test that is one of a branch too.
pub fn of_test_and_branch(root: &DeTable<'_>) -> Option<Diagnostic> {
    let (key, range) = first(root, &["contact", "method", "continuation"])?;
    let diagnostic = Diagnostic::error(format!("`{key}` does not belong to a virtual test"));
    let diagnostic = diagnostic.help(
        "the stop of the rig belongs below [virtual_test.stop], and [virtual_test.backbone] has its backbone computed",
    );
    Some(diagnostic.at(range, "found beside [virtual_test]"))
}

/// The diagnostic of a scene of measured records where one of a structure is wanted.
pub fn of_records(root: &DeTable<'_>) -> Option<Diagnostic> {
    let (key, range) = first(root, &RECORDS).filter(|_| is_of_records(root))?;
    let diagnostic = Diagnostic::error("this scene describes measured records, not a structure to compute with");
    let diagnostic = diagnostic.help("`nlmodes-cli experiment extract` turns records into modal points");
    Some(diagnostic.at(range, format!("`{key}` describes measured records")))
}

/// The diagnostic of a scene of a structure where one of measured records is wanted.
pub fn not_of_records(root: &DeTable<'_>) -> Option<Diagnostic> {
    let (key, range) = first(root, &COMPUTED).filter(|_| !is_of_records(root))?;
    let diagnostic = Diagnostic::error("this scene describes a structure to compute with, not measured records");
    let diagnostic = diagnostic.help(
        "`nlmodes-cli run` computes it; records are described below a heading \
        [recording]",
    );
    Some(diagnostic.at(range, format!("`{key}` describes what is computed")))
}

/// The first of these keys in the text, and its position.
fn first(root: &DeTable<'_>, names: &[&str]) -> Option<(String, std::ops::Range<usize>)> {
    let entries = root.iter().filter(|(key, _)| names.contains(&key.get_ref().as_ref()));
    let entry = entries.min_by_key(|(key, _)| key.span().start);
    entry.map(|(key, value)| (key.get_ref().to_string(), value.span()))
}

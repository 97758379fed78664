//! Comparison of the points of records or of a test with overlays, at equal modal amplitude.

use std::path::Path;

use nlmodes::experiment::extraction::RecordExtraction;
use nlmodes::modal::ModalBranch;
use nlmodes::report::{DataTable, ReportError};
use serde_json::{Value, json};

use super::{RecordOutcome, figures};
use crate::overlay::{Difference, Laid, differences, sentence, table, write};

/// The points, their differences from each branch beside them, and the conclusion in a sentence.
pub struct Against(Vec<(Laid, Vec<Difference>, String)>);

impl Against {
    /// Compares the points that records gave.
    pub fn new(outcomes: &[RecordOutcome], beside: &[Laid]) -> Self {
        let found: Vec<&RecordExtraction> =
            outcomes.iter().filter_map(|outcome| outcome.result.as_ref().ok()).collect();
        let Some(test) = figures::measured(&found) else { return Self(Vec::new()) };
        let one = |other: &Laid| {
            let label = format!("test over {}", other.branch.label.trim_start_matches("computed: "));
            let laid = Laid { branch: ModalBranch { label, ..test.clone() }, is_scattered: true };
            let found = differences(&laid, &other.branch);
            // The name of the points says already what they lie over.
            let said = sentence(&laid, &found, &ModalBranch { label: String::new(), ..other.branch.clone() });
            (laid, found, said)
        };
        Self(beside.iter().map(one).collect())
    }

    /// Writes `overlay.csv`, where there is anything to compare.
    ///
    /// # Errors
    /// [`ReportError::Io`].
    pub fn write(&self, directory: &Path) -> Result<(), ReportError> {
        let all = self.0.iter().map(|(laid, found, _)| (laid, found.as_slice()));
        if self.0.is_empty() { Ok(()) } else { write(&directory.join("overlay.csv"), all) }
    }

    /// Softer or stiffer, a sentence for each branch.
    pub fn sentences(&self) -> impl Iterator<Item = String> {
        self.0.iter().map(|(_, _, said)| said.clone())
    }

    /// The differences, a table for each branch.
    pub fn tables(&self) -> Vec<DataTable> {
        self.0.iter().map(|(laid, found, _)| table(laid, found)).collect()
    }

    /// Number of points and largest difference in Hz, for each branch.
    pub fn in_numbers(&self) -> Value {
        let off = |d: &Difference| (d.frequency - d.own_frequency).abs();
        let one = |(laid, found, _): &(Laid, Vec<Difference>, String)| {
            json!({
                "label": laid.branch.label,
                "points": found.len(),
                "largest_difference_hz": found.iter().map(off).reduce(f64::max),
            })
        };
        self.0.iter().map(one).collect()
    }
}

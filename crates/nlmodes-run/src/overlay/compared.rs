//! What is laid over a branch, or what points of a test are laid over, in figures and on the page.

use std::path::Path;

use nlmodes::modal::ModalBranch;
use nlmodes::report::{DataTable, ReportError};
use serde_json::{Value, json};

use super::{
    Difference, Laid, StopChange, at_equal_frequency, changes, differences, lines, sentence,
    sentence_at_equal_frequency, stops_table, table, write, write_stops,
};
use crate::curve::{Curve, stops};

/// Other results and their differences from the first branch.
pub struct Overlaid {
    compared: Vec<Compared>,
    /// Name of the first branch, if there are others.
    first: String,
    /// Names of its stops.
    stops: Vec<String>,
}

/// One of them: at equal modal amplitude or energy, and at equal frequency.
struct Compared {
    laid: Laid,
    at_size: Vec<Difference>,
    at_frequency: Vec<Difference>,
    changes: Vec<Vec<StopChange>>,
    /// Softer or stiffer.
    sentence: String,
}

impl Compared {
    fn new(laid: &Laid, first: &ModalBranch) -> Self {
        let (at_size, at_frequency) = (differences(laid, first), at_equal_frequency(laid, first));
        let changes = vec![changes(&at_size), changes(&at_frequency)];
        let sentence = sentence(laid, &at_size, first);
        Self { laid: laid.clone(), at_size, at_frequency, changes, sentence }
    }
}

impl Overlaid {
    /// Compares them with the first branch.
    pub fn new(laid: &[Laid], first: &dyn Curve) -> Self {
        let compared = laid.iter().map(|laid| Compared::new(laid, first.branch())).collect();
        Self { compared, first: first.branch().label.clone(), stops: stops::names(first) }
    }

    /// The other branches of a run against its first one.
    pub fn others(all: &[&dyn Curve]) -> Self {
        let Some((first, others)) = all.split_first() else {
            return Self { compared: Vec::new(), first: String::new(), stops: Vec::new() };
        };
        let laid = |curve: &&dyn Curve| Laid { branch: curve.branch().clone(), is_scattered: false };
        Self::new(&others.iter().map(laid).collect::<Vec<_>>(), *first)
    }

    /// The points of records or of a test against each of the branches beside them.
    pub fn of_test(test: Option<&ModalBranch>, beside: &[Laid]) -> Self {
        let one = |(test, other): (&ModalBranch, &Laid)| {
            let label = format!("test over {}", other.branch.label.trim_start_matches("computed: "));
            let laid = Laid { branch: ModalBranch { label, ..test.clone() }, is_scattered: true };
            let at_size = differences(&laid, &other.branch);
            // The name of the points says already what they lie over.
            let sentence = sentence(&laid, &at_size, &ModalBranch { label: String::new(), ..other.branch.clone() });
            Compared { laid, at_size, at_frequency: Vec::new(), changes: Vec::new(), sentence }
        };
        let pairs = test.into_iter().flat_map(|test| beside.iter().map(move |other| (test, other)));
        Self { compared: pairs.map(one).collect(), first: String::new(), stops: Vec::new() }
    }

    /// Number of points and largest difference in Hz, for each of them.
    pub fn in_numbers(&self) -> Value {
        let off = |d: &Difference| (d.frequency - d.own_frequency).abs();
        let one = |one: &Compared| {
            json!({
                "label": one.laid.branch.label,
                "points": one.at_size.len(),
                "largest_difference_hz": one.at_size.iter().map(off).reduce(f64::max),
            })
        };
        self.compared.iter().map(one).collect()
    }

    /// Writes the differences as `NAME.csv`, and those of each stop as `NAME_stops.csv`, where there is anything laid
    /// over.
    ///
    /// # Errors
    /// [`ReportError::Io`].
    pub fn write(&self, directory: &Path, name: &str) -> Result<(), ReportError> {
        if self.compared.is_empty() {
            return Ok(());
        }
        let all = self.compared.iter().map(|one| (&one.laid, one.at_size.as_slice()));
        write(&directory.join(format!("{name}.csv")), all)?;
        if self.compared.iter().all(|one| one.changes.iter().all(Vec::is_empty)) {
            return Ok(());
        }
        let all = self
            .compared
            .iter()
            .flat_map(|one| [&one.at_size, &one.at_frequency].map(|found| (&one.laid, found.as_slice())));
        write_stops(&directory.join(format!("{name}_stops.csv")), all)
    }

    /// The branches that are laid over.
    pub fn branches(&self) -> impl Iterator<Item = &ModalBranch> {
        self.compared.iter().map(|one| &one.laid.branch)
    }

    /// Numbers of those without lines, after `before` others.
    pub fn scattered(&self, before: usize) -> Vec<usize> {
        let all = self.compared.iter().enumerate();
        all.filter(|(_, one)| one.laid.is_scattered).map(|(number, _)| before + number).collect()
    }

    /// Softer or stiffer, and what differs at equal frequency, in sentences.
    pub fn sentences(&self) -> impl Iterator<Item = String> {
        self.compared.iter().flat_map(|one| {
            let at_frequency = sentence_at_equal_frequency(&one.laid, &one.at_frequency, &self.first);
            let at_frequency = at_frequency.map(|text| match one.changes.iter().all(Vec::is_empty) {
                true => text,
                false => format!("{text}; stop by stop: table \"Impulse of each stop\""),
            });
            [one.sentence.clone()].into_iter().chain(at_frequency)
        })
    }

    /// The sentences, and a line for each stop below each.
    pub fn lines(&self) -> Vec<String> {
        let of = |one: &Compared| {
            let stops = lines(&one.changes, &self.stops).into_iter().map(|line| format!("  {line}"));
            [one.sentence.clone()].into_iter().chain(stops).collect::<Vec<_>>()
        };
        self.compared.iter().flat_map(of).collect()
    }

    /// The differences, those of each stop and those of points.
    pub fn tables(&self) -> impl Iterator<Item = DataTable> {
        self.compared.iter().flat_map(|one| {
            let stops = stops_table(&one.laid, &one.changes, (&self.stops, &self.first));
            [stops, table(&one.laid, &one.at_size)]
        })
    }
}

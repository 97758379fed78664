//! Meaning of every results file, its columns and arrays: the single source for the tables themselves, for the command
//! line and for the documentation page.

use std::fmt::Write;

mod differences;
mod files;
mod follow;
mod gradients;
mod points;
mod records;
mod row;
mod transient;

pub use differences::{DifferenceRow, ResponseDifferenceRow, StopDifferenceRow};
pub use files::FILES;
pub use follow::FollowRow;
pub use gradients::{GRADIENT_COLUMNS, GradientCells, GradientColumns};
pub use points::{AppropriationRow, BranchRow, ContactRow, ParticipationRow, ResponseOf, ResponseRow};
pub use records::{DecayRow, HarmonicDampingRow, ModalPointRow};
pub use row::{Cell, Cells, Known, Numbered, Row, Sometimes};
pub use transient::TouchRow;

/// A column of a table, an array of an archive, or a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    /// Its name; `…` is a number, `<key>` the key of a parameter.
    pub name: &'static str,
    /// Its unit, empty if dimensionless; for arrays after their shape.
    pub unit: &'static str,
    /// Its meaning, with sign and normalisation.
    pub meaning: &'static str,
}

impl Column {
    /// A column.
    pub const fn new(name: &'static str, unit: &'static str, meaning: &'static str) -> Self {
        Self { name, unit, meaning }
    }

    /// Whether a name in a file belongs to this column.
    pub fn is_named(&self, name: &str) -> bool {
        match self.name.split_once('…') {
            Some((begin, end)) => {
                let middle = name.strip_prefix(begin).and_then(|rest| rest.strip_suffix(end));
                middle.is_some_and(|number| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()))
            }
            None => match self.name.strip_suffix("<key>") {
                Some(begin) => name.strip_prefix(begin).is_some_and(|key| !key.is_empty()),
                None => name == self.name,
            },
        }
    }
}

/// A file of results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileMeaning {
    /// Its name; `…` is a number.
    pub name: &'static str,
    /// Its contents, and when it is written.
    pub meaning: &'static str,
    /// Its columns, arrays or variables.
    pub columns: &'static [&'static [Column]],
}

impl FileMeaning {
    /// All of its columns.
    pub fn all_columns(&self) -> impl Iterator<Item = &'static Column> {
        self.columns.iter().copied().flatten()
    }
}

/// All files as plain text, for a terminal.
pub fn text() -> String {
    let mut text = String::new();
    for file in &FILES {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}\n    {}", file.name, file.meaning);
        let names = file.all_columns().map(|column| column.name.chars().count());
        let width = names.max().unwrap_or(0);
        for column in file.all_columns() {
            let unit = if column.unit.is_empty() { String::new() } else { format!("[{}] ", column.unit) };
            let padding = " ".repeat(width - column.name.chars().count());
            let _ = writeln!(text, "    {}{padding}  {unit}{}", column.name, column.meaning);
        }
        text.push('\n');
    }
    text
}

/// All files as Markdown, for the documentation.
pub fn markdown() -> String {
    let mut text = String::from(INTRODUCTION);
    for file in &FILES {
        let _ = writeln!(text, "\n## `{}`\n\n{}.", file.name, file.meaning);
        if file.all_columns().next().is_none() {
            continue;
        }
        text += "\n| name | unit | meaning |\n| --- | --- | --- |\n";
        for column in file.all_columns() {
            let _ = writeln!(text, "| `{}` | {} | {} |", column.name, column.unit, column.meaning.replace('|', "\\|"));
        }
    }
    text
}

const INTRODUCTION: &str = "\
# Files, columns and arrays

What a run writes, name by name; `nlmodes-cli columns` prints the same. Everything is in SI units. Points are numbered \
    from 0 in the order of the
branch, stops from 0 in the order of the scene (`contact.0.gap_m` on the command line is stop 0), modes and harmonics \
    from 1 (harmonic 0 is the
mean). `…` is a number. A motion is `q(t) = Re Σ_n q_n e^{inωt}`, n = 0 to the number of harmonics; \
    displacements are positive along the
axis of the structure (axial) or to its positive side (deflection), contact forces positive away from the stop.

`docs/scripts/plot_results.m` (MATLAB, Octave) and `docs/scripts/plot_results.py` (NumPy, Matplotlib, SciPy) read \
    `results.mat` and draw frequency
over energy with the events, as in Fig. 3 b of Peter et al. (2019), and the contact forces of one period.
";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbered_names_are_recognised_and_others_are_not() {
        let column = Column::new("participation_…", "", "");
        assert!(column.is_named("participation_1") && column.is_named("participation_12"));
        assert!(!column.is_named("participation_") && !column.is_named("participation_x"));
        assert!(Column::new("point", "", "").is_named("point"));
        let column = Column::new("d_peak_d_<key>", "", "");
        assert!(column.is_named("d_peak_d_contact.0.gap_m") && !column.is_named("d_peak_d_"));
    }

    #[test]
    fn every_name_is_explained_once_in_its_file() {
        for file in &FILES {
            let names: Vec<&str> = file.all_columns().map(|column| column.name).collect();
            assert!(names.iter().enumerate().all(|(k, name)| !names[..k].contains(name)), "{}", file.name);
            assert!(file.all_columns().all(|column| !column.meaning.is_empty() && !column.meaning.ends_with('.')));
        }
    }
}

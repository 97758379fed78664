//! Meaning of every results file, its columns and arrays: the single source for the tables themselves, for the command
//! line and for the documentation page.

use std::fmt::Write;

mod files;
mod records;

pub use files::FILES;
pub use records::MODAL_POINT_COLUMNS;

/// A column of a table, an array of an archive, or a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    /// Its name; `…` is a number.
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
            None => name == self.name,
        }
    }
}

/// Columns of the table of differences of responses.
pub const RESPONSE_DIFFERENCE_COLUMNS: [Column; 10] = [
    Column::new("overlay", "", "name of what is laid over"),
    Column::new("point", "", "its point, from 0"),
    Column::new("frequency_hz", "Hz", "frequency of the load, of both"),
    Column::new("level", "unit of the load", "level of the point; NaN where the table has none"),
    Column::new("fundamental_m", "m", "fundamental of the first contact; NaN where it is not known"),
    Column::new("curve_fundamental_m", "m", "that of the curve there, linear between its points"),
    Column::new("drive_fundamental_m", "m", "fundamental of the drive point; NaN where it is not known"),
    Column::new("curve_drive_fundamental_m", "m", "that of the curve there"),
    Column::new("peak_contact_force_n", "N", "largest contact force; NaN where it is not known"),
    Column::new("curve_peak_contact_force_n", "N", "that of the curve there"),
];

/// Columns of `overlay.csv`.
pub const DIFFERENCE_COLUMNS: [Column; 12] = [
    Column::new("overlay", "", "name of what is laid over"),
    Column::new("point", "", "its point, from 0"),
    Column::new("modal_amplitude", "m √kg", "modal amplitude of both; NaN where energies are equal"),
    Column::new("energy_j", "J", "averaged kinetic energy of both; NaN where amplitudes are equal"),
    Column::new("frequency_hz", "Hz", "frequency of the point"),
    Column::new("branch_frequency_hz", "Hz", "frequency of the branch there, linear between its points"),
    Column::new(
        "relative_difference",
        "",
        "the first over the second, minus one; negative where the overlay is softer",
    ),
    Column::new("peak_contact_force_n", "N", "largest contact force of the point; NaN where it is not known"),
    Column::new("branch_peak_contact_force_n", "N", "that of the branch there"),
    Column::new(
        "impulse_ns",
        "N·s",
        "integral of all contact forces over a period at the point; NaN where it is not known",
    ),
    Column::new("branch_impulse_ns", "N·s", "that of the branch there"),
    Column::new(
        "motions",
        "",
        "motions of this amplitude, or energy, that one of the two has; with more than one, as at an internal resonance, the nearest in frequency is given, may be on another half-branch, and is not in the median; of measured points the one whose difference is most like that of points with one motion, which is in the median",
    ),
];

/// Columns of `overlay_stops.csv` and `methods_stops.csv`.
pub const STOP_DIFFERENCE_COLUMNS: [Column; 10] = [
    Column::new("overlay", "", "name of what is laid over"),
    Column::new("point", "", "its point, from 0"),
    Column::new("contact", "", "number of the stop, from 0 in the order of the scene"),
    Column::new(
        "equal",
        "",
        "what both motions have in common: `modal amplitude`, `energy` where there are no amplitudes, or `frequency`; each point is listed for both comparisons",
    ),
    Column::new("frequency_hz", "Hz", "frequency of the point"),
    Column::new("branch_frequency_hz", "Hz", "frequency of the branch there, linear between its points"),
    Column::new("impulse_ns", "N·s", "integral of the force of this stop over a period at the point"),
    Column::new("branch_impulse_ns", "N·s", "that of the branch there"),
    Column::new(
        "relative_difference",
        "",
        "the first over the second, minus one; NaN where the branch has no impulse there",
    ),
    Column::new(
        "motions",
        "",
        "motions with this in common that one of the two has; with more than one the nearest is given, may be on another half-branch, and is not in the median",
    ),
];

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

What a run writes, name by name; `nlmodes-cli columns` prints the same. Everything is in SI units. Points are numbered from 0 in the order of the
branch, stops from 0 in the order of the scene (`contact.0.gap_m` on the command line is stop 0), modes and harmonics from 1 (harmonic 0 is the
mean). `…` stands for a number. A motion is `q(t) = Re Σ_n q_n e^{inωt}`, n = 0 to the number of harmonics; displacements are positive along the
axis of the structure (axial) or to its positive side (deflection), contact forces positive away from the stop.

`docs/scripts/plot_results.m` (MATLAB, Octave) and `docs/scripts/plot_results.py` (NumPy, Matplotlib, SciPy) read `results.mat` and draw frequency
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

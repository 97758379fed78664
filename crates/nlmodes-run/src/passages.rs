//! Results at a frequency or an energy: every passage of every branch and curve, with the quantities of each stop.

mod between;
mod read;
mod text;

use std::path::{Path, PathBuf};

use serde::Serialize;
use thiserror::Error;

use crate::overlay::OverlayError;
pub use text::text;

/// The quantity at which results are requested.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Abscissa {
    /// Frequency, Hz.
    FrequencyHz,
    /// Averaged kinetic energy, J.
    EnergyJ,
}

/// A stop over a period.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StopValues {
    /// Number of the stop.
    pub contact: usize,
    /// Share of the period in which it is touched.
    pub contact_fraction: f64,
    /// Integral of its force over the period, N s.
    pub impulse_ns: f64,
    /// Its mean force, N.
    pub mean_force_n: f64,
    /// Its largest force, N.
    pub peak_force_n: f64,
    /// Largest speed at which its gap closes, m/s.
    pub approach_velocity_m_s: f64,
    /// Closed intervals of a period at the points on both sides.
    pub touches: [usize; 2],
}

/// Where a branch passes the value: values between two points, interpolated along the branch, or those of a point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Passage {
    /// The points on both sides, by their numbers; twice the same where one lies there.
    pub points: [usize; 2],
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Averaged kinetic energy, J.
    pub energy_j: f64,
    /// Modal amplitude, m √kg.
    pub modal_amplitude: f64,
    /// Largest displacement at stop 0, m.
    pub peak_m: f64,
    /// Level of the load, of a response.
    pub level: Option<f64>,
    /// Its unit, where the table has a column of that load.
    pub level_unit: Option<&'static str>,
    /// Stability at the points on both sides, where it was found out.
    pub stable: [Option<bool>; 2],
    /// Events at the points on both sides, as in `branch.csv`.
    pub events: [String; 2],
    /// Each stop, in the order of the scene; empty where the results have no `contacts.csv`, or that lacks these
    /// points.
    pub contacts: Vec<StopValues>,
}

/// Whether a curve passes the value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    /// It does, once or several times.
    Passed,
    /// The value lies only where something was left out.
    LeftOut,
    /// It does not.
    NotPassed,
}

/// A branch, or a curve of a response.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// Its table.
    pub table: PathBuf,
    /// Which curve of that table, where there are several.
    pub name: Option<String>,
    /// Number of its points.
    pub points: usize,
    /// Least and largest value of its points.
    pub range: [f64; 2],
    /// Whether it passes the value.
    pub answer: Answer,
    /// Whether there is a `contacts.csv` for the table.
    pub has_contacts: bool,
    /// Numbers of points between which something was left out and the value lies.
    pub left_out: Vec<[usize; 2]>,
    /// All passages, in the order of the branch.
    pub passages: Vec<Passage>,
    /// Text of the verification report on its numbers; empty if there is none.
    pub verdict: String,
}

/// Why there is no result.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PassageError {
    /// There is no such file or directory.
    #[error("there is no {}", .0.display())]
    NothingThere(PathBuf),
    /// There is no table of a branch.
    #[error("no branch.csv in {} or below it; expected a directory that `run` has written", .0.display())]
    NoBranch(PathBuf),
    /// The value is none.
    #[error("{0} is no {1}; expected a positive number")]
    NotPositive(f64, &'static str),
    /// A table cannot be read.
    #[error(transparent)]
    Table(#[from] OverlayError),
}

/// The curves with all their data, as JSON; unknown values are `null`.
pub fn json(curves: &[Curve]) -> String {
    format!("{:#}", serde_json::json!(curves))
}

/// Every curve in a directory of results and below it, with all its passages through the value.
///
/// # Errors
/// [`PassageError`].
pub fn passages(results: &Path, abscissa: Abscissa, value: f64) -> Result<Vec<Curve>, PassageError> {
    if !(value.is_finite() && value > 0.0) {
        let name = match abscissa {
            Abscissa::FrequencyHz => "frequency in Hz",
            Abscissa::EnergyJ => "energy in J",
        };
        return Err(PassageError::NotPositive(value, name));
    }
    if !results.exists() {
        return Err(PassageError::NothingThere(results.to_path_buf()));
    }
    let tables = read::tables(results);
    if tables.is_empty() {
        return Err(PassageError::NoBranch(results.to_path_buf()));
    }
    let mut curves = Vec::new();
    for table in &tables {
        let verdict = read::verdict(table);
        let has_contacts = crate::overlay::contacts_of(table).is_some();
        for (name, rows) in read::curves(table, abscissa)? {
            let (passages, left_out) = between::passages(&rows, abscissa, value);
            let all = rows.iter().map(|row| row.value(abscissa));
            let range = all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
            let (table, verdict, points) = (table.clone(), verdict.clone(), rows.len());
            let answer = match (passages.is_empty(), left_out.is_empty()) {
                (false, _) => Answer::Passed,
                (true, false) => Answer::LeftOut,
                (true, true) => Answer::NotPassed,
            };
            curves.push(Curve { table, name, points, range, answer, has_contacts, left_out, passages, verdict });
        }
    }
    Ok(curves)
}

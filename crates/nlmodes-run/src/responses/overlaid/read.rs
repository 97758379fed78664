//! Tables of responses.

use std::path::{Path, PathBuf};

use nlmodes::report::LineKind;
use nlmodes_scene::scene::Overlay;

use super::{LaidCurve, LaidPoint};
use crate::overlay::OverlayError;

/// Table of a folder of results.
const TABLE: &str = "branch.csv";
/// Most rows that are read.
const MOST_ROWS: usize = 1_000_000;

/// The curves of a table, one for each of its columns `response` and `curve` where it has these.
pub(super) fn curves(overlay: &Overlay) -> Result<Vec<LaidCurve>, OverlayError> {
    let path = if overlay.path.is_dir() { overlay.path.join(TABLE) } else { overlay.path.clone() };
    if overlay.path.is_dir() && !path.is_file() {
        return Err(OverlayError::NoResponses(overlay.path.clone()));
    }
    let failed = |source| OverlayError::Table { path: path.clone(), source };
    let mut table = csv::Reader::from_path(&path).map_err(failed)?;
    let head = table.headers().map_err(failed)?.clone();
    let columns = Columns::of(&head, &path)?;
    let is_computed = path.ends_with(TABLE);
    let mut all: Vec<((String, String), LaidCurve)> = Vec::new();
    let mut number = 0;
    for (count, row) in table.records().enumerate() {
        if count == MOST_ROWS {
            return Err(OverlayError::TooManyRows(path));
        }
        let row = row.map_err(failed)?;
        let kind = match columns.text(&row, columns.kind).as_str() {
            "" | "frequency" if is_computed => LineKind::Response,
            "" | "frequency" => LineKind::Measured,
            "phase-resonance" => LineKind::Resonance,
            "damped-mode" => LineKind::DampedMode,
            "mode" => LineKind::Mode,
            // Those over the level, and forces that appropriate a mode, are no curves over the frequency.
            _ => continue,
        };
        let point = columns.point(&row, number, &path)?;
        let Some(point) = point else { continue };
        number += 1;
        let of = (columns.text(&row, columns.response), columns.text(&row, columns.curve));
        if all.last().is_none_or(|(before, _)| *before != of) {
            let name = match columns.text(&row, columns.name) {
                name if name.is_empty() => overlay.label.clone(),
                name => format!("{}: {name}", overlay.label),
            };
            all.push((of, LaidCurve { name, kind, points: Vec::new() }));
        }
        if let Some((_, curve)) = all.last_mut() {
            curve.points.push(point);
        }
    }
    if number == 0 {
        return Err(OverlayError::NoPoint(path));
    }
    Ok(all.into_iter().map(|(_, curve)| curve).collect())
}

/// Where the quantities stand in a row.
struct Columns {
    frequency: usize,
    level: Option<usize>,
    fundamental: Option<usize>,
    drive: Option<usize>,
    lag: Option<usize>,
    force: Option<usize>,
    response: Option<usize>,
    curve: Option<usize>,
    kind: Option<usize>,
    name: Option<usize>,
}

impl Columns {
    fn of(head: &csv::StringRecord, path: &Path) -> Result<Self, OverlayError> {
        let column = |name: &str| head.iter().position(|column| column.trim() == name);
        let missing = |column| OverlayError::NoColumn { path: PathBuf::from(path), column };
        let found = Self {
            frequency: column("frequency_hz").ok_or_else(|| missing("frequency_hz"))?,
            level: column("level"),
            fundamental: column("fundamental_m"),
            drive: column("drive_fundamental_m"),
            lag: column("drive_lag_deg"),
            force: column("peak_contact_force_n"),
            response: column("response"),
            curve: column("curve"),
            kind: column("kind"),
            name: column("name"),
        };
        match found.fundamental.or(found.drive) {
            Some(_) => Ok(found),
            None => Err(missing("fundamental_m or drive_fundamental_m")),
        }
    }

    fn text(&self, row: &csv::StringRecord, column: Option<usize>) -> String {
        column.and_then(|column| row.get(column)).unwrap_or_default().trim().to_owned()
    }

    /// The point of a row; `None` without a frequency.
    fn point(&self, row: &csv::StringRecord, number: usize, path: &Path) -> Result<Option<LaidPoint>, OverlayError> {
        let value = |name, column| crate::overlay::number(row, column, name, path);
        let point = LaidPoint {
            number,
            frequency: value("frequency_hz", Some(self.frequency))?,
            level: value("level", self.level)?,
            // Of a nonlinear mode it has the sign of its phase.
            fundamental: value("fundamental_m", self.fundamental)?.abs(),
            drive: value("drive_fundamental_m", self.drive)?.abs(),
            lag: value("drive_lag_deg", self.lag)?,
            force: value("peak_contact_force_n", self.force)?,
        };
        Ok(Some(point).filter(|point| point.frequency > 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn read_table(name: &str, text: &str) -> Result<Vec<LaidCurve>, OverlayError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        curves(&Overlay { path, label: "test".into() })
    }

    #[test]
    fn a_table_of_results_has_a_curve_for_each_level_and_a_measured_one_has_points() {
        let text = "frequency_hz,fundamental_m,response,curve,name,level,kind\n40,1e-3,1,1,4 N,4,frequency\n41,-2e-3,1,1,4 N,4,frequency\n,,,,,,\n40,2e-3,2,1,mode,,mode\n40,9,3,1,up,2,force\n";
        let found = read_table("branch.csv", text).unwrap();
        assert_eq!(
            found.iter().map(|c| (c.name.as_str(), c.kind, c.points.len())).collect::<Vec<_>>(),
            [("test: 4 N", LineKind::Response, 2), ("test: mode", LineKind::Mode, 1)]
        );
        assert_eq!((found[0].points[1].fundamental, found[1].points[0].number), (2e-3, 2));
        let found = read_table("rig.csv", "frequency_hz,drive_fundamental_m\n40,1e-3\n").unwrap();
        assert_eq!((found[0].kind, found[0].name.as_str()), (LineKind::Measured, "test"));
        let error = read_table("rig.csv", "frequency_hz,amplitude\n40,1e-3\n").unwrap_err();
        assert!(error.to_string().contains("fundamental_m or drive_fundamental_m"), "{error}");
        let error = read_table("rig.csv", "frequency_hz,fundamental_m\n40,1e-3\n41,abc\n").unwrap_err();
        assert!(error.to_string().contains("line 3: fundamental_m is \"abc\", expected a number"), "{error}");
        assert!(matches!(read_table("rig.csv", "frequency_hz,fundamental_m\n,\n"), Err(OverlayError::NoPoint(_))));
    }
}

//! Tables of responses.

use nlmodes::report::LineKind;
use nlmodes::report::columns::{BranchRow, ResponseRow};
use nlmodes_scene::scene::Overlay;

use super::{LaidCurve, LaidPoint};
use crate::overlay::{NO_FREQUENCY, OverlayError, Unused};
use crate::sheet::Sheet;

/// Table of a folder of results.
const TABLE: &str = "branch.csv";
/// Most rows that are read.
const MOST_ROWS: usize = 1_000_000;

/// The curves of a table, one for each of its columns `response` and `curve` where it has these, and the rows that are
/// not used.
pub(super) fn curves(overlay: &Overlay) -> Result<(Vec<LaidCurve>, Unused), OverlayError> {
    let path = if overlay.path.is_dir() { overlay.path.join(TABLE) } else { overlay.path.clone() };
    if overlay.path.is_dir() && !path.is_file() {
        return Err(OverlayError::NoResponses(overlay.path.clone()));
    }
    let mut table = Sheet::open(&path)?;
    table.needed("frequency_hz")?;
    if table.column("fundamental_m").or(table.column("drive_fundamental_m")).is_none() {
        return Err(table.missing("fundamental_m or drive_fundamental_m").into());
    }
    let (own, beside) = (table.places::<BranchRow>(), table.places::<ResponseRow>());
    let is_computed = path.ends_with(TABLE);
    let mut all: Vec<((usize, usize), LaidCurve)> = Vec::new();
    let (mut number, mut unused) = (0, Unused::default());
    while let Some(row) = table.row()? {
        unused.rows += 1;
        if unused.rows > MOST_ROWS {
            return Err(OverlayError::TooManyRows(path));
        }
        let (read, response): (BranchRow, ResponseRow) = (table.read(&row, &own)?, table.read(&row, &beside)?);
        let kind = match response.kind.as_str() {
            "" | "frequency" if is_computed => LineKind::Response,
            "" | "frequency" => LineKind::Measured,
            "phase-resonance" => LineKind::Resonance,
            "damped-mode" => LineKind::DampedMode,
            "mode" => LineKind::Mode,
            // Those over the level, and forces that appropriate a mode, are no curves over the frequency.
            _ => {
                unused.add("of kinds that are no curves over the frequency", row.line);
                continue;
            }
        };
        let Some(point) = point(&read, &response, number) else {
            unused.add(NO_FREQUENCY, row.line);
            continue;
        };
        number += 1;
        let of = (response.response, response.curve);
        if all.last().is_none_or(|(before, _)| *before != of) {
            let name = match response.name.as_str() {
                "" => overlay.label.clone(),
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
    Ok((all.into_iter().map(|(_, curve)| curve).collect(), unused))
}

/// The point of a row; `None` without a frequency.
fn point(own: &BranchRow, response: &ResponseRow, number: usize) -> Option<LaidPoint> {
    let known = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let point = LaidPoint {
        number,
        frequency: own.frequency_hz,
        level: known(response.level),
        // Of a nonlinear mode it has the sign of its phase.
        fundamental: own.fundamental_m.abs(),
        drive: known(response.drive_fundamental_m).abs(),
        lag: known(response.drive_lag_deg),
        force: own.peak_contact_force_n,
    };
    Some(point).filter(|point| point.frequency > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn read_table(name: &str, text: &str) -> Result<(Vec<LaidCurve>, Unused), OverlayError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        curves(&Overlay { path, label: "test".into() })
    }

    #[test]
    fn a_table_of_results_has_a_curve_for_each_level_and_a_measured_one_has_points() {
        let text = "frequency_hz,fundamental_m,response,curve,name,level,kind\n40,1e-3,1,1,4 N,4,frequency\n41,-2e-3,1,1,4 N,4,frequency\n,,,,,,\n40,2e-3,2,1,mode,,mode\n40,9,3,1,up,2,force\n";
        let (found, unused) = read_table("branch.csv", text).unwrap();
        let said = unused.sentence("branch.csv".as_ref()).unwrap();
        let wanted = "branch.csv: 2 of 5 rows are not used: 1 without a frequency above 0 Hz (line 4), 1 of kinds that are no curves over the frequency (line 6)";
        assert_eq!(said, wanted);
        assert_eq!(
            found.iter().map(|c| (c.name.as_str(), c.kind, c.points.len())).collect::<Vec<_>>(),
            [("test: 4 N", LineKind::Response, 2), ("test: mode", LineKind::Mode, 1)]
        );
        assert_eq!((found[0].points[1].fundamental, found[1].points[0].number), (2e-3, 2));
        let (found, _) = read_table("rig.csv", "frequency_hz,drive_fundamental_m\n40,1e-3\n").unwrap();
        assert_eq!((found[0].kind, found[0].name.as_str()), (LineKind::Measured, "test"));
        let error = read_table("rig.csv", "frequency_hz,amplitude\n40,1e-3\n").unwrap_err();
        assert!(error.to_string().contains("fundamental_m or drive_fundamental_m"), "{error}");
        let error = read_table("rig.csv", "frequency_hz,fundamental_m\n40,1e-3\n41,abc\n").unwrap_err();
        assert!(error.to_string().contains("line 3: fundamental_m is \"abc\", expected a number"), "{error}");
        assert!(matches!(read_table("rig.csv", "frequency_hz,fundamental_m\n,\n"), Err(OverlayError::NoPoint(_))));
    }
}

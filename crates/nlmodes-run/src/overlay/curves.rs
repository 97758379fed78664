//! Curves of damped and forced motions that are laid over: those of a table of responses, or measured points.

use std::f64::consts::TAU;

use nlmodes::modal::{BranchEnd, Driven, ModalBranch, ModalPoint};
use nlmodes::report::LineKind;
use nlmodes::report::columns::{BranchRow, ResponseRow};
use nlmodes_scene::scene::Overlay;
use num_complex::Complex64;

use super::read::{Points, TABLES, table as table_of};
use super::{OverlayError, Unused};

/// A curve, or measured points, that are laid over.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LaidCurve {
    /// Points that nothing joins, or a curve of a computation.
    pub kind: LineKind,
    /// The points, with their name; what the table does not say is NaN.
    pub branch: ModalBranch,
    /// Number of the first of them among the rows with a frequency.
    pub first: usize,
    /// Whether lags are known.
    pub has_lag: bool,
    /// Whether they are points of a test, whose levels are the amplitudes of its force.
    pub is_test: bool,
}

/// The curves of a table, one for each of its columns `response` and `curve` where it has these, and the rows that are
/// not used.
pub(crate) fn curves(overlay: &Overlay) -> Result<(Vec<LaidCurve>, Unused), OverlayError> {
    let path = table_of(&overlay.path)?;
    let either = ["fundamental_m", "drive_fundamental_m"];
    let mut table = Points::open(path.clone(), either, "fundamental_m or drive_fundamental_m")?;
    let beside = table.sheet.places::<ResponseRow>();
    // A test names the lag of its drive point otherwise, and its level is the amplitude of its force.
    let lag = table.sheet.column("lag_deg");
    let [is_computed, is_test] = TABLES.map(|name| path.ends_with(name));
    let has_lag = lag.is_some() || table.sheet.column("drive_lag_deg").is_some();
    let mut all: Vec<((usize, usize), LaidCurve)> = Vec::new();
    let mut number = 0;
    while let Some(row) = table.row()? {
        let mut response: ResponseRow = table.sheet.read(&row, &beside)?;
        response.drive_lag_deg = response.drive_lag_deg.or_else(|| row.text(lag).parse().ok());
        response.level = response.level.or(response.force_n.filter(|_| is_test));
        let kind = match response.kind.as_str() {
            "" | "frequency" if is_computed => LineKind::Response,
            "" | "frequency" => LineKind::Measured,
            "phase-resonance" => LineKind::Resonance,
            "damped-mode" => LineKind::DampedMode,
            "mode" => LineKind::Mode,
            // Those over the level, and forces that appropriate a mode, are no curves over the frequency.
            _ => {
                table.unused.add("of kinds that are no curves over the frequency", row.line);
                continue;
            }
        };
        let Some(read) = table.point(&row)? else { continue };
        let of = (response.response, response.curve);
        if all.last().is_none_or(|(before, _)| *before != of) {
            let label = match response.name.as_str() {
                "" => overlay.label.clone(),
                name => format!("{}: {name}", overlay.label),
            };
            let end = BranchEnd::given(format!("from {}", path.display()));
            let branch = ModalBranch::of_points(label, Vec::new(), end);
            all.push((of, LaidCurve { kind, branch, first: number, has_lag, is_test }));
        }
        number += 1;
        if let Some((_, curve)) = all.last_mut() {
            curve.branch.points.push(point(read, &response));
        }
    }
    if number == 0 {
        return Err(OverlayError::NoPoint(path));
    }
    Ok((all.into_iter().map(|(_, curve)| curve).collect(), table.unused))
}

/// The point of a row.
fn point(own: BranchRow, response: &ResponseRow) -> ModalPoint {
    let (drive, lag) = (response.drive_fundamental_m, response.drive_lag_deg.unwrap_or(0.0));
    let driven = Driven {
        omega: TAU * own.frequency_hz,
        level: Some(response.level.unwrap_or(f64::NAN)),
        force: response.force_n,
        drive: drive.map(|drive| Complex64::from_polar(drive.abs(), -lag.to_radians())),
        input_power: response.input_power_w,
        dissipated_power: response.dissipated_power_w.unwrap_or(f64::NAN),
        damping_ratio: response.damping_ratio,
        indicator: response.pbmif,
        mode_distance: response.mode_distance,
    };
    ModalPoint { driven: Some(driven), ..own.point(Vec::new()) }
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
        let text = "frequency_hz,fundamental_m,response,curve,name,level,kind\n40,1e-3,1,1,4 \
            N,4,frequency\n41,-2e-3,1,1,4 N,4,frequency\n,,,,,,\n40,2e-3,2,1,mode,,mode\n40,9,3,1,up,2,force\n";
        let (found, unused) = read_table("branch.csv", text).unwrap();
        let said = unused.sentence("branch.csv".as_ref()).unwrap();
        let wanted = "branch.csv: 2 of 5 rows are not used: 1 without a frequency above 0 Hz (line 4), 1 of kinds that \
            are no curves over the frequency (line 6)";
        assert_eq!(said, wanted);
        assert_eq!(
            found.iter().map(|c| (c.branch.label.as_str(), c.kind, c.branch.points.len())).collect::<Vec<_>>(),
            [("test: 4 N", LineKind::Response, 2), ("test: mode", LineKind::Mode, 1)]
        );
        assert_eq!((found[0].branch.points[1].fundamental, found[1].first), (-2e-3, 2));
        let (found, _) = read_table("rig.csv", "frequency_hz,drive_fundamental_m\n40,1e-3\n").unwrap();
        assert_eq!((found[0].kind, found[0].branch.label.as_str()), (LineKind::Measured, "test"));
        let error = read_table("rig.csv", "frequency_hz,amplitude\n40,1e-3\n").unwrap_err();
        assert!(error.to_string().contains("fundamental_m or drive_fundamental_m"), "{error}");
        let error = read_table("rig.csv", "frequency_hz,fundamental_m\n40,1e-3\n41,abc\n").unwrap_err();
        assert!(error.to_string().contains("line 3: fundamental_m is \"abc\", expected a number"), "{error}");
        assert!(matches!(read_table("rig.csv", "frequency_hz,fundamental_m\n,\n"), Err(OverlayError::NoPoint(_))));
    }
}

//! Files of what was followed.

use std::fs;
use std::path::Path;

use nlmodes::report::columns::{FollowRow, Row};
use nlmodes::report::{LineKind, Quantity, ReportError, ResponseFigure, ResponseLine, write_rows, write_summary};

use super::{FollowOutcome, Followed};
use crate::{RunError, links};

impl FollowOutcome {
    /// Writes `follow.csv`, `follow.json` and figures into a directory.
    ///
    /// # Errors
    /// [`RunError`] if one cannot be written.
    pub fn write(&self, directory: &Path) -> Result<(), RunError> {
        links::refuse(directory)?;
        let unwritable =
            |source: ReportError| RunError::Unwritable { directory: directory.to_path_buf(), source, kept: false };
        fs::create_dir_all(directory)
            .map_err(|source| unwritable(ReportError::Io { path: directory.to_path_buf(), source }))?;
        self.files(directory).map_err(unwritable)
    }

    fn files(&self, directory: &Path) -> Result<(), ReportError> {
        let rows = self.curves.iter().enumerate();
        let rows = rows.flat_map(|(curve, of)| of.points.iter().map(move |point| FollowRow { curve, ..point.clone() }));
        write_rows(directory.join("follow.csv"), &FollowRow::unknown(), rows)?;
        write_summary(directory.join("follow.json"), self)?;
        let ordinates: [(&str, Quantity, Ordinate); 3] = [
            ("frequency", Quantity::linear("frequency", "Hz"), |point| point.frequency_hz),
            ("amplitude", Quantity::linear("amplitude", "m"), |point| point.fundamental_m),
            ("force", Quantity::linear("largest contact force", "N"), |point| point.peak_contact_force_n),
        ];
        for (name, ordinate, of) in ordinates {
            let lines: Vec<ResponseLine> = self.curves.iter().map(|curve| line(curve, of)).collect();
            if lines.iter().flat_map(|line| &line.points).all(|point| !(point.1.is_finite() && point.1 != 0.0)) {
                continue;
            }
            let abscissa = Quantity::linear(self.settings.key.clone(), "");
            let figure = ResponseFigure::new(&lines, abscissa, ordinate).title(self.title.clone()).render()?;
            figure.write(directory.join(format!("follow_{name}.svg")))?;
        }
        Ok(())
    }
}

/// What is drawn of a point.
type Ordinate = fn(&FollowRow) -> f64;

fn line(curve: &Followed, of: Ordinate) -> ResponseLine {
    let points = curve.points.iter().map(|point| (point.value, of(point), None)).collect();
    ResponseLine { name: curve.name.clone(), kind: LineKind::Response, points }
}

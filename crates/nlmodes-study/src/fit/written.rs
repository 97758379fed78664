//! Files of a fit: what was found, the points beside the curve, figures.

use std::fs;

use nlmodes::report::SpreadFigure;

use super::FitOutcome;
use crate::curve::Curve;
use crate::error::StudyError;
use crate::figures::plain;
use crate::store::replace;
use crate::study::{Measured, Study};

impl FitOutcome {
    /// Writes `fit.json`, `fit.csv` with the points, and a figure of each column that was fitted.
    ///
    /// # Errors
    /// [`StudyError`] if one cannot be written.
    pub fn write(&self, study: &Study) -> Result<(), StudyError> {
        let directory = &study.directory;
        fs::create_dir_all(directory).map_err(StudyError::io(directory))?;
        let write = |name: &str, bytes: &[u8]| {
            let path = directory.join(name);
            replace(&path, bytes).map_err(StudyError::io(&path))
        };
        write("fit.json", &serde_json::to_vec_pretty(self).unwrap_or_default())?;
        let mut table = "column,place,measured,measured_std,before,fitted\n".to_owned();
        for row in &self.points {
            let std = row.std.map_or_else(String::new, |std| format!("{std:?}"));
            let (column, before) = (&row.column, row.before);
            table += &format!("{column},{:?},{:?},{std},{before:?},{:?}\n", row.place, row.measured, row.fitted);
        }
        write("fit.csv", table.as_bytes())?;
        let Some(measured) = &study.fit else { return Ok(()) };
        for column in &measured.columns {
            if let Some(svg) = self.figure(study, measured, &column.name) {
                write(&format!("fit_{}.svg", plain(&column.name)), svg.as_bytes())?;
            }
        }
        Ok(())
    }

    fn figure(&self, study: &Study, measured: &Measured, column: &str) -> Option<String> {
        let own = self.points.iter().filter(|row| row.column == column);
        let points: Vec<(f64, f64)> = own.map(|row| (row.place, row.measured)).collect();
        let [before, found] = self.curves_at.each_ref().map(|curve| line(curve, measured, column));
        let figure = SpreadFigure::new(&measured.over, column, &points).title(&study.title);
        let figure = figure.middle("fitted", &found).limit("at the start", &before);
        figure.render().ok().map(|figure| figure.as_svg().to_owned())
    }
}

/// The first curve that was measured, as far as the points go.
fn line(curve: &Curve, measured: &Measured, column: &str) -> Vec<(f64, f64)> {
    let parts = curve.parts(measured.response, false);
    let Some(part) = parts.first() else { return Vec::new() };
    let (Some(x), Some(y)) = (part.column(&measured.over), part.column(column)) else { return Vec::new() };
    let [low, high] =
        measured.places.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(*x), b.max(*x)]);
    let within = |x: f64| x >= low - 0.05 * (high - low) && x <= high + 0.05 * (high - low);
    x.iter().zip(y).filter(|(x, y)| within(**x) && y.is_finite()).map(|(x, y)| (*x, *y)).collect()
}

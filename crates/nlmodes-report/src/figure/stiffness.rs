use super::Figure;
use crate::ReportError;
use crate::chart::{Axis, Chart, Curve, LegendEntry, PANEL_HEIGHT, Panel, Scale, Shape, Symbol};
use crate::palette;
use crate::svg::Stroke;
use crate::unit::Unit;
use nlmodes_modal::{ContactStiffness, TimeHistory};

/// Maximum number of samples drawn: more would cover the line.
const MAX_SAMPLES: usize = 120;
/// Range on the open side of the stop, relative to the deepest penetration.
const OPEN_SIDE: f64 = 0.5;

/// Contact force over displacement next to the stop, with the line of the contact stiffness, as in Fig. 7 b.
#[derive(Debug, Clone)]
pub struct StiffnessFigure<'a> {
    history: &'a TimeHistory,
    fit: &'a ContactStiffness,
    title: String,
}

impl<'a> StiffnessFigure<'a> {
    /// A figure of this history and its fit.
    pub fn new(history: &'a TimeHistory, fit: &'a ContactStiffness) -> Self {
        Self { history, fit, title: String::new() }
    }

    /// With a title; without one otherwise.
    pub fn title(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// Draws the figure.
    ///
    /// # Errors
    /// [`ReportError::NothingToDraw`] if there are no finite samples near the stop.
    pub fn render(&self) -> Result<Figure, ReportError> {
        let reason = "no finite sample lies near the stop";
        let nothing = || ReportError::NothingToDraw { figure: "force over displacement", reason };
        let samples = self.samples();
        let extreme = samples.iter().fold((0.0_f64, 0.0_f64), |(x, f), s| (x.max(s.0.abs()), f.max(s.1.abs())));
        let (length, force) = (Unit::fine("m", extreme.0), Unit::coarse("N", extreme.1));
        let place = |(x, f): (f64, f64)| (x * length.per_si, f * force.per_si);
        let line: Vec<(f64, f64)> = self.line(&samples).map(place).to_vec();
        let points: Vec<(f64, f64)> = samples.iter().copied().map(place).collect();
        let all = || points.iter().chain(&line);
        let x = Scale::linear(all().map(|p| p.0), 0.04).ok_or_else(nothing)?;
        let y = Scale::linear(all().map(|p| p.1), 0.06).ok_or_else(nothing)?;
        let fill = palette::curve(1);
        let symbol = |at: &(f64, f64)| Symbol::new("sample", *at, Shape::Dot, fill);
        let stroke = Stroke::solid("#000000", 1.8);
        let panel = Panel {
            y: Axis { label: format!("contact force in {}", force.symbol), scale: y },
            curves: vec![Curve::new("stiffness", line, stroke)],
            symbols: points.iter().map(symbol).collect(),
            verticals: Vec::new(),
        };
        let name = format!("{:.4e} N/m ± {:.1e} N/m", self.fit.stiffness, self.fit.stiffness_error);
        let legend = vec![LegendEntry::line(stroke, name)];
        let x = Axis { label: format!("displacement in {}", length.symbol), scale: x };
        Ok(Figure::from(Chart::new(self.title.clone(), x, vec![panel], PANEL_HEIGHT, legend)))
    }

    /// +1 for a stop on the positive side.
    fn side(&self) -> f64 {
        if self.history.stop < 0.0 { -1.0 } else { 1.0 }
    }

    /// Displacement and force of the samples next to the stop.
    fn samples(&self) -> Vec<(f64, f64)> {
        let side = self.side();
        let beyond = |x: f64| side * (x - self.fit.stop);
        let pairs = self.history.displacement.iter().copied().zip(self.history.force.iter().copied());
        let finite = pairs.filter(|(x, f)| x.is_finite() && f.is_finite());
        let deepest = finite.clone().map(|(x, _)| beyond(x)).fold(0.0, f64::max);
        let near: Vec<(f64, f64)> = finite.filter(|(x, _)| beyond(*x) >= -OPEN_SIDE * deepest).collect();
        near.iter().copied().step_by(near.len().div_ceil(MAX_SAMPLES).max(1)).collect()
    }

    /// The line from the stop to the deepest sample.
    fn line(&self, samples: &[(f64, f64)]) -> [(f64, f64); 2] {
        let side = self.side();
        let deepest = samples.iter().map(|(x, _)| side * (x - self.fit.stop)).fold(0.0, f64::max);
        [(self.fit.stop, 0.0), (self.fit.stop + side * deepest, self.fit.stiffness * deepest)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_samples_near_the_stop_and_the_line_are_drawn() {
        for side in [1.0, -1.0] {
            let x: Vec<f64> = (0..400).map(|j| 1.1e-3 * (0.05 * f64::from(j)).cos()).collect();
            let history = TimeHistory {
                label: "record".into(),
                time: (0..400).map(|j| 1e-3 * f64::from(j)).collect(),
                force: x.iter().map(|x| (2e5 * (x - 1e-3)).max(0.0)).collect(),
                displacement: x.iter().map(|x| side * x).collect(),
                velocity: vec![0.0; 400],
                acceleration: vec![0.0; 400],
                stop: side * 1e-3,
                instants: vec![],
            };
            let fit = ContactStiffness::of(&history).unwrap();
            let svg = StiffnessFigure::new(&history, &fit).render().unwrap().as_svg().to_owned();
            let near = x.iter().filter(|x| **x >= 0.95e-3).count();
            assert!(svg.matches("class=\"sample\"").count().abs_diff(near) <= 2, "{near}");
            assert!(svg.contains("2.0000e5 N/m"), "{}", fit.stiffness);
        }
    }
}

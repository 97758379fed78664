use super::Figure;
use crate::ReportError;
use crate::chart::{Axis, Chart, Curve, LegendEntry, PANEL_HEIGHT, Panel, Scale, Shape, Symbol};
use crate::svg::Stroke;

/// Values of many cases over a variable: one dot per case, with median and band.
#[derive(Debug, Clone)]
pub struct SpreadFigure<'a> {
    x_label: &'a str,
    y_label: &'a str,
    title: &'a str,
    points: &'a [(f64, f64)],
    lines: Vec<Line<'a>>,
}

#[derive(Debug, Clone)]
struct Line<'a> {
    name: &'a str,
    points: &'a [(f64, f64)],
    is_limit: bool,
}

impl<'a> SpreadFigure<'a> {
    /// A figure of these points, with the labels of its axes.
    pub fn new(x_label: &'a str, y_label: &'a str, points: &'a [(f64, f64)]) -> Self {
        Self { x_label, y_label, title: "", points, lines: Vec::new() }
    }

    /// With a title; without one otherwise.
    pub fn title(mut self, title: &'a str) -> Self {
        self.title = title;
        self
    }

    /// With a line through the middle of the points, named in the legend.
    pub fn middle(mut self, name: &'a str, points: &'a [(f64, f64)]) -> Self {
        self.lines.push(Line { name, points, is_limit: false });
        self
    }

    /// With a dashed line at a limit of the points; an empty name is not in the legend.
    pub fn limit(mut self, name: &'a str, points: &'a [(f64, f64)]) -> Self {
        self.lines.push(Line { name, points, is_limit: true });
        self
    }

    /// Draws the figure.
    ///
    /// # Errors
    /// [`ReportError::NothingToDraw`] if no point is finite.
    pub fn render(&self) -> Result<Figure, ReportError> {
        let visible = || self.points.iter().filter(|(x, y)| x.is_finite() && y.is_finite());
        let x = Scale::linear(visible().map(|p| p.0), 0.03);
        let y = Scale::linear(visible().map(|p| p.1), 0.06);
        let reason = "no case has the quantity";
        let (x, y) = x.zip(y).ok_or(ReportError::NothingToDraw { figure: "spread", reason })?;
        let symbols = visible().map(|at| Symbol::new("case", *at, Shape::Dot, "#8fc1e3")).collect();
        let curve = |line: &Line<'_>| Curve::new("quantile", line.points.to_vec(), stroke(line));
        let lines = self.lines.iter();
        let y = Axis { label: self.y_label.to_owned(), scale: y };
        let panel = Panel { y, curves: lines.clone().map(curve).collect(), symbols, verticals: Vec::new() };
        let named = lines.filter(|line| !line.name.is_empty());
        let legend = named.map(|line| LegendEntry::line(stroke(line), line.name)).collect();
        let x = Axis { label: self.x_label.to_owned(), scale: x };
        Ok(Figure::from(Chart::new(self.title.to_owned(), x, vec![panel], PANEL_HEIGHT, legend)))
    }
}

fn stroke(line: &Line<'_>) -> Stroke {
    if line.is_limit { Stroke::dashed("#d55e00", 1.8) } else { Stroke::solid("#d55e00", 2.2) }
}

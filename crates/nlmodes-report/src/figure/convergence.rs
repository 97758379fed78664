use super::Figure;
use crate::ReportError;
use crate::chart::{Axis, Chart, Curve, LegendEntry, PANEL_HEIGHT, Panel, Scale, Shape, Symbol};
use crate::palette;
use crate::svg::Stroke;

/// An error over a discretisation parameter, both on logarithmic axes: a power law is a straight line whose slope is
/// the exponent.
///
/// Several series in one figure, with a dot at each value. Nonpositive values interrupt the line.
#[derive(Debug, Clone)]
pub struct ConvergenceFigure<'a> {
    x_label: &'a str,
    y_label: &'a str,
    title: &'a str,
    series: Vec<Series<'a>>,
}

#[derive(Debug, Clone)]
struct Series<'a> {
    name: &'a str,
    points: &'a [(f64, f64)],
    is_reference: bool,
}

impl<'a> ConvergenceFigure<'a> {
    /// A figure with the labels of its axes, units included, and no series yet.
    pub fn new(x_label: &'a str, y_label: &'a str) -> Self {
        Self { x_label, y_label, title: "", series: Vec::new() }
    }

    /// With a title; without one otherwise.
    pub fn title(mut self, title: &'a str) -> Self {
        self.title = title;
        self
    }

    /// With a series `(x, error)`, named in the legend.
    pub fn series(mut self, name: &'a str, points: &'a [(f64, f64)]) -> Self {
        self.series.push(Series { name, points, is_reference: false });
        self
    }

    /// With a dashed line to compare slopes with, named in the legend.
    pub fn reference(mut self, name: &'a str, points: &'a [(f64, f64)]) -> Self {
        self.series.push(Series { name, points, is_reference: true });
        self
    }

    /// Draws the figure.
    ///
    /// # Errors
    /// [`ReportError::NothingToDraw`] if no series has a positive, finite pair.
    pub fn render(&self) -> Result<Figure, ReportError> {
        let visible = || self.series.iter().flat_map(|s| s.points).filter(|(x, y)| is_positive(*x) && is_positive(*y));
        let x = Scale::logarithmic(visible().map(|p| p.0), 0.04);
        let y = Scale::logarithmic(visible().map(|p| p.1), 0.06);
        let reason = "no series has a positive, finite value";
        let (x, y) = x.zip(y).ok_or(ReportError::NothingToDraw { figure: "convergence", reason })?;
        let y = Axis { label: self.y_label.to_owned(), scale: y };
        let panel = Panel { y, curves: self.curves(), symbols: self.symbols(), verticals: Vec::new() };
        let x = Axis { label: self.x_label.to_owned(), scale: x };
        let legend = self.strokes().map(|(series, stroke)| LegendEntry::line(stroke, series.name)).collect();
        Ok(Figure::from(Chart::new(self.title.to_owned(), x, vec![panel], PANEL_HEIGHT, legend)))
    }

    /// The series with their strokes; references are grey and use no colour of the palette.
    fn strokes(&self) -> impl Iterator<Item = (&Series<'a>, Stroke)> {
        let mut colours = 0..;
        self.series.iter().map(move |series| {
            let stroke = match series.is_reference {
                true => Stroke::dashed("#777777", 1.2),
                false => Stroke::solid(palette::curve(colours.next().unwrap_or(0)), 1.8),
            };
            (series, stroke)
        })
    }

    fn curves(&self) -> Vec<Curve> {
        let curve = |(series, stroke): (&Series, Stroke)| {
            Curve::new(if series.is_reference { "reference" } else { "series" }, series.points.to_vec(), stroke)
        };
        self.strokes().map(curve).collect()
    }

    fn symbols(&self) -> Vec<Symbol> {
        let dots = self.strokes().filter(|(series, _)| !series.is_reference);
        let dots = dots.flat_map(|(series, stroke)| series.points.iter().map(move |at| (*at, stroke.color)));
        let visible = dots.filter(|((x, y), _)| is_positive(*x) && is_positive(*y));
        visible.map(|(at, fill)| Symbol::new("value", at, Shape::Dot, fill)).collect()
    }
}

fn is_positive(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

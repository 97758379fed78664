use super::Figure;
use crate::ReportError;
use crate::chart::{Axis, Chart, Curve, Panel, Scale, Shape, Symbol};
use crate::palette;
use crate::svg::Stroke;

/// Measured figures over the modal amplitude, as in Fig. 10, or over another quantity: one panel each, one dot per
/// record, with a bar for its uncertainty or scatter.
///
/// Values that are not finite are left out.
#[derive(Debug, Clone)]
pub struct MeasuredFigure<'a> {
    abscissae: &'a [f64],
    x_label: &'a str,
    title: &'a str,
    panels: Vec<(&'a str, &'a [(f64, f64)])>,
    is_scattered: bool,
    bars: Option<&'a str>,
}

impl<'a> MeasuredFigure<'a> {
    /// A figure of records with these modal amplitudes (m·√kg), and no panel yet.
    pub fn new(amplitudes: &'a [f64]) -> Self {
        Self {
            abscissae: amplitudes,
            x_label: "modal amplitude in m √kg",
            title: "",
            panels: Vec::new(),
            is_scattered: false,
            bars: None,
        }
    }

    /// Over a quantity other than modal amplitude; `label` has the unit.
    pub fn over(mut self, label: &'a str) -> Self {
        self.x_label = label;
        self
    }

    /// With a title; without one otherwise.
    pub fn title(mut self, title: &'a str) -> Self {
        self.title = title;
        self
    }

    /// Without a line between records, if their order is meaningless.
    pub fn scattered(mut self) -> Self {
        self.is_scattered = true;
        self
    }

    /// With the meaning of the bars, below the figure.
    pub fn bars(mut self, meaning: &'a str) -> Self {
        self.bars = Some(meaning);
        self
    }

    /// With a panel of values and their standard errors, one pair per record; `label` has the unit.
    pub fn panel(mut self, label: &'a str, values: &'a [(f64, f64)]) -> Self {
        self.panels.push((label, values));
        self
    }

    /// Draws the figure.
    ///
    /// # Errors
    /// [`ReportError::NothingToDraw`] without amplitudes, or if a panel has no finite value.
    pub fn render(&self) -> Result<Figure, ReportError> {
        let nothing = |reason| ReportError::NothingToDraw { figure: "measured figures", reason };
        let finite = self.abscissae.iter().copied().filter(|x| x.is_finite());
        let scale = Scale::linear(finite, 0.06).ok_or_else(|| nothing("no record has a finite amplitude"))?;
        let panels = self.panels.iter().map(|(label, values)| self.draw(label, values));
        let panels: Option<Vec<Panel>> = panels.collect();
        let panels = panels.ok_or_else(|| nothing("a panel has no finite value"))?;
        let x = Axis { label: self.x_label.to_owned(), scale };
        let (title, note) = (self.title.to_owned(), self.bars.map(str::to_owned));
        Ok(Figure::from(Chart { note, ..Chart::new(title, x, panels, 240.0, Vec::new()) }))
    }

    fn draw(&self, label: &str, values: &[(f64, f64)]) -> Option<Panel> {
        let pairs = self.abscissae.iter().zip(values).map(|(x, (y, error))| (*x, *y, *error));
        let visible: Vec<(f64, f64, f64)> = pairs.filter(|(x, y, _)| x.is_finite() && y.is_finite()).collect();
        let bar = |(_, y, error): &(f64, f64, f64)| if error.is_finite() { [y - error, y + error] } else { [*y, *y] };
        let scale = Scale::linear(visible.iter().flat_map(bar), 0.08)?;
        let colour = palette::curve(0);
        let line = (!self.is_scattered).then(|| {
            let points = visible.iter().map(|(x, y, _)| (*x, *y)).collect();
            Curve::new("measured", points, Stroke::solid(colour, 1.2))
        });
        let bars = visible.iter().map(|value| {
            let points = bar(value).map(|y| (value.0, y)).to_vec();
            Curve::new("uncertainty", points, Stroke::solid(colour, 2.4))
        });
        let symbols = visible.iter().map(|(x, y, _)| Symbol::new("record", (*x, *y), Shape::Dot, colour)).collect();
        let y = Axis { label: label.to_owned(), scale };
        Some(Panel { y, curves: line.into_iter().chain(bars).collect(), symbols, verticals: Vec::new() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_record_has_a_dot_and_a_bar_in_each_panel() {
        let amplitudes = [1e-4, 2e-4, f64::NAN, 4e-4];
        let damping = [(0.0019, 1e-5), (0.002, 2e-5), (0.0021, 1e-5), (0.003, f64::NAN)];
        let pbmif = [(1.0, 0.0), (0.99, 1e-3), (0.9, 1e-3), (f64::NAN, f64::NAN)];
        let figure = MeasuredFigure::new(&amplitudes).panel("damping", &damping).panel("indicator", &pbmif);
        let svg = figure.render().unwrap().as_svg().to_owned();
        assert_eq!(svg.matches("class=\"record\"").count(), 3 + 2);
        assert_eq!(svg.matches("class=\"uncertainty\"").count(), 3 + 2);
        assert_eq!(svg.matches("class=\"measured\"").count(), 2);
        let scattered = figure.scattered().render().unwrap();
        assert!(!scattered.as_svg().contains("class=\"measured\""));
        assert!(MeasuredFigure::new(&[f64::NAN]).panel("damping", &[(1.0, 0.0)]).render().is_err());
        assert!(MeasuredFigure::new(&[1.0]).panel("damping", &[(0.0019, 0.0)]).render().is_ok());
    }
}

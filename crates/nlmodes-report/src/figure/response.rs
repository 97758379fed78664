use super::Figure;
use super::branch::State;
use crate::ReportError;
use crate::chart::{Axis, Chart, Curve, Key, LegendEntry, Name, Panel, Scale, Shape, Symbol};
use crate::palette;
use crate::svg::Stroke;
use crate::unit::Unit;

/// Kind of a curve of a [`ResponseFigure`], which determines its style.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineKind {
    /// A response to a load, in its own colour.
    Response,
    /// A nonlinear mode, conservative: a wide grey line below the others.
    Mode,
    /// A damped nonlinear mode: a black line.
    DampedMode,
    /// Phase resonance: a thin brown line.
    Resonance,
    /// Measured points, as unconnected circles.
    Measured,
}

impl LineKind {
    /// Its colour; for a response that of the response with this number.
    pub(crate) fn color(self, response: usize) -> &'static str {
        match self {
            Self::Response | Self::Measured => palette::curve(response),
            Self::Mode => MODE,
            Self::DampedMode => palette::INK,
            Self::Resonance => RESONANCE,
        }
    }
}

/// A curve of damped or forced motions.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseLine {
    /// Its name in the legend; curves of one name have one entry and one colour.
    pub name: String,
    /// What it is.
    pub kind: LineKind,
    /// Abscissa, ordinate, and whether the motion is stable; if this is known anywhere on a curve, unknown segments are
    /// drawn thin.
    pub points: Vec<(f64, f64, Option<bool>)>,
}

/// Quantity of an axis, in SI units; prefixes are chosen here.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Its name, such as `frequency`.
    pub name: String,
    /// Its unit, such as `Hz`; empty for none.
    pub unit: String,
    /// Whether the axis is logarithmic.
    pub is_logarithmic: bool,
}

impl Quantity {
    /// On a linear axis.
    pub fn linear(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into(), is_logarithmic: false }
    }

    /// On a logarithmic axis.
    pub fn logarithmic(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { is_logarithmic: true, ..Self::linear(name, unit) }
    }

    /// Unit of the axis for values up to this one.
    fn scaled(&self, largest: f64) -> Unit {
        match self.unit.as_str() {
            "m" | "s" | "m/s" if !self.is_logarithmic => Unit::fine(&self.unit, largest),
            "N" if !self.is_logarithmic => Unit::coarse(&self.unit, largest),
            other => Unit { symbol: other.to_owned(), per_si: 1.0 },
        }
    }

    fn axis(&self, values: impl Iterator<Item = f64> + Clone, margin: f64) -> Option<(Axis, f64)> {
        let largest = values.clone().filter(|v| v.is_finite()).fold(0.0_f64, |m, v| m.max(v.abs()));
        let unit = self.scaled(largest);
        let values = values.map(|v| v * unit.per_si);
        let scale =
            if self.is_logarithmic { Scale::logarithmic(values, margin) } else { Scale::linear(values, margin) };
        let label =
            if unit.symbol.is_empty() { self.name.clone() } else { format!("{} in {}", self.name, unit.symbol) };
        Some((Axis { label, scale: scale? }, unit.per_si))
    }
}

/// Curves of responses, phase resonance and nonlinear modes over one abscissa: stable solid, unstable dashed, uncertain
/// thin.
#[derive(Debug, Clone)]
pub struct ResponseFigure<'a> {
    lines: &'a [ResponseLine],
    title: String,
    axes: [Quantity; 2],
    marks: Vec<(f64, f64, String)>,
}

const RESONANCE: &str = "#8c510a";
const MODE: &str = "#b0b0b0";

impl<'a> ResponseFigure<'a> {
    /// A figure with this abscissa and this ordinate.
    pub fn new(lines: &'a [ResponseLine], abscissa: Quantity, ordinate: Quantity) -> Self {
        Self { lines, title: String::new(), axes: [abscissa, ordinate], marks: Vec::new() }
    }

    /// With a title; without one otherwise.
    pub fn title(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// With a dot at these coordinates, and a name beside it if it is not empty.
    pub fn mark(mut self, x: f64, y: f64, name: impl Into<String>) -> Self {
        self.marks.push((x, y, name.into()));
        self
    }

    /// Draws the figure.
    ///
    /// # Errors
    /// [`ReportError::NothingToDraw`] if there is no finite point.
    pub fn render(&self) -> Result<Figure, ReportError> {
        let all = || self.lines.iter().flat_map(|line| &line.points);
        let nothing = || ReportError::NothingToDraw { figure: "responses", reason: "no point is finite" };
        let (x, per_x) = self.axes[0].axis(all().map(|p| p.0), 0.03).ok_or_else(nothing)?;
        let (y, per_y) = self.axes[1].axis(all().map(|p| p.1), 0.06).ok_or_else(nothing)?;
        let mut order: Vec<&ResponseLine> = self.lines.iter().collect();
        // Wide lines are drawn below narrow ones.
        order.sort_by_key(|line| match line.kind {
            LineKind::Mode => 0,
            LineKind::DampedMode => 1,
            LineKind::Response => 2,
            LineKind::Resonance | LineKind::Measured => 3,
        });
        let joined = order.into_iter().filter(|line| line.kind != LineKind::Measured);
        let curves = joined.flat_map(|line| pieces(line, self.stroke(line), [per_x, per_y])).collect();
        let symbol = |(x, y, name): &(f64, f64, String)| {
            let name = (!name.is_empty()).then(|| Name::fixed(name));
            Symbol { name, ..Symbol::new("mark", (x * per_x, y * per_y), Shape::Dot, palette::INK) }
        };
        let measured = self.lines.iter().filter(|line| line.kind == LineKind::Measured);
        let circles = measured.flat_map(|line| {
            let fill = self.stroke(line).color;
            let finite = line.points.iter().filter(|p| p.0.is_finite() && p.1.is_finite());
            finite.map(move |p| Symbol::new("measured", (p.0 * per_x, p.1 * per_y), Shape::Circle, fill).open())
        });
        let symbols = circles.chain(self.marks.iter().map(symbol)).collect();
        let panel = Panel { y, curves, symbols, verticals: Vec::new() };
        Ok(Figure::from(Chart::new(self.title.clone(), x, vec![panel], 420.0, self.legend())))
    }

    fn names(&self) -> Vec<&ResponseLine> {
        let mut named: Vec<&ResponseLine> = Vec::new();
        for line in self.lines {
            if !named.iter().any(|known| known.name == line.name) {
                named.push(line);
            }
        }
        named
    }

    fn legend(&self) -> Vec<LegendEntry> {
        let key = |line: &ResponseLine| match line.kind {
            LineKind::Measured => Key::Open(Shape::Circle, self.stroke(line).color),
            _ => Key::Line(self.stroke(line)),
        };
        let entry = |line: &&ResponseLine| LegendEntry { key: key(line), name: line.name.clone() };
        let ink = Stroke::solid(palette::INK, 1.8);
        let states = [(State::Unstable, "unstable"), (State::Unknown, "stability uncertain")];
        let occurs = |state: State| self.lines.iter().any(|line| line.points.iter().any(|p| line.state(p) == state));
        let more = states.into_iter().filter(|(state, _)| occurs(*state));
        let more = more.map(|(state, name)| LegendEntry::line(state.stroke(ink), name));
        self.names().iter().map(entry).chain(more).collect()
    }

    fn stroke(&self, line: &ResponseLine) -> Stroke {
        let responses = self.names().into_iter().filter(|l| matches!(l.kind, LineKind::Response | LineKind::Measured));
        let index = responses.take_while(|l| l.name != line.name).count();
        let width = match line.kind {
            LineKind::Response | LineKind::Measured => 1.8,
            LineKind::Mode => 5.0,
            LineKind::DampedMode => 2.4,
            LineKind::Resonance => 1.2,
        };
        Stroke::solid(line.kind.color(index), width)
    }
}

impl ResponseLine {
    fn state(&self, point: &(f64, f64, Option<bool>)) -> State {
        State::of(point.2, self.points.iter().any(|p| p.2.is_some()))
    }
}

/// Segments of constant stability; each extends to the first point of the next.
fn pieces(line: &ResponseLine, stroke: Stroke, per_si: [f64; 2]) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    let at = |p: &(f64, f64, Option<bool>)| (p.0 * per_si[0], p.1 * per_si[1]);
    for piece in line.points.chunk_by(|a, b| line.state(a) == line.state(b)) {
        let Some(first) = piece.first() else { continue };
        if let Some(last) = curves.last_mut() {
            last.points.push(at(first));
        }
        let stroke = line.state(first).stroke(stroke);
        curves.push(Curve::new("response", piece.iter().map(at).collect(), stroke).smooth(Vec::new()));
    }
    curves
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_unstable_is_dashed_and_joined_to_the_rest() {
        let point = |x: f64, stable| (x, 1e-3 * x * x, Some(stable));
        let points = vec![point(0.0, true), point(1.0, true), point(2.0, false), point(3.0, true)];
        let line = ResponseLine { name: "4 N".into(), kind: LineKind::Response, points };
        let stretches = pieces(&line, Stroke::solid("red", 1.0), [1.0, 1e3]);
        let lengths: Vec<(usize, bool)> = stretches.iter().map(|c| (c.points.len(), c.stroke.dash.is_some())).collect();
        assert_eq!(lengths, [(3, false), (2, true), (1, false)]);
        assert_eq!(stretches[1].points[0], (2.0, 4.0));
        let uncertain = ResponseLine { points: vec![point(0.0, true), (1.0, 1.0, None)], ..line.clone() };
        let thin: Vec<f64> =
            pieces(&uncertain, Stroke::solid("red", 2.0), [1.0; 2]).iter().map(|c| c.stroke.width).collect();
        assert_eq!(thin, [2.0, 0.9]);
        let axes = || (Quantity::linear("frequency", "Hz"), Quantity::linear("amplitude", "m"));
        let (x, y) = axes();
        let svg = ResponseFigure::new(&[line], x, y).title("t").mark(1.0, 1e-3, "P").render().unwrap();
        for text in ["4 N", "unstable", "amplitude in mm", ">P<"] {
            assert!(svg.as_svg().contains(text), "{text}");
        }
        let measured = ResponseLine {
            name: "test".into(),
            kind: LineKind::Measured,
            points: vec![point(1.0, true), point(f64::NAN, true)],
        };
        let (x, y) = axes();
        let svg = ResponseFigure::new(&[measured], x, y).render().unwrap();
        assert!(
            svg.as_svg().matches("class=\"measured\"").count() == 1 && !svg.as_svg().contains("class=\"response\"")
        );
        let (x, y) = axes();
        assert!(ResponseFigure::new(&[], x, y).render().is_err());
    }
}

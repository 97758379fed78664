//! Contents of a two-dimensional figure, independent of its drawing.

mod draw;
mod inset;
mod legend;
mod names;
mod panel;
mod scale;
mod smooth;
mod symbol;
mod ticks;

pub(crate) use inset::Inset;
pub(crate) use legend::{Key, LegendEntry};
pub(crate) use scale::Scale;
pub(crate) use symbol::Shape;
pub(crate) use ticks::{linear_ticks, scientific};

use crate::svg::Stroke;

/// Height of a panel that is alone, pixels.
pub(crate) const PANEL_HEIGHT: f64 = 360.0;

/// Stacked panels with a common abscissa.
#[derive(Debug)]
pub(crate) struct Chart {
    pub title: String,
    pub x: Axis,
    pub panels: Vec<Panel>,
    /// Height of each panel, pixels.
    pub panel_height: f64,
    pub legend: Vec<LegendEntry>,
    /// Note in small letters below the figure.
    pub note: Option<String>,
    /// An enlarged part of the first panel.
    pub inset: Option<Inset>,
}

impl Chart {
    /// These panels, each of this height, without note or inset.
    pub fn new(title: String, x: Axis, panels: Vec<Panel>, panel_height: f64, legend: Vec<LegendEntry>) -> Self {
        Self { title, x, panels, panel_height, legend, note: None, inset: None }
    }
}

/// An axis: its label with the unit, and its range.
#[derive(Debug)]
pub(crate) struct Axis {
    pub label: String,
    pub scale: Scale,
}

/// Curves, symbols and reference lines over one ordinate, in the units of the axes.
#[derive(Debug)]
pub(crate) struct Panel {
    pub y: Axis,
    pub curves: Vec<Curve>,
    pub symbols: Vec<Symbol>,
    /// Abscissas of vertical lines.
    pub verticals: Vec<(f64, Stroke)>,
}

/// A curve; it is interrupted where a value is not finite.
#[derive(Debug)]
pub(crate) struct Curve {
    /// Its kind, in the `class` attribute: `branch`, `stop`, …
    pub class: &'static str,
    pub points: Vec<(f64, f64)>,
    pub stroke: Stroke,
    form: Form,
}

/// Interpolation of a curve between points.
#[derive(Debug)]
enum Form {
    Straight,
    /// Cubic pieces, with kinks at the points with these indices.
    Smooth(Vec<usize>),
}

impl Curve {
    /// Straight lines between points.
    pub fn new(class: &'static str, points: Vec<(f64, f64)>, stroke: Stroke) -> Self {
        Self { class, points, stroke, form: Form::Straight }
    }

    /// Smooth, except at `corners`, the indices of points at which it may have a kink.
    pub fn smooth(self, corners: Vec<usize>) -> Self {
        Self { form: Form::Smooth(corners), ..self }
    }
}

/// A symbol at a point, with an optional short name beside it.
#[derive(Debug)]
pub(crate) struct Symbol {
    pub class: String,
    pub at: (f64, f64),
    pub shape: Shape,
    pub fill: &'static str,
    /// Whether `fill` is the colour of its outline.
    pub is_open: bool,
    pub name: Option<Name>,
}

impl Symbol {
    /// A filled one without a name.
    pub fn new(class: impl Into<String>, at: (f64, f64), shape: Shape, fill: &'static str) -> Self {
        Self { class: class.into(), at, shape, fill, is_open: false, name: None }
    }

    /// With its outline only.
    pub fn open(self) -> Self {
        Self { is_open: true, ..self }
    }
}

/// A name beside a symbol.
#[derive(Debug)]
pub(crate) struct Name {
    pub text: String,
    /// Whether it is omitted if there is no space for it.
    pub may_go: bool,
}

impl Name {
    /// A name that is always drawn.
    pub fn fixed(text: impl Into<String>) -> Self {
        Self { text: text.into(), may_go: false }
    }
}

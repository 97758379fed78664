//! What a two-dimensional figure shows, apart from how it is drawn.

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

/// Panels above each other that share their abscissa.
#[derive(Debug)]
pub(crate) struct Chart {
    pub title: String,
    pub x: Axis,
    pub panels: Vec<Panel>,
    /// Height of each panel, pixels.
    pub panel_height: f64,
    pub legend: Vec<LegendEntry>,
    /// Small letters below the figure.
    pub note: Option<String>,
    /// A part of the first panel, drawn larger.
    pub inset: Option<Inset>,
}

impl Chart {
    /// One panel of the usual height, with nothing below or within it.
    pub fn of_panel(title: String, x: Axis, panel: Panel, legend: Vec<LegendEntry>) -> Self {
        Self { title, x, panels: vec![panel], panel_height: 360.0, legend, note: None, inset: None }
    }
}

/// An axis: its label with the unit, and what it spans.
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
    /// What it is, in the `class` attribute: `branch`, `stop`, …
    pub class: &'static str,
    pub points: Vec<(f64, f64)>,
    pub stroke: Stroke,
    form: Form,
}

/// How a curve goes from point to point.
#[derive(Debug)]
enum Form {
    Straight,
    /// By cubic pieces, with corners at the points with these indices.
    Smooth(Vec<usize>),
}

impl Curve {
    /// Straight from point to point.
    pub fn new(class: &'static str, points: Vec<(f64, f64)>, stroke: Stroke) -> Self {
        Self { class, points, stroke, form: Form::Straight }
    }

    /// Smooth between its points, but for `corners`, the indices of points at which it may turn.
    pub fn smooth(self, corners: Vec<usize>) -> Self {
        Self { form: Form::Smooth(corners), ..self }
    }
}

/// A symbol at a point, with a short name beside it where it has one.
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

/// A name beside a symbol.
#[derive(Debug)]
pub(crate) struct Name {
    pub text: String,
    /// Whether it is left out where there is no room for it.
    pub may_go: bool,
}

impl Name {
    /// A name that is always there.
    pub fn fixed(text: impl Into<String>) -> Self {
        Self { text: text.into(), may_go: false }
    }
}

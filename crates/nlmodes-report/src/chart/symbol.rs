use crate::palette;
use crate::svg::{Stroke, Svg};
use std::f64::consts::{FRAC_PI_2, TAU};

const OUTLINE: Stroke = Stroke::solid(palette::INK, 1.0);

/// Shape of a symbol.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Shape {
    Circle,
    Dot,
    Triangle,
    TriangleDown,
    Square,
    Diamond,
    Pentagon,
    Star,
    Plus,
    Cross,
}

impl Shape {
    /// Name of the shape, for use elsewhere.
    pub fn name(self) -> &'static str {
        match self {
            Self::Circle => "circle",
            Self::Dot => "dot",
            Self::Triangle => "triangle",
            Self::TriangleDown => "triangle-down",
            Self::Square => "square",
            Self::Diamond => "diamond",
            Self::Pentagon => "pentagon",
            Self::Star => "star",
            Self::Plus => "plus",
            Self::Cross => "cross",
        }
    }

    /// Draws the symbol centred at `at`.
    pub fn draw(self, svg: &mut Svg, class: &str, at: (f64, f64), fill: &str) {
        self.draw_with(svg, class, at, fill, OUTLINE);
    }

    /// Draws its outline in a colour, to distinguish it from a dot on a curve.
    pub fn draw_open(self, svg: &mut Svg, class: &str, at: (f64, f64), color: &'static str) {
        self.draw_with(svg, class, at, "#ffffff", Stroke::solid(color, 1.6));
    }

    fn draw_with(self, svg: &mut Svg, class: &str, at: (f64, f64), fill: &str, outline: Stroke) {
        match self {
            Self::Circle => svg.circle(class, at, 4.6, fill, &outline),
            Self::Dot => svg.circle(class, at, 3.2, fill, &Stroke::solid(palette::INK, 0.0)),
            Self::Triangle => svg.polygon(class, &corners(at, 3, 5.8, 0.0), fill, &outline),
            Self::TriangleDown => svg.polygon(class, &corners(at, 3, 5.8, 0.5), fill, &outline),
            Self::Square => svg.polygon(class, &corners(at, 4, 5.8, 0.5), fill, &outline),
            Self::Diamond => svg.polygon(class, &corners(at, 4, 6.0, 0.0), fill, &outline),
            Self::Pentagon => svg.polygon(class, &corners(at, 5, 5.4, 0.0), fill, &outline),
            Self::Star => svg.polygon(class, &star(at), fill, &outline),
            Self::Plus => svg.polygon(class, &plus(at, 0.0), fill, &outline),
            Self::Cross => svg.polygon(class, &plus(at, 0.5), fill, &outline),
        }
    }
}

/// Vertices of a regular polygon with a horizontal side (`turn` 0.5: even, or upside down).
fn corners(at: (f64, f64), n: usize, radius: f64, turn: f64) -> Vec<(f64, f64)> {
    (0..n).map(|k| on_circle(at, radius, TAU * (k as f64 + turn) / n as f64)).collect()
}

fn star(at: (f64, f64)) -> Vec<(f64, f64)> {
    (0..10).map(|k| on_circle(at, if k % 2 == 0 { 6.6 } else { 2.8 }, TAU * k as f64 / 10.0)).collect()
}

/// A cross; `turn` in quarters of a turn.
fn plus(at: (f64, f64), turn: f64) -> Vec<(f64, f64)> {
    let arm = [(-0.32, 6.0), (0.32, 6.0), (0.5 * FRAC_PI_2, 2.7)];
    (0..4)
        .flat_map(|k| arm.map(|(angle, radius)| on_circle(at, radius, angle + FRAC_PI_2 * (f64::from(k) + turn))))
        .collect()
}

/// Point at `angle`, clockwise from above.
fn on_circle(at: (f64, f64), radius: f64, angle: f64) -> (f64, f64) {
    let (sin, cos) = (angle - FRAC_PI_2).sin_cos();
    (at.0 + radius * cos, at.1 + radius * sin)
}

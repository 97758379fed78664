use super::Shape;
use crate::svg::{Anchor, Stroke, Svg, text_width};

const FONT: f64 = 13.0;
/// Space for a line before its name, for a symbol, and after a name, pixels.
const LINE: f64 = 30.0;
const SYMBOL: f64 = 20.0;
const GAP: f64 = 14.0;
/// Height of a row of the legend, pixels.
pub(crate) const ROW: f64 = 18.0;

/// The sample before a name in the legend.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Key {
    Line(Stroke),
    Symbol(Shape, &'static str),
    /// Outlined in this colour.
    Open(Shape, &'static str),
}

impl Key {
    fn width(self) -> f64 {
        match self {
            Self::Line(_) => LINE,
            Self::Symbol(..) | Self::Open(..) => SYMBOL,
        }
    }
}

/// A name in the legend.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LegendEntry {
    pub key: Key,
    pub name: String,
}

impl LegendEntry {
    /// Of a line.
    pub fn line(stroke: Stroke, name: impl Into<String>) -> Self {
        Self { key: Key::Line(stroke), name: name.into() }
    }

    fn width(&self) -> f64 {
        self.key.width() + text_width(&self.name, FONT) + GAP
    }
}

/// Breaks the entries into rows of at most `width`.
pub(crate) fn rows(entries: &[LegendEntry], width: f64) -> Vec<&[LegendEntry]> {
    let mut rows = Vec::new();
    let mut rest = entries;
    while !rest.is_empty() {
        let mut used = 0.0;
        let fitting = rest.iter().take_while(|entry| {
            used += entry.width();
            used <= width + GAP
        });
        let (row, tail) = rest.split_at(fitting.count().max(1));
        rows.push(row);
        rest = tail;
    }
    rows
}

/// Draws rows of entries from `corner` downwards.
pub(crate) fn draw(svg: &mut Svg, rows: &[&[LegendEntry]], corner: (f64, f64)) {
    for (index, row) in rows.iter().enumerate() {
        let mut x = corner.0;
        let y = corner.1 + (index as f64 + 0.5) * ROW;
        for entry in *row {
            draw_key(svg, entry.key, (x, y));
            svg.text((x + entry.key.width(), y + 0.35 * FONT), Anchor::Start, FONT, &entry.name);
            x += entry.width();
        }
    }
}

fn draw_key(svg: &mut Svg, key: Key, (x, y): (f64, f64)) {
    let length = key.width() - 6.0;
    match key {
        Key::Line(stroke) => svg.line((x, y), (x + length, y), &stroke),
        Key::Open(shape, color) => shape.draw_open(svg, "key", (x + 0.5 * length, y), color),
        Key::Symbol(shape, fill) => shape.draw(svg, "key", (x + 0.5 * length, y), fill),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_entry_has_a_place_even_if_it_is_wider_than_the_figure() {
        let entry = |name: &str| LegendEntry { key: Key::Symbol(Shape::Dot, "red"), name: name.into() };
        let entries = [entry("a"), entry(&"long ".repeat(50)), entry("b"), entry("c")];
        let lengths: Vec<usize> = rows(&entries, 300.0).iter().map(|row| row.len()).collect();
        assert_eq!(lengths, [1, 1, 2]);
    }
}

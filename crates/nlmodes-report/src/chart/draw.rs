use super::panel::Frame;
use super::{Chart, Inset, legend};
use crate::style::FigureStyle;
use crate::svg::{Anchor, Svg, fitting_size, text_width};

pub(super) const FONT: f64 = 13.0;
const TITLE: f64 = 16.0;
pub(super) const LABEL: f64 = 15.0;
/// Size of the ordinate label of one of several panels.
pub(super) const SMALL_LABEL: f64 = 13.0;
/// Permitted excess of the length of an ordinate label over the height of its panel, pixels.
pub(super) const LABEL_BEYOND: f64 = 12.0;
/// Largest factor by which panels grow for their labels.
const HIGHER: f64 = 1.3;
/// Width of a figure, pixels, below which its legend begins at its edge, and the distance from the edge.
const NARROW: f64 = 500.0;
const MARGIN: f64 = 12.0;
const NOTE: f64 = 11.5;
const NOTE_ROOM: f64 = 18.0;
const GAP: f64 = 16.0;
const RIGHT: f64 = 24.0;
const BOTTOM: f64 = 56.0;

impl Chart {
    /// The chart as an SVG document.
    pub fn draw(&self, style: &FigureStyle) -> String {
        let width = style.pixels();
        let height = self.height_with_labels(style);
        let left = self.left_margin(height);
        let room = width - left - RIGHT;
        // In a narrow figure the legend has the full width.
        let legend_left = if width < NARROW { MARGIN } else { left };
        let rows = legend::rows(&self.legend, width - legend_left - RIGHT);
        let title = if style.has_title { self.title.as_str() } else { "" };
        let head = if title.is_empty() { 14.0 } else { 40.0 };
        let top = head + rows.len() as f64 * legend::ROW + 6.0;
        let n = self.panels.len() as f64;
        let note = if self.note.is_some() { NOTE_ROOM } else { 0.0 };
        let mut svg = Svg::new(width, top + n * height + (n - 1.0) * GAP + BOTTOM + note);
        let middle = left + 0.5 * room;
        if !title.is_empty() {
            svg.text((middle, 26.0), Anchor::Middle, fitting_size(title, TITLE, room), title);
        }
        legend::draw(&mut svg, &rows, (legend_left, head));
        for (index, panel) in self.panels.iter().enumerate() {
            let frame = Frame { left, top: top + index as f64 * (height + GAP), width: room, height };
            let inset: Option<&Inset> = self.inset.as_ref().filter(|_| index == 0);
            self.draw_panel(&mut svg, panel, frame, index + 1 == self.panels.len(), inset);
        }
        if let Some(note) = &self.note {
            let at = (middle, top + n * height + (n - 1.0) * GAP + BOTTOM + 4.0);
            svg.text(at, Anchor::Middle, fitting_size(note, NOTE, width - 16.0), note);
        }
        svg.finish(style.width_mm)
    }

    /// Height of a panel: if there are several, at least the length of its label, unless that is far too long.
    fn height_with_labels(&self, style: &FigureStyle) -> f64 {
        let height = self.panel_height * style.height_share();
        let long = self.panels.iter().map(|panel| text_width(&panel.y.label, SMALL_LABEL)).fold(0.0, f64::max);
        height.max((long - LABEL_BEYOND).min(HIGHER * height))
    }

    /// Space for the widest ordinate label.
    fn left_margin(&self, height: f64) -> f64 {
        let ticks = self.panels.iter().flat_map(|panel| panel.y.scale.ticks(y_target(height)));
        let widths = ticks.filter_map(|tick| tick.label).map(|label| text_width(&label, FONT));
        widths.fold(24.0, f64::max) + 42.0
    }
}

pub(super) fn y_target(height: f64) -> usize {
    (height / 28.0).round().max(3.0) as usize
}

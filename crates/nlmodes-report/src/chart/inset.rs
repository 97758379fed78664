use super::panel::draw_curve;
use super::{Axis, Panel};
use crate::palette;
use crate::svg::{Anchor, Stroke, Svg};

const FONT: f64 = 10.5;
const FRAME: Stroke = Stroke::solid(palette::INK, 0.8);
const MARK: Stroke = Stroke::dashed("#888888", 0.8);
/// Width and height relative to those of the panel.
const SIZE: (f64, f64) = (0.46, 0.42);
/// Distance from the frame of the panel, and space for the numbers of the inset, pixels.
const AWAY: f64 = 12.0;
const ROOM: (f64, f64) = (52.0, 18.0);

/// An inset: an enlarged part of a panel, in the corner where it covers least.
#[derive(Debug)]
pub(crate) struct Inset {
    pub x: Axis,
    pub y: Axis,
}

/// A rectangle: left, top, width, height, pixels.
pub(super) type Rectangle = (f64, f64, f64, f64);

impl Inset {
    /// Draws it into the panel that fills `frame` and returns where it is; `taken` are parts of the picture that should
    /// not be covered, and `outside` maps a point to the panel.
    pub(super) fn draw(
        &self,
        svg: &mut Svg,
        panel: &Panel,
        frame: Rectangle,
        taken: &[(f64, f64)],
        outside: impl Fn((f64, f64)) -> Option<(f64, f64)>,
    ) -> Rectangle {
        let own @ (left, top, width, height) = corner(frame, taken);
        svg.rectangle((left, top), (width, height), "#ffffff", &Stroke::solid("#ffffff", 0.0));
        let inner = (left + ROOM.0, top + 6.0, width - ROOM.0 - 8.0, height - ROOM.1 - 8.0);
        if let Some((x, y, w, h)) = self.marked(frame, outside) {
            svg.rectangle((x, y), (w, h), "none", &MARK);
        }
        self.draw_ticks(svg, inner);
        // A nested document, clipped to its frame.
        let place = |(x, y): (f64, f64)| {
            let (u, v) = self.x.scale.place(x).zip(self.y.scale.place(y))?;
            // Coordinates far outside need no precision, and some viewers cannot handle them.
            Some(((u * inner.2).clamp(-1e5, 1e5), ((1.0 - v) * inner.3).clamp(-1e5, 1e5)))
        };
        svg.begin_part(inner);
        for curve in &panel.curves {
            draw_curve(svg, curve, place, None);
        }
        for symbol in &panel.symbols {
            if let Some(at) = place(symbol.at) {
                symbol.draw(svg, at);
            }
        }
        svg.end_part();
        svg.rectangle((inner.0, inner.1), (inner.2, inner.3), "none", &FRAME);
        own
    }

    /// The rectangle around the enlarged part, within the frame.
    fn marked(
        &self,
        (left, top, width, height): Rectangle,
        outside: impl Fn((f64, f64)) -> Option<(f64, f64)>,
    ) -> Option<Rectangle> {
        let ((x0, x1), (y0, y1)) = (self.x.scale.ends(), self.y.scale.ends());
        let ((a, b), (c, d)) = outside((x0, y0)).zip(outside((x1, y1)))?;
        let (a, c) = ((a - 2.0).max(left), (c + 2.0).min(left + width));
        let (d, b) = ((d - 7.0).max(top), (b + 7.0).min(top + height));
        Some((a, d, c - a, b - d))
    }

    fn draw_ticks(&self, svg: &mut Svg, (left, top, width, height): Rectangle) {
        for tick in self.x.scale.ticks_with_room(3, width, FONT) {
            let (Some(share), Some(label)) = (self.x.scale.place(tick.value), tick.label) else { continue };
            let x = left + share * width;
            svg.line((x, top + height), (x, top + height + 3.0), &FRAME);
            svg.text((x, top + height + 14.0), Anchor::Middle, FONT, &label);
        }
        for tick in self.y.scale.ticks(3) {
            let (Some(share), Some(label)) = (self.y.scale.place(tick.value), tick.label) else { continue };
            let y = top + (1.0 - share) * height;
            svg.line((left - 3.0, y), (left, y), &FRAME);
            svg.text((left - 5.0, y + 0.35 * FONT), Anchor::End, FONT, &label);
        }
    }
}

/// The corner in which the inset covers least.
fn corner((left, top, width, height): Rectangle, taken: &[(f64, f64)]) -> Rectangle {
    let (w, h) = (SIZE.0 * width, SIZE.1 * height);
    let (right, bottom) = (left + width - w - AWAY, top + height - h - AWAY);
    let corners = [(right, top + AWAY), (left + AWAY, top + AWAY), (right, bottom), (left + AWAY, bottom)];
    let covered = |(x, y): &(f64, f64)| {
        taken.iter().filter(|(a, b)| (*x..=x + w).contains(a) && (*y..=y + h).contains(b)).count()
    };
    let (x, y) = corners.into_iter().min_by_key(covered).unwrap_or(corners[0]);
    (x, y, w, h)
}

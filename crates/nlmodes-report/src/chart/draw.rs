use super::ticks::Tick;
use super::{Axis, Chart, Curve, Inset, Panel, Shape, Symbol, legend};
use crate::palette;
use crate::svg::{Anchor, Stroke, Svg, fitting_size, text_width};

const WIDTH: f64 = 720.0;
const TITLE: f64 = 16.0;
const LABEL: f64 = 15.0;
/// Size of the label of an ordinate that shares its height with others.
const SMALL_LABEL: f64 = 13.0;
const FONT: f64 = 13.0;
const GAP: f64 = 16.0;
const RIGHT: f64 = 24.0;
const BOTTOM: f64 = 56.0;
const FRAME: Stroke = Stroke::solid(palette::INK, 1.0);

/// Rectangle of a panel, pixels.
#[derive(Clone, Copy)]
struct Frame {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
}

impl Frame {
    fn bottom(self) -> f64 {
        self.top + self.height
    }

    fn x(self, axis: &Axis, value: f64) -> Option<f64> {
        axis.scale.place(value).map(|share| self.left + share * self.width)
    }

    fn y(self, axis: &Axis, value: f64) -> Option<f64> {
        axis.scale.place(value).map(|share| self.bottom() - share * self.height)
    }
}

impl Chart {
    /// The chart as an SVG document.
    pub fn draw(&self) -> String {
        self.draw_all(None)
    }

    pub(super) fn draw_all(&self, inset: Option<&Inset>) -> String {
        let left = self.left_margin();
        let rows = legend::rows(&self.legend, WIDTH - left - RIGHT);
        let head = if self.title.is_empty() { 14.0 } else { 40.0 };
        let top = head + rows.len() as f64 * legend::ROW + 6.0;
        let n = self.panels.len() as f64;
        let mut svg = Svg::new(WIDTH, top + n * self.panel_height + (n - 1.0) * GAP + BOTTOM);
        let middle = left + 0.5 * (WIDTH - left - RIGHT);
        let size = fitting_size(&self.title, TITLE, WIDTH - left - RIGHT);
        svg.text((middle, 26.0), Anchor::Middle, size, &self.title);
        legend::draw(&mut svg, &rows, (left, head));
        for (index, panel) in self.panels.iter().enumerate() {
            let top = top + index as f64 * (self.panel_height + GAP);
            let frame = Frame { left, top, width: WIDTH - left - RIGHT, height: self.panel_height };
            self.draw_panel(&mut svg, panel, frame, index + 1 == self.panels.len());
            if let Some(inset) = inset.filter(|_| index == 0) {
                self.draw_inset(&mut svg, panel, inset, frame);
            }
        }
        svg.finish()
    }

    /// Room for the widest label of an ordinate.
    fn left_margin(&self) -> f64 {
        let ticks = self.panels.iter().flat_map(|panel| panel.y.scale.ticks(y_target(self.panel_height)));
        let widths = ticks.filter_map(|tick| tick.label).map(|label| text_width(&label, FONT));
        widths.fold(24.0, f64::max) + 42.0
    }

    fn draw_panel(&self, svg: &mut Svg, panel: &Panel, frame: Frame, lowest: bool) {
        self.draw_x_ticks(svg, frame, lowest);
        draw_y_ticks(svg, &panel.y, frame);
        svg.rectangle((frame.left, frame.top), (frame.width, frame.height), "none", &FRAME);
        for (x, stroke) in &panel.verticals {
            if let Some(x) = frame.x(&self.x, *x) {
                svg.line((x, frame.top), (x, frame.bottom()), stroke);
            }
        }
        for curve in &panel.curves {
            self.draw_curve(svg, panel, curve, frame);
        }
        self.draw_symbols(svg, panel, frame);
        let size = if self.panels.len() > 1 { SMALL_LABEL } else { LABEL };
        svg.vertical_text((20.0, frame.top + 0.5 * frame.height), size, &panel.y.label);
        if lowest {
            let below = (frame.left + 0.5 * frame.width, frame.bottom() + 44.0);
            svg.text(below, Anchor::Middle, LABEL, &self.x.label);
        }
    }

    /// The inset where least is covered, and a mark around what it shows.
    fn draw_inset(&self, svg: &mut Svg, panel: &Panel, inset: &Inset, frame: Frame) {
        let place = |(x, y): &(f64, f64)| frame.x(&self.x, *x).zip(frame.y(&panel.y, *y));
        // Long straight lines have few points: what lies between them counts too.
        let lines = panel.curves.iter().flat_map(|curve| curve.points.windows(2));
        let ends = lines.filter_map(|pair| place(&pair[0]).zip(place(&pair[1])));
        let taken: Vec<(f64, f64)> = ends
            .flat_map(|(a, b)| {
                (0..8).map(move |k| f64::from(k) / 8.0).map(move |t| (a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1)))
            })
            .collect();
        let (low, high) = (
            place(&(inset.x.scale.ends().0, inset.y.scale.ends().0)),
            place(&(inset.x.scale.ends().1, inset.y.scale.ends().1)),
        );
        let marked = low.zip(high).map(|((x0, y0), (x1, y1))| (x0 - 4.0, y1 - 7.0, x1 - x0 + 8.0, y0 - y1 + 14.0));
        inset.draw(svg, (frame.left, frame.top, frame.width, frame.height), &taken, marked);
    }

    fn draw_x_ticks(&self, svg: &mut Svg, frame: Frame, labelled: bool) {
        for Tick { value, label } in self.x.scale.ticks(7) {
            let Some(x) = frame.x(&self.x, value) else { continue };
            svg.line((x, frame.top), (x, frame.bottom()), &grid(label.is_some()));
            svg.line((x, frame.bottom()), (x, frame.bottom() + tick_length(label.is_some())), &FRAME);
            if let Some(label) = label.filter(|_| labelled) {
                svg.text((x, frame.bottom() + 21.0), Anchor::Middle, FONT, &label);
            }
        }
    }

    fn draw_curve(&self, svg: &mut Svg, panel: &Panel, curve: &Curve, frame: Frame) {
        let place = |(x, y): &(f64, f64)| frame.x(&self.x, *x).zip(frame.y(&panel.y, *y));
        let places: Vec<Option<(f64, f64)>> = curve.points.iter().map(place).collect();
        for piece in places.split(Option::is_none) {
            let points: Vec<(f64, f64)> = piece.iter().copied().flatten().collect();
            match points[..] {
                [] => {}
                [alone] => Shape::Dot.draw(svg, curve.class, alone, curve.stroke.color),
                _ => svg.polyline(curve.class, &points, &curve.stroke),
            }
        }
    }

    fn draw_symbols(&self, svg: &mut Svg, panel: &Panel, frame: Frame) {
        for symbol in &panel.symbols {
            let Some(at) = frame.x(&self.x, symbol.at.0).zip(frame.y(&panel.y, symbol.at.1)) else { continue };
            symbol.draw(svg, at);
            if let Some(name) = &symbol.name {
                let fits = at.0 + 9.0 + text_width(name, FONT) < frame.left + frame.width;
                let (dx, anchor) = if fits { (9.0, Anchor::Start) } else { (-9.0, Anchor::End) };
                svg.haloed_text((at.0 + dx, at.1 + 0.35 * FONT + 6.0), anchor, FONT, name);
            }
        }
    }
}

fn draw_y_ticks(svg: &mut Svg, axis: &Axis, frame: Frame) {
    for Tick { value, label } in axis.scale.ticks(y_target(frame.height)) {
        let Some(y) = frame.y(axis, value) else { continue };
        svg.line((frame.left, y), (frame.left + frame.width, y), &grid(label.is_some()));
        svg.line((frame.left - tick_length(label.is_some()), y), (frame.left, y), &FRAME);
        if let Some(label) = label {
            svg.text((frame.left - 9.0, y + 0.35 * FONT), Anchor::End, FONT, &label);
        }
    }
}

fn y_target(height: f64) -> usize {
    (height / 28.0).round().max(2.0) as usize
}

fn grid(labelled: bool) -> Stroke {
    Stroke::solid(if labelled { palette::GRID } else { palette::FINE_GRID }, 0.8)
}

fn tick_length(labelled: bool) -> f64 {
    if labelled { 5.0 } else { 3.0 }
}

impl Symbol {
    /// Draws it, without its name, with its middle at `at`.
    pub(super) fn draw(&self, svg: &mut Svg, at: (f64, f64)) {
        match self.is_open {
            true => self.shape.draw_open(svg, &self.class, at, self.fill),
            false => self.shape.draw(svg, &self.class, at, self.fill),
        }
    }
}

use super::draw::{FONT, LABEL, LABEL_BEYOND, SMALL_LABEL, y_target};
use super::names::Taken;
use super::smooth;
use super::ticks::Tick;
use super::{Axis, Chart, Curve, Form, Inset, Panel, Shape, Symbol};
use crate::palette;
use crate::svg::{Anchor, Stroke, Svg, fitting_size};

const FRAME: Stroke = Stroke::solid(palette::INK, 1.0);

/// Rectangle of a panel, pixels.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
}

impl Frame {
    pub fn bottom(self) -> f64 {
        self.top + self.height
    }

    fn x(self, axis: &Axis, value: f64) -> Option<f64> {
        axis.scale.place(value).map(|share| self.left + share * self.width)
    }

    fn y(self, axis: &Axis, value: f64) -> Option<f64> {
        axis.scale.place(value).map(|share| self.bottom() - share * self.height)
    }

    fn rectangle(self) -> (f64, f64, f64, f64) {
        (self.left, self.top, self.width, self.height)
    }

    /// The pixels of a point; none if it is outside the axes.
    pub fn place(self, x: &Axis, y: &Axis, at: (f64, f64)) -> Option<(f64, f64)> {
        self.x(x, at.0).zip(self.y(y, at.1))
    }
}

impl Chart {
    pub(super) fn draw_panel(&self, svg: &mut Svg, panel: &Panel, frame: Frame, lowest: bool, inset: Option<&Inset>) {
        self.draw_x_ticks(svg, frame, lowest);
        draw_y_ticks(svg, &panel.y, frame);
        svg.rectangle((frame.left, frame.top), (frame.width, frame.height), "none", &FRAME);
        for (x, stroke) in &panel.verticals {
            if let Some(x) = frame.x(&self.x, *x) {
                svg.line((x, frame.top), (x, frame.bottom()), stroke);
            }
        }
        let mut taken = Taken::default();
        for curve in &panel.curves {
            draw_curve(svg, curve, |at| frame.place(&self.x, &panel.y, at), Some(&mut taken));
        }
        for symbol in &panel.symbols {
            if let Some(at) = frame.place(&self.x, &panel.y, symbol.at) {
                symbol.draw(svg, at);
                taken.symbol(at);
            }
        }
        if let Some(inset) = inset {
            let place = |at| frame.place(&self.x, &panel.y, at);
            let rectangle = inset.draw(svg, panel, frame.rectangle(), taken.places(), place);
            taken.rectangle(rectangle);
        }
        // Required names are placed first.
        for may_go in [false, true] {
            for (symbol, name) in panel.symbols.iter().filter_map(|symbol| Some((symbol, symbol.name.as_ref()?))) {
                if let Some(at) = frame.place(&self.x, &panel.y, symbol.at).filter(|_| name.may_go == may_go) {
                    taken.name(svg, frame.rectangle(), at, &name.text, may_go);
                }
            }
        }
        let size = self.label_size(frame);
        svg.vertical_text((20.0, frame.top + 0.5 * frame.height), size, &panel.y.label);
        if lowest {
            let below = (frame.left + 0.5 * frame.width, frame.bottom() + 44.0);
            svg.text(below, Anchor::Middle, size, &self.x.label);
        }
    }

    /// A common size for the labels of all axes, in which each fits.
    fn label_size(&self, frame: Frame) -> f64 {
        let size = if self.panels.len() > 1 { SMALL_LABEL } else { LABEL };
        let fits = self.panels.iter().map(|panel| fitting_size(&panel.y.label, size, frame.height + LABEL_BEYOND));
        fits.fold(fitting_size(&self.x.label, size, frame.width + 20.0), f64::min)
    }

    fn draw_x_ticks(&self, svg: &mut Svg, frame: Frame, labelled: bool) {
        let most = (frame.width / 92.0).round().max(3.0) as usize;
        for Tick { value, label } in self.x.scale.ticks_with_room(most, frame.width, FONT) {
            let Some(x) = frame.x(&self.x, value) else { continue };
            svg.line((x, frame.top), (x, frame.bottom()), &grid(label.is_some()));
            svg.line((x, frame.bottom()), (x, frame.bottom() + tick_length(label.is_some())), &FRAME);
            if let Some(label) = label.filter(|_| labelled) {
                svg.text((x, frame.bottom() + 21.0), Anchor::Middle, FONT, &label);
            }
        }
    }
}

/// Draws a curve with points positioned by `place`, and registers its position.
pub(super) fn draw_curve(
    svg: &mut Svg,
    curve: &Curve,
    place: impl Fn((f64, f64)) -> Option<(f64, f64)>,
    mut taken: Option<&mut Taken>,
) {
    let places: Vec<Option<(f64, f64)>> = curve.points.iter().map(|at| place(*at)).collect();
    let mut start = 0;
    for piece in places.split(Option::is_none) {
        let points: Vec<(f64, f64)> = piece.iter().copied().flatten().collect();
        if let Some(taken) = taken.as_deref_mut() {
            taken.curve(&points);
        }
        match (&points[..], &curve.form) {
            ([], _) => {}
            ([alone], _) => Shape::Dot.draw(svg, curve.class, *alone, curve.stroke.color),
            (_, Form::Straight) => svg.polyline(curve.class, &points, &curve.stroke),
            (_, Form::Smooth(corners)) => {
                let corners: Vec<usize> = corners.iter().filter_map(|corner| corner.checked_sub(start)).collect();
                svg.path(curve.class, &points, &smooth::controls(&points, &corners), &curve.stroke);
            }
        }
        start += piece.len() + 1;
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

fn grid(labelled: bool) -> Stroke {
    Stroke::solid(if labelled { palette::GRID } else { palette::FINE_GRID }, 0.8)
}

fn tick_length(labelled: bool) -> f64 {
    if labelled { 5.0 } else { 3.0 }
}

impl Symbol {
    /// Draws it, without its name, centred at `at`.
    pub(super) fn draw(&self, svg: &mut Svg, at: (f64, f64)) {
        match self.is_open {
            true => self.shape.draw_open(svg, &self.class, at, self.fill),
            false => self.shape.draw(svg, &self.class, at, self.fill),
        }
    }
}

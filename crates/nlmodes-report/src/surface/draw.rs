use super::view::View;
use super::{Line, Surface};
use crate::chart::{Scale, linear_ticks};
use crate::palette;
use crate::style::FigureStyle;
use crate::svg::{Anchor, Stroke, Svg, fitting_size, text_width};

const SIZE: (f64, f64) = (720.0, 520.0);
const TITLE: f64 = 16.0;
const FONT: f64 = 13.0;
const LABEL: f64 = 15.0;
const EDGE: Stroke = Stroke::solid(palette::INK, 1.0);
const GRID: Stroke = Stroke::solid(palette::GRID, 0.8);
/// Width of the stops.
const STOP: f64 = 2.6;
const CONTACT: Stroke = Stroke::solid("#000000", 2.0);
const MESH: Stroke = Stroke::solid("#3c4a5a", 0.35);

/// A piece of the picture, drawn from far to near.
enum Piece {
    Cell { corners: [[f64; 3]; 4], fill: String },
    Segment { class: &'static str, ends: [[f64; 3]; 2], stroke: Stroke },
}

impl Surface {
    /// The surface as an SVG document.
    pub fn draw(&self, style: &FigureStyle) -> String {
        let mut svg = Svg::new(SIZE.0, SIZE.1);
        let ends = self.ends();
        let view = View::new(ends, (96.0, 44.0), (SIZE.0 - 160.0, SIZE.1 - 100.0));
        let size = fitting_size(&self.title, TITLE, SIZE.0 - 40.0);
        if style.has_title {
            svg.text((0.5 * SIZE.0, 26.0), Anchor::Middle, size, &self.title);
        }
        draw_walls(&mut svg, &view, ends);
        self.draw_labels(&mut svg, &view, ends);
        let mut pieces: Vec<(f64, Piece)> =
            self.cells(ends[2]).chain(self.lines()).map(|p| (p.nearness(&view), p)).collect();
        pieces.sort_by(|a, b| a.0.total_cmp(&b.0));
        pieces.iter().for_each(|(_, piece)| piece.draw(&mut svg, &view));
        svg.finish(style.width_mm)
    }

    fn ends(&self) -> [(f64, f64); 3] {
        let stops = self.stops.iter().map(|stop| stop.z);
        let range = |values: &[f64]| Scale::linear(values.iter().copied(), 0.0).map_or((0.0, 1.0), Scale::ends);
        let heights: Vec<f64> = self.z.iter().flatten().copied().chain(stops).collect();
        let (low, high) = range(&heights);
        let margin = 0.04 * (high - low);
        [range(&self.x.values), range(&self.y.values), (low - margin, high + margin)]
    }

    fn corner(&self, i: usize, j: usize) -> [f64; 3] {
        [self.x.values[i], self.y.values[j], self.z[i][j]]
    }

    fn cells(&self, (low, high): (f64, f64)) -> impl Iterator<Item = Piece> {
        let columns = self.y.values.len() - 1;
        (0..self.x.values.len() - 1).flat_map(move |i| (0..columns).map(move |j| (i, j))).map(move |(i, j)| {
            let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| self.corner(i, j));
            let mean = corners.iter().map(|corner| 0.25 * corner[2]).sum::<f64>();
            Piece::Cell { corners, fill: palette::viridis((mean - low) / (high - low)) }
        })
    }

    /// Stops and motions of the contacts, cut at the times of the surface so that nearer cells hide them.
    fn lines(&self) -> impl Iterator<Item = Piece> {
        let segment = |class, ends, stroke| Piece::Segment { class, ends, stroke };
        let spans = self.y.values.windows(2).enumerate();
        spans.flat_map(move |(j, span)| {
            let motion = move |i: &usize| segment("contact", [self.corner(*i, j), self.corner(*i, j + 1)], CONTACT);
            let stop = move |line: &Line| {
                let stroke = Stroke::solid(palette::stop(line.number), STOP);
                segment("stop", [[line.x, span[0], line.z], [line.x, span[1], line.z]], stroke)
            };
            self.contacts.iter().map(motion).chain(self.stops.iter().map(stop))
        })
    }

    fn draw_labels(&self, svg: &mut Svg, view: &View, ends: [(f64, f64); 3]) {
        let [x, y, z] = ends;
        let axes = [[x.0, y.0, z.1], [x.0, y.0, z.0], [x.1, y.0, z.0], [x.1, y.1, z.0]];
        svg.polyline("axes", &axes.map(|corner| view.place(corner)), &EDGE);
        for tick in linear_ticks(x.0, x.1, 5) {
            draw_tick(svg, view, [tick.value, y.0, z.0], (-0.35, 0.94), tick.label);
        }
        for tick in linear_ticks(y.0, y.1, 6) {
            draw_tick(svg, view, [x.1, tick.value, z.0], (0.75, 0.66), tick.label);
        }
        let ticks = linear_ticks(z.0, z.1, 6);
        let widths = ticks.iter().flat_map(|tick| &tick.label).map(|label| text_width(label, FONT));
        let widest = widths.fold(24.0, f64::max);
        for tick in ticks {
            draw_tick(svg, view, [x.0, y.0, tick.value], (-1.0, 0.0), tick.label);
        }
        let below = view.place([0.5 * (x.0 + x.1), y.0, z.0]);
        svg.text((below.0 - 30.0, below.1 + 56.0), Anchor::Middle, LABEL, &self.x.label);
        let beside = view.place([x.1, 0.5 * (y.0 + y.1), z.0]);
        svg.text((beside.0 + 44.0, beside.1 + 40.0), Anchor::Start, LABEL, &self.y.label);
        let left = view.place([x.0, y.0, 0.5 * (z.0 + z.1)]);
        svg.vertical_text((left.0 - 16.0 - widest, left.1), LABEL, &self.z_label);
    }
}

impl Piece {
    /// Nearness of the middle; lines are treated as slightly nearer, since they are on the surface.
    fn nearness(&self, view: &View) -> f64 {
        match self {
            Self::Cell { corners, .. } => corners.iter().map(|corner| 0.25 * view.nearness(*corner)).sum(),
            Self::Segment { ends, .. } => 0.5 * (view.nearness(ends[0]) + view.nearness(ends[1])) + 0.06,
        }
    }

    fn draw(&self, svg: &mut Svg, view: &View) {
        match self {
            Self::Cell { corners, fill } => svg.polygon("cell", &corners.map(|corner| view.place(corner)), fill, &MESH),
            Self::Segment { class, ends, stroke } => {
                svg.polyline(class, &ends.map(|end| view.place(end)), stroke);
            }
        }
    }
}

/// Floor, left and back wall with their grids.
fn draw_walls(svg: &mut Svg, view: &View, ends: [(f64, f64); 3]) {
    let far = [ends[0].0, ends[1].1, ends[2].0];
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        let corner = |at_a: f64, at_b: f64| {
            let mut point = far;
            point[a] = at_a;
            point[b] = at_b;
            view.place(point)
        };
        let ((a0, a1), (b0, b1)) = (ends[a], ends[b]);
        let outline = [corner(a0, b0), corner(a1, b0), corner(a1, b1), corner(a0, b1)];
        svg.polygon("wall", &outline, "#fafafa", &Stroke::solid("#888888", 0.8));
        linear_ticks(a0, a1, 5).iter().for_each(|tick| svg.line(corner(tick.value, b0), corner(tick.value, b1), &GRID));
        linear_ticks(b0, b1, 5).iter().for_each(|tick| svg.line(corner(a0, tick.value), corner(a1, tick.value), &GRID));
    }
}

fn draw_tick(svg: &mut Svg, view: &View, at: [f64; 3], outwards: (f64, f64), label: Option<String>) {
    let foot = view.place(at);
    let beyond = |length: f64| (foot.0 + length * outwards.0, foot.1 + length * outwards.1);
    svg.line(foot, beyond(6.0), &EDGE);
    let (x, y) = beyond(11.0);
    let anchor = match outwards.0 {
        side if side < -0.5 => Anchor::End,
        side if side > 0.5 => Anchor::Start,
        _ => Anchor::Middle,
    };
    svg.text((x, y + FONT * (0.35 + 0.45 * outwards.1)), anchor, FONT, &label.unwrap_or_default());
}
